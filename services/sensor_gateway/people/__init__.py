"""People in pictures: their landmarks, placed in the camera frame, lifted by depth, identified from image to image."""
