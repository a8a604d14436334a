"""actum: online recognition of what a person does, and to which object."""

from importlib.metadata import version

__version__ = version("actum")
"""The version that is installed; `pyproject.toml` alone states it."""
