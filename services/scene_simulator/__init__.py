"""A seeded scene: an actor at a table does five actions on three marked objects before a simulated camera."""
