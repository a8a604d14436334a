"""Coverage-guided fuzzing of what reads foreign bytes, by atheris: `python -m fuzzing.coverage_guided codec …`."""

import sys
from collections.abc import Callable
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["actum", "msgpack.fallback", "mcap"]):
    from mcap.writer import CompressionType, Writer
    from msgpack import fallback

    from actum import codec, keys
    from actum.recording import Recording, RecordingError

from node_cases import CASES, CLASSIFIER, photograph

LONGEST = {"codec": 4096, "recording": 16384}
"""Bytes of the longest input: longer ones add nothing but time."""
SLOWEST_S = 5
"""An input that takes longer counts as a hang (s)."""
LARGEST_MB = 1024
"""Resident memory that counts as a leak or a bomb: the interpreter, its libraries and the instruments take 200."""
FALLBACK_BYTES = 100_000
"""Most bytes of a value in the unpacker that only guides: it has no limits of its own."""


def decode(data: bytes) -> None:
    """Decode bytes on the key and under the encoding that the first of them choose."""
    if len(data) < 2:
        return
    topic = keys.TOPICS[data[0] % len(keys.TOPICS)]
    key = keys.key(topic, "kinect0", "1" if "{}" in topic.leaf else None)
    encoding = ("", f"application/msgpack;{topic.message.SCHEMA}/{data[1] % 4}")[data[1] % 2]
    _guide(data[2:])
    try:
        message = codec.decode(key, data[2:], encoding)
    except codec.DecodeError:
        return
    frame = codec.encode(message)
    assert codec.encode(codec.decode(frame.key, frame.payload, frame.encoding)) == frame


def _guide(payload: bytes) -> None:
    """Unpack in Python, too, whose branches can be watched, while those of the library in C cannot."""
    unpacker = fallback.Unpacker(None, max_buffer_size=FALLBACK_BYTES)
    try:
        unpacker.feed(payload)
        unpacker.unpack()
    except (*codec.UNPACK_ERRORS, fallback.BufferFull):
        pass


def reader_in(folder: Path) -> Callable[[bytes], None]:
    """Return what reads bytes as a recording in a folder."""
    path = folder / "input.mcap"

    def read(data: bytes) -> None:
        path.write_bytes(data)
        try:
            recording = Recording(path)
            for _ in recording.messages():
                pass
            assert recording.topics is not None
        except RecordingError as error:
            assert str(error).startswith(f"{path}: ")

    return read


def seed_codec(corpus: Path) -> None:
    """Write a real message of each kind, behind the two bytes that choose its key."""
    for case in CASES:
        for message in case.one_of_each():
            frame = codec.encode(message)
            number = keys.TOPICS.index(keys.parse(frame.key).topic)
            (corpus / f"{case}-{message.SCHEMA}").write_bytes(bytes([number, 3]) + frame.payload)


def seed_recordings(corpus: Path) -> None:
    """Write small recordings, compressed and not, with chunks and without."""
    frames = [codec.encode(m) for m in (CLASSIFIER.messages()[0], CLASSIFIER.messages()[4], photograph(1))]
    for compression in CompressionType:
        for chunking in (True, False):
            with (corpus / f"{compression.name}-{chunking}.mcap").open("wb") as file:
                writer = Writer(file, compression=compression, use_chunking=chunking, enable_crcs=False)
                writer.start()
                writer.add_metadata("actum.recording", {"person": "1", "source": "fuzz"})
                schema = writer.register_schema("actum.posture/1", "jsonschema", b"{}")
                for number, frame in enumerate(frames):
                    channel = writer.register_channel(frame.key, "msgpack", schema, {"encoding": frame.encoding})
                    writer.add_message(channel, number, frame.payload[:2000], number)
                writer.finish()


def main(what: str, folder: Path, seconds: int, seed: int) -> None:
    """Fuzz the codec or the reader of recordings for so long; the process ends with another code than 0 at a finding.

    The corpus grows in the folder, and the input of a finding is left there.
    """
    corpus = folder / "corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    seed_codec(corpus) if what == "codec" else seed_recordings(corpus)
    limits = [f"-max_total_time={seconds}", f"-seed={seed}", f"-max_len={LONGEST[what]}", f"-timeout={SLOWEST_S}"]
    flags = [*limits, f"-rss_limit_mb={LARGEST_MB}", f"-artifact_prefix={folder}/", "-print_final_stats=1", str(corpus)]
    atheris.Setup([what, *flags], decode if what == "codec" else reader_in(folder))
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
