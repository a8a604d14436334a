"""Which object an action is applied to: cues, tried in order."""
