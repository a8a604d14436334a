"""A camera or a recording, as skeletons and images on Zenoh."""
