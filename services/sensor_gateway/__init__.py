"""A camera, a recording or a simulated scene, as skeletons and images on Zenoh."""
