"""The interface of everything that gives pictures: devices, streams and files."""

from typing import Protocol

from sensor_gateway.captured_picture import Picture


class CameraLostError(Exception):
    """The camera gives no more pictures; the message gives the reason."""


class CaptureEndedError(Exception):
    """A file has been played to its end."""


class Capture(Protocol):
    """Something that gives pictures."""

    @property
    def live(self) -> bool:
        """Whether frozen or black pictures mean a failed camera; false for files, and where depth alone is used."""
        ...

    @property
    def rate_hz(self) -> float | None:
        """How many pictures a second it is set to give; None where it does not say."""
        ...

    def next(self, patience_s: float) -> Picture | None:
        """Return the next picture, or None if none comes within `patience_s`.

        Raises:
            CameraLostError: no more pictures will come.
            CaptureEndedError: the file has been played to its end.
        """
        ...

    def close(self) -> None:
        """Release the camera."""
        ...
