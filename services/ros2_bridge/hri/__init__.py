"""What both directions share of ROS4HRI (REP 155)."""
