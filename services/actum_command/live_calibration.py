"""Collects the inputs of calibration from live streams: views of the board in colour images, and skeletons."""

import threading
import time
from collections.abc import Callable, Iterator, Sequence

from actum import images, keys
from actum.messages import Image, Skeleton
from actum.runtime import Client
from actum_calibrator.board_views import BoardFinder, View
from actum_calibrator.grey_images import UnusablePictureError
from actum_calibrator.pairs import Pair
from actum_calibrator.view_collector import PairCollector, ViewCollector

SILENCE_S = 10.0  # longer than the slowest camera takes from the gateway's start to the first frame
POLL_S = 0.01  # a third of a frame's interval
SIZE_REMEDY = (
    "If the sensor gateway's calibration file (ACTUM_CALIBRATION) was made at another image size, start the sensor "
    "gateway without this file"
)

Tell = Callable[[str], object]
"""Called with each line of console markup that says what has happened or what to do next."""


class SilentStreamError(RuntimeError):
    """No message that can be used has come for too long; the text names the key, the reason and what to do."""


def collect_views(client: Client, finder: BoardFinder, stop: threading.Event, tell: Tell) -> list[View]:
    """Collect views until there are enough or until stopped, and tell which view is needed next.

    Raises:
        SilentStreamError: no valid image comes.
    """
    collector, last_instruction = ViewCollector(), None
    for _, view in _views(client, [client.sensor], finder, stop, tell):
        if collector.offer(view):
            tell(f"view {len(collector.views)} taken")
        if collector.complete:
            break
        if collector.instruction != last_instruction:
            last_instruction = collector.instruction
            tell(f"  next: {last_instruction}")
    return collector.views


def collect_pairs(
    client: Client, sensors: tuple[str, str], finder: BoardFinder, stop: threading.Event, tell: Tell
) -> list[Pair]:
    """Collect pairs from two sensors (the one that sees markers first) until there are enough or until stopped.

    Raises:
        SilentStreamError: no valid image comes from one of them.
    """
    collector = PairCollector()
    for camera, view in _views(client, sensors, finder, stop, tell):
        if collector.offer(camera, view):
            tell(f"pair {len(collector.pairs)} taken")
        if collector.complete:
            break
    return collector.pairs


def live_skeletons(client: Client, stop: threading.Event, tell: Tell) -> Iterator[Skeleton]:
    """Yield skeletons as they come, until stopped.

    Raises:
        SilentStreamError: nothing comes.
    """
    key = keys.key(keys.SKELETON, client.sensor)
    stream, received_s = client.listen(key), time.monotonic()
    tell(f"reading {key}; Ctrl-C ends")
    while not stop.wait(POLL_S):
        while (received := stream.receive()) is not None:
            received_s = time.monotonic()
            if isinstance(received.message, Skeleton):
                yield received.message
        if time.monotonic() - received_s > SILENCE_S:
            raise SilentStreamError(
                f"no skeleton arrived on {key} for {SILENCE_S:g} s: check that the sensor gateway runs"
            )


def _views(
    client: Client, sensors: Sequence[str], finder: BoardFinder, stop: threading.Event, tell: Tell
) -> Iterator[tuple[int, View | None]]:
    """Yield the index of each image's sensor and the board's view, None where no board is found, until stopped."""
    streams = [_ImageStream(client, keys.key(keys.COLOR, sensor)) for sensor in sensors]
    tell(f"reading {', '.join(stream.key for stream in streams)}; Ctrl-C ends")
    while not stop.is_set():
        for camera, stream in enumerate(streams):
            image = stream.newest()
            if image is not None:
                name = f"image at {image.stamp_ns / 1e9:.3f} s"
                try:
                    view = finder.find(images.gray(image), name)
                except (images.UnusableImageError, UnusablePictureError):
                    view = None
                yield camera, view
        stop.wait(POLL_S)


class _ImageStream:
    """One sensor's colour images."""

    def __init__(self, client: Client, key: str) -> None:
        self.key = key
        self._listening = client.listen(key, ring=1)
        self._valid_s = time.monotonic()
        self._reason: str | None = None

    def newest(self) -> Image | None:
        """Return the newest image if it is valid and has come since the last call, else None.

        Raises:
            SilentStreamError: no valid image has come for `SILENCE_S`.
        """
        received = self._listening.receive()
        image = None if received is None else received.message
        if isinstance(image, Image) and image.valid:
            self._valid_s, self._reason = time.monotonic(), None
            return image
        if isinstance(image, Image):
            self._reason = image.reason or "no reason given"
        if time.monotonic() - self._valid_s <= SILENCE_S:
            return None
        if self._reason is not None:
            raise SilentStreamError(
                f"no valid image arrived on {self.key} for {SILENCE_S:g} s ({self._reason}). {SIZE_REMEDY}"
            )
        raise SilentStreamError(
            f"no image arrived on {self.key} for {SILENCE_S:g} s: check that the sensor gateway publishes images. "
            f"{SIZE_REMEDY}"
        )
