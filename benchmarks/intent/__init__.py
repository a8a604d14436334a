"""Contacts of hands with objects, foreseen: learning, and how far ahead of them, beside what is simpler."""
