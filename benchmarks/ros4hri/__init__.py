"""People in the words of ROS4HRI: what a round trip costs, how postures are told, and the bridge's time."""
