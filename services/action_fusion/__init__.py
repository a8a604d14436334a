"""One event per segment: the action, the object it is applied to, and what became of it."""
