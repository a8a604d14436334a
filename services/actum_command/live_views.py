"""Views of the calibration board from live colour streams."""

import time
from collections.abc import Iterator

from actum import keys
from actum.messages import Image
from actum.runtime import Client, stop_on_signals
from actum_calibrator.collecting import PairCollector, ViewCollector
from actum_calibrator.pairs import Pair
from actum_calibrator.pictures import UnusablePictureError, picture_of
from actum_calibrator.views import BoardFinder, View
from actum_command.context import connect, console, fail

SILENCE_S = 10.0
POLL_S = 0.01
REMEDY = "A gateway whose ACTUM_CALIBRATION is for another image size gives none that can be used: start it without"


def live_views(finder: BoardFinder) -> list[View]:
    """Collect views until there are enough, or until Ctrl-C, telling what to show next."""
    collector, wished = ViewCollector(), None
    with connect() as client:
        for _, view in _views(client, [client.sensor], finder):
            if collector.offer(view):
                console.print(f"view {len(collector.views)} taken")
            if collector.complete:
                break
            if collector.wish != wished:
                wished = collector.wish
                console.print(f"  next: {wished}")
    return collector.views


def live_pairs(sensors: tuple[str, str], finder: BoardFinder) -> list[Pair]:
    """Collect pairs from two sensors (the one that sees markers first) until there are enough, or until Ctrl-C."""
    collector = PairCollector()
    console.print("hold the board still where both cameras see it, each time elsewhere and tilted otherwise")
    with connect() as client:
        for camera, view in _views(client, list(sensors), finder):
            if collector.offer(camera, view):
                console.print(f"pair {len(collector.pairs)} taken")
            if collector.complete:
                break
    return collector.pairs


def _views(client: Client, sensors: list[str], finder: BoardFinder) -> Iterator[tuple[int, View | None]]:
    """Yield which sensor's picture came and the board in it, None where it is not found, until Ctrl-C."""
    stop = stop_on_signals()
    streams = [_Stream(client, keys.key(keys.COLOR, sensor)) for sensor in sensors]
    console.print(f"watching {', '.join(stream.key for stream in streams)}; Ctrl-C ends")
    while not stop.is_set():
        for camera, stream in enumerate(streams):
            image = stream.newest()
            if image is not None:
                yield camera, _view(finder, image)
        stop.wait(POLL_S)


class _Stream:
    """One sensor's colour images; the command fails where none that can be used comes for too long."""

    def __init__(self, client: Client, key: str) -> None:
        self.key = key
        self._listening = client.listen(key, ring=1)
        self._heard_s = time.monotonic()
        self._invalid: str | None = None

    def newest(self) -> Image | None:
        """Return the newest image, if it came since the last and is valid."""
        received = self._listening.take()
        image = None if received is None else received.message
        if isinstance(image, Image) and image.valid:
            self._heard_s, self._invalid = time.monotonic(), None
            return image
        if isinstance(image, Image):
            self._invalid = image.reason or "it does not say why"
        if time.monotonic() - self._heard_s > SILENCE_S:
            fail(self._complaint())
        return None

    def _complaint(self) -> str:
        if self._invalid is not None:
            return f"no valid image on {self.key} for {SILENCE_S:g} s: {self._invalid}. {REMEDY}"
        return f"no image on {self.key} for {SILENCE_S:g} s: does its gateway send any? {REMEDY}"


def _view(finder: BoardFinder, image: Image) -> View | None:
    name = f"image at {image.stamp_ns / 1e9:.3f} s"
    try:
        return finder.find(picture_of(image, name), name)
    except UnusablePictureError:
        return None
