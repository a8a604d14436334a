"""Recognition from an ordinary camera: real people's video clips, through the camera source, beside MiniRocket."""
