"""Files made to harm or broken by accident: an error names the file and what to do, in little memory and time."""

import json
import time
import tracemalloc
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import lz4.frame
import msgpack
import numpy as np
import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC, Writer

from actum.messages import Message
from actum.recorder import Recorder
from actum.recording import Recording, RecordingError
from handmade import KINDS, model_of
from node_cases import CASES, NOON_NS, photograph
from som_classifier.model_loading import ModelError, load_model

LITTLE_BYTES = 250_000_000
LITTLE_S = 20.0


@pytest.fixture(autouse=True)
def in_little_memory_and_time() -> Iterator[None]:
    began_s = time.process_time()
    tracemalloc.start()
    yield
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < LITTLE_BYTES
    assert time.process_time() - began_s < LITTLE_S


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "whole.mcap"
    with Recorder(path, person="1", source="test") as recorder:
        for case in CASES:
            for message in case.messages()[:8]:
                recorder.write(message)
    return path


@pytest.fixture(scope="module", params=KINDS)
def model(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    path = tmp_path_factory.mktemp("model") / "whole.npz"
    model_of(request.param).save(path)
    return path


def read(path: Path) -> list[Message]:
    return list(Recording(path).messages())


def refused(path: Path) -> str:
    with pytest.raises(RecordingError, match=f"^{path}: .+; .+") as error:
        read(path)
    return str(error.value)


def zeros_chunk(path: Path, compression: str, compress: Callable[[bytes], bytes], said: int) -> Path:
    """An MCAP of one chunk of twenty million zeros, which says that it has so many."""
    data = compress(bytes(20_000_000))
    content = bytes(16) + said.to_bytes(8, "little") + bytes(4)
    content += len(compression).to_bytes(4, "little") + compression.encode() + len(data).to_bytes(8, "little") + data
    header = bytes([Opcode.HEADER]) + (8).to_bytes(8, "little") + bytes(8)
    path.write_bytes(MCAP0_MAGIC + header + bytes([Opcode.CHUNK]) + len(content).to_bytes(8, "little") + content)
    return path


@pytest.mark.parametrize("said", [0, 1000, 2_000_000_000, 2**63])
@pytest.mark.parametrize(
    ("compression", "compress"),
    [("zstd", zstandard.ZstdCompressor().compress), ("lz4", lz4.frame.compress), ("", bytes), ("brotli", bytes)],
)
def test_a_chunk_that_grows_beyond_what_it_says_or_beyond_measure_is_refused(
    tmp_path: Path, compression: str, compress: Callable[[bytes], bytes], said: int
) -> None:
    assert "damaged" in refused(zeros_chunk(tmp_path / "bomb.mcap", compression, compress, said))


def test_a_thousand_small_bombs_in_one_file_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "many.mcap"
    payload = msgpack.packb({"x": bytes(200_000)})
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=20_000_000)
        writer.start()
        channel = writer.register_channel("actum/kinect0/skeleton", "msgpack", 0)
        for i in range(1500):
            writer.add_message(channel, i, payload, i)
        writer.finish()
    assert path.stat().st_size < 100_000
    assert "the recording has far more messages than a file of its size can contain" in refused(path)


def test_a_lens_that_is_covered_makes_no_bomb(tmp_path: Path) -> None:
    """Black raw images are what compresses most of all that is recorded."""
    path = tmp_path / "black.mcap"
    pixels = bytes(640 * 480 * 3)
    with Recorder(path, person="", source="") as recorder:
        for i in range(100):
            recorder.write(photograph(NOON_NS + i, format="bgr8", width=640, height=480, data=pixels))
    assert len(read(path)) == 100


