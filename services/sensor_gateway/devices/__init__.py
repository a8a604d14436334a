"""A depth camera as a sensor: people's poses found in its colour images, lifted by the depth measured there."""
