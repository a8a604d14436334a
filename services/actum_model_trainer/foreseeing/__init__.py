"""How early and how rightly contacts of hands with objects are foreseen, and what is simpler."""
