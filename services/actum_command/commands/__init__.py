"""The command line itself: options, help, what is printed, exit codes. The work is done by the modules beside."""
