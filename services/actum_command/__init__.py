"""The command `actum`."""
