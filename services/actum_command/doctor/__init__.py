"""`actum doctor`: what runs on a sensor, and what is wrong with it."""
