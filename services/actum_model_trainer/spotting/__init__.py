"""Trains the search for actions without marks, on whole streams."""
