"""Keeps events beyond the router's memory: a service that stores marks, final actions and events in files."""
