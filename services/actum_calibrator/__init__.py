"""Camera calibration with a printed board: sheets to print, intrinsics, and the transform between two cameras."""
