"""Views of the calibration board from live colour streams."""

import time
from collections.abc import Iterator

from actum import keys
from actum.messages import Image
from actum.runtime import Client, Listening, stop_on_signals
from actum_command.context import connect, console, fail
from calibrator.collecting import PairCollector, ViewCollector
from calibrator.pairs import Pair
from calibrator.pictures import UnusablePictureError, picture_of
from calibrator.views import BoardFinder, View

SILENCE_S = 10.0
POLL_S = 0.01


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
    streams = [client.listen(keys.key(keys.COLOR, sensor), ring=1) for sensor in sensors]
    console.print(f"watching {', '.join(keys.key(keys.COLOR, sensor) for sensor in sensors)}; Ctrl-C ends")
    heard_s = [time.monotonic()] * len(sensors)
    while not stop.is_set():
        for camera, stream in enumerate(streams):
            image = _newest(stream)
            if image is not None:
                heard_s[camera] = time.monotonic()
                yield camera, _view(finder, image)
            elif time.monotonic() - heard_s[camera] > SILENCE_S:
                silent = keys.key(keys.COLOR, sensors[camera])
                fail(f"no image on {silent} for {SILENCE_S:g} s: does its gateway send any?")
        stop.wait(POLL_S)


def _newest(stream: Listening) -> Image | None:
    received = stream.take()
    message = None if received is None else received.message
    return message if isinstance(message, Image) and message.valid else None


def _view(finder: BoardFinder, image: Image) -> View | None:
    name = f"image at {image.stamp_ns / 1e9:.3f} s"
    try:
        return finder.find(picture_of(image, name), name)
    except UnusablePictureError:
        return None
