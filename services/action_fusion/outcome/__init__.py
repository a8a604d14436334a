"""What became of the object that an action was applied to."""
