"""A recording as a sensor: its skeletons and images once more, at their own pace."""

from collections.abc import Iterator
from pathlib import Path

from actum import keys
from actum.joining import joined
from actum.messages import Message
from actum.node import Tally
from actum.recording import Recording, RecordingError
from sensor_gateway.takes import files_of, instants

TOPICS = (keys.SKELETON, keys.COLOR, keys.DEPTH)


class RecordingSource:
    """Plays the skeletons and images of one recording, or of a folder's in order of name, as the given sensor's.

    One that is damaged is played up to there.

    Stamps, numbers and session ids are the recorded ones; from a folder's second recording on, stamps and numbers are
    shifted so that they go on rising.

    Raises:
        DatasetError: the folder holds no recording.
        RecordingError: one of the files is no recording.
    """

    name = "sensor_gateway"
    paced = True

    def __init__(self, path: Path, sensor: str) -> None:
        self.tally = Tally()
        self._sensor = sensor
        self._recordings = [Recording(file) for file in files_of(path, "*.mcap")]

    def frames(self) -> Iterator[list[Message]]:
        """Yield what was captured at one instant, instant by instant."""
        return instants(joined(self._messages(recording) for recording in self._recordings))

    def _messages(self, recording: Recording) -> Iterator[Message]:
        try:
            for message in recording.messages(TOPICS):
                yield message.model_copy(update={"sensor": self._sensor})
        except RecordingError as error:
            self.tally.reject("damaged_recording", str(error))
        self.tally.rejects.update(recording.skipped)
        if recording.truncated:
            self.tally.reject("truncated_recording", str(recording.path))
