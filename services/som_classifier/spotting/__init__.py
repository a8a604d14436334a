"""Finds actions in a person's stream of postures without marks."""
