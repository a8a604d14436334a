"""What every source of pictures offers: a device, a stream or a file."""

from typing import Protocol

from sensor_gateway.captured_picture import Picture


class CameraLostError(Exception):
    """There are no more pictures: why."""


class CaptureEndedError(Exception):
    """A file has been played to its end."""


class Capture(Protocol):
    """Something that gives pictures."""

    @property
    def live(self) -> bool:
        """Whether frozen or black pictures mean a failed camera: not in a file, nor where depth alone finds people."""
        ...

    def next(self, patience_s: float) -> Picture | None:
        """Return the next picture, or None where there is none within so long.

        Raises:
            CameraLostError: there will be none.
            CaptureEndedError: the file is over.
        """
        ...

    def close(self) -> None:
        """Let go of the camera."""
        ...
