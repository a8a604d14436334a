"""Where hands and objects were at every instant of a segment, and which of them moved together."""
