"""What other people's viewers show of our messages: Rerun, and Foxglove."""
