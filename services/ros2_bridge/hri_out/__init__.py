"""People in the words of ROS4HRI (REP 155): bodies and persons, their posture, gestures, actions and intents."""
