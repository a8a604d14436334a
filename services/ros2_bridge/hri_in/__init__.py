"""Bodies that other ROS 2 nodes describe in the words of ROS4HRI (REP-155), as skeletons of the bridge's sensor."""
