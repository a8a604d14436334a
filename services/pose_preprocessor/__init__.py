"""From the skeleton in the camera frame to scaled, egocentric postures."""
