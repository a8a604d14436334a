"""Pictures that show what a trained model has learnt, and its answers."""
