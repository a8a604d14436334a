"""Picks the settings of the search for actions from labelled continuous recordings."""
