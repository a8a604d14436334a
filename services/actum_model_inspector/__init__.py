"""Pictures of what a trained model has learnt, and of why it recognised what it did."""
