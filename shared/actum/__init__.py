"""actum: online recognition of what a person does, and to which object."""

__version__ = "0.1.0"
