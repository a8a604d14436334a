"""A scene on two hosts while processes die, freeze and lose the network: what is answered, and how soon all is well."""
