"""People in pictures: their landmarks, placed in the camera frame, lifted by depth, told apart from image to image."""
