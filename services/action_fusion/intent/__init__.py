"""What a person is about to touch: the objects that a hand approaches, with probabilities, before it arrives."""
