"""A colour camera as a sensor: people's poses found in its images, placed in the camera frame."""
