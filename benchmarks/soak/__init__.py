"""All services for minutes, with four people and images: memory, losses and latency over time (make soak)."""
