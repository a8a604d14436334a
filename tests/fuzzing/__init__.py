"""Malformed and hostile messages by the hundred thousand, at every service (make fuzz)."""
