"""Cameras, streams and files that give pictures: webcams, video files, RealSense, OpenNI 2 and NiTE 2."""
