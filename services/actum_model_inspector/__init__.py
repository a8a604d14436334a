"""Pictures that show what a trained model has learnt, and explain its answers."""