def test_a_recording_cut_at_any_byte_is_read_up_to_there(recording: Path, tmp_path: Path) -> None:
    whole, cut, messages = recording.read_bytes(), tmp_path / "cut.mcap", read(recording)
    counts = []
    for length in [*range(0, 200), *range(200, len(whole), len(whole) // 60), len(whole) - 1]:
        cut.write_bytes(whole[:length])
        try:
            opened = Recording(cut)
        except RecordingError as error:
            assert str(error).startswith(f"{cut}: ")
        else:
            found = list(opened.messages())
            assert opened.truncated and all(message in messages for message in found)
            counts.append(len(found))
    assert counts == sorted(counts)
    assert len(counts) > 100


def test_a_recording_with_any_bit_flipped_is_read_or_refused(recording: Path, tmp_path: Path) -> None:
    whole, flipped, messages = recording.read_bytes(), tmp_path / "flipped.mcap", read(recording)
    for position in [*range(0, 200), *range(200, len(whole), len(whole) // 80)]:
        changed = bytearray(whole)
        changed[position] ^= 1 << position % 8
        flipped.write_bytes(changed)
        try:
            assert all(message in messages for message in read(flipped))
        except RecordingError as error:
            assert str(error).startswith(f"{flipped}: ")


def no_model(path: Path) -> str:
    with pytest.raises(ModelError, match=f"^{path}: .*; train a model with 'actum train REC… -o MODEL'$") as error:
        load_model(path)
    return str(error.value)


def with_member(model: Path, path: Path, name: str, content: bytes) -> Path:
    with zipfile.ZipFile(model) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for member in old.infolist():
            if member.filename != name:
                new.writestr(member, old.read(member))
        new.writestr(name, content)
    return path


def array(shape: str, content: bytes) -> bytes:
    header = f"{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}".encode().ljust(118) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + content


@pytest.mark.parametrize("name", ["unused.npy", "labels.npy"])
def test_a_model_that_grows_beyond_measure_is_refused(model: Path, tmp_path: Path, name: str) -> None:
    content = array("(100000000,)", bytes(100_000_000))
    bomb = with_member(model, tmp_path / "bomb.npz", name, content)
    tracemalloc.reset_peak()
    assert "the file's arrays would take" in no_model(bomb)
    assert tracemalloc.get_traced_memory()[1] < 2 * len(content)


@pytest.mark.parametrize("shape", ["(10**18,)", "(1000000000000,)", "(-1,)", "(2,)" * 200])
def test_a_model_whose_arrays_say_that_they_are_huge_is_refused(model: Path, tmp_path: Path, shape: str) -> None:
    no_model(with_member(model, tmp_path / "huge.npz", "extra.npy", array(shape, b"x")))


def metadata(model: Path, path: Path, **changes: object) -> Path:
    with np.load(model) as file:
        arrays = {name: file[name] for name in file.files}
    fields = json.loads(str(arrays["metadata"])) | changes
    np.savez(path, **arrays | {"metadata": np.array(json.dumps(fields))})
    return path


@pytest.mark.thorough
@pytest.mark.parametrize("value", [10**18, -1, [10**12], [1] * 1000, {"a": {"b": 10**15}}, "x" * 10**5, None, 1e308])
def test_a_model_whose_metadata_say_absurd_things_is_loaded_or_refused(
    model: Path, tmp_path: Path, value: object
) -> None:
    with np.load(model) as file:
        names = list(json.loads(str(file["metadata"])))
    for name in names:
        path = metadata(model, tmp_path / "absurd.npz", **{name: value})
        try:
            assert len(load_model(path).metadata.held_out_answers) < 10**7
        except ModelError as error:
            assert str(error).startswith(f"{path}: ")


def test_metadata_nested_without_end_are_refused(model: Path, tmp_path: Path) -> None:
    with np.load(model) as file:
        arrays = {name: file[name] for name in file.files}
    deep = tmp_path / "deep.npz"
    np.savez(deep, **arrays | {"metadata": np.array('{"kind": ' + "[" * 100_000)})
    no_model(deep)


def test_a_model_of_a_later_version_is_named(model: Path, tmp_path: Path) -> None:
    assert "metadata format" in no_model(metadata(model, tmp_path / "later.npz", format="actum.model/2"))


def test_a_model_cut_at_any_byte_is_refused(model: Path, tmp_path: Path) -> None:
    whole, cut = model.read_bytes(), tmp_path / "cut.npz"
    for length in [*range(0, 200, 7), *range(200, len(whole), len(whole) // 60), *range(len(whole) - 60, len(whole))]:
        cut.write_bytes(whole[:length])
        no_model(cut)


def test_a_model_with_any_bit_flipped_is_refused_or_the_same(model: Path, tmp_path: Path) -> None:
    whole, flipped, same = model.read_bytes(), tmp_path / "flipped.npz", load_model(model).id
    for position in [*range(0, 200, 3), *range(200, len(whole), len(whole) // 75)]:
        changed = bytearray(whole)
        changed[position] ^= 1 << position % 8
        flipped.write_bytes(changed)
        try:
            assert load_model(flipped).id == same
        except ModelError as error:
            assert str(error).startswith(f"{flipped}: ")
