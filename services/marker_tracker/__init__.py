"""Objects by the fiducial markers on them."""
