"""The source of recordings: puts their skeletons and images at the recorded pace."""

from collections.abc import Iterable, Iterator
from itertools import chain, groupby
from operator import attrgetter
from pathlib import Path

from actum import keys
from actum.joining import joined
from actum.messages import Message
from actum.node import Counters, Source
from actum.recording import Recording, RecordingError
from actum.recording_files import recording_files

TOPICS = (keys.SKELETON, keys.COLOR, keys.DEPTH)


class RecordingSource:
    """Plays the skeletons and images of one recording, or of those below a folder by name, as those of a sensor.

    Stamps, numbers and session ids are the recorded ones; from a folder's second recording on, stamps and numbers are
    shifted so that they continue to rise. A damaged recording is played up to the damage.

    Raises:
        RecordingError: the folder holds no recording, or one of the files is none.
    """

    name = "sensor_gateway"
    paced = True

    def __init__(self, path: Path, sensor: str) -> None:
        self.counters = Counters()
        self._sensor = sensor
        found = recording_files([path])
        if not found.paths:
            raise RecordingError(
                path, "the folder contains no recording (*.mcap)", "give a recording, or a folder of recordings"
            )
        for problem in found.left_out:
            self.counters.reject("damaged_recording", problem)
        self._recordings = [Recording(file) for file in found.paths]

    def frames(self) -> Iterator[list[Message]]:
        """Yield lists of messages with the same stamp, in order."""
        return _by_stamp(joined(self._messages(recording) for recording in self._recordings))

    def _messages(self, recording: Recording) -> Iterator[Message]:
        try:
            for message in recording.messages(TOPICS):
                yield message.model_copy(update={"sensor": self._sensor})
        except RecordingError as error:
            self.counters.reject("damaged_recording", str(error))
        self.counters.rejects.update(recording.skipped)
        if recording.truncated:
            self.counters.reject("truncated_recording", str(recording.path))


class LoopedSource:
    """A source of recordings, played again and again; stamps and numbers continue to rise."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self.name, self.paced, self.counters = source.name, source.paced, source.counters

    def frames(self) -> Iterator[list[Message]]:
        """Yield the source's frames again and again; nothing where it has none."""
        return _by_stamp(joined(self._rounds()))

    def _rounds(self) -> Iterator[Iterable[Message]]:
        while (first := next(frames := self._source.frames(), None)) is not None:
            yield chain(first, chain.from_iterable(frames))


def _by_stamp(messages: Iterable[Message]) -> Iterator[list[Message]]:
    """Group successive messages of the same stamp."""
    for _, group in groupby(messages, key=attrgetter("stamp_ns")):
        yield list(group)
