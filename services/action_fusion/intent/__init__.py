"""What somebody is about to touch: paths of hands and objects, how they approach, and probabilities of contacts."""
