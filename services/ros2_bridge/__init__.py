"""Speaks with ROS 2 over rmw_zenoh's keys, without ROS: skeletons, objects and events out, marks in."""
