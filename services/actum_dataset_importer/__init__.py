"""Public data sets and video clips as recordings: `actum import`."""
