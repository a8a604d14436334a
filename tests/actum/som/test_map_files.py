"""Maps in files: what is written is read, and what is no map is refused by name."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.som import Som, SomError


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("topology", ["rectangular", "hexagonal"])
def test_a_map_is_read_as_it_was_written(tmp_path: Path, dtype: type, topology: str) -> None:
    som = Som.random(3, 5, 2, rng(), dtype, topology)
    som.save(tmp_path / "map.npz")
    read = Som.load(str(tmp_path / "map.npz"))
    assert (read.rows, read.cols, read.topology, read.weights.dtype) == (3, 5, topology, dtype)
    assert (read.weights == som.weights).all()
    assert [file.name for file in tmp_path.iterdir()] == ["map.npz"]


def test_a_map_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(SomError, match="absent.npz: the file does not exist"):
        Som.load(tmp_path / "absent.npz")


@pytest.mark.parametrize(
    "contents",
    [
        {"weights": np.zeros((2, 2, 1))},
        {"format": np.array("actum.som/2"), "weights": np.zeros((2, 2, 1)), "topology": np.array("rectangular")},
        {"format": np.array("actum.som/1"), "topology": np.array("rectangular")},
        {"format": np.array("actum.som/1"), "weights": np.zeros((2, 2)), "topology": np.array("rectangular")},
        {"format": np.array("actum.som/1"), "weights": np.zeros((0, 2, 1)), "topology": np.array("rectangular")},
        {"format": np.array("actum.som/1"), "weights": np.zeros((2, 2, 1)), "topology": np.array("round")},
        {"format": np.array("actum.som/1"), "weights": np.array([[["a"]]]), "topology": np.array("rectangular")},
        {"format": np.array("actum.som/1"), "weights": np.full((2, 2, 1), np.nan), "topology": np.array("rectangular")},
    ],
)
def test_a_foreign_archive_is_refused(tmp_path: Path, contents: dict[str, np.ndarray]) -> None:
    np.savez(tmp_path / "foreign.npz", **contents)
    with pytest.raises(SomError, match="foreign.npz: "):
        Som.load(tmp_path / "foreign.npz")


def test_a_pickle_is_never_run(tmp_path: Path) -> None:
    np.savez(tmp_path / "pickled.npz", format=np.array("actum.som/1"), weights=np.array([print], dtype=object))
    with pytest.raises(SomError, match="pickled.npz: "):
        Som.load(tmp_path / "pickled.npz")


def test_a_single_array_and_a_text_are_no_maps(tmp_path: Path) -> None:
    np.save(tmp_path / "array.npy", np.zeros(3))
    (tmp_path / "text.npz").write_text("a map")
    (tmp_path / "empty.npz").write_bytes(b"")
    for name in ("array.npy", "text.npz", "empty.npz"):
        with pytest.raises(SomError, match=f"{name}: it is not an npz file"):
            Som.load(tmp_path / name)


@pytest.mark.parametrize(
    "header", ["{'descr': '<f8', 'shape': (2,", "{'descr': '(01,)f8', 'fortran_order': False, 'shape': ()}"]
)
def test_headers_that_numpy_cannot_read_are_refused(tmp_path: Path, header: str) -> None:
    with zipfile.ZipFile(tmp_path / "foreign.npz", "w") as archive:
        archive.writestr("format.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
    with pytest.raises(SomError, match="foreign.npz: "):
        Som.load(tmp_path / "foreign.npz")


def stored(folder: Path) -> bytes:
    Som(2, 2, np.array([[0.1], [0.2], [0.3], [0.4]])).save(folder / "map.npz")
    return (folder / "map.npz").read_bytes()


@given(where=st.floats(0, 1, exclude_max=True), flip=st.integers(1, 255))
def test_an_altered_file_is_refused_or_read_alike(
    tmp_path_factory: pytest.TempPathFactory, where: float, flip: int
) -> None:
    folder = tmp_path_factory.mktemp("altered")
    contents = bytearray(stored(folder))
    contents[int(where * len(contents))] ^= flip
    (folder / "map.npz").write_bytes(contents)
    try:
        assert Som.load(folder / "map.npz").weights.tolist() == [[0.1], [0.2], [0.3], [0.4]]
    except SomError as error:
        assert "map.npz: " in str(error)


@given(share=st.floats(0, 1, exclude_max=True))
def test_a_cut_file_is_refused(tmp_path_factory: pytest.TempPathFactory, share: float) -> None:
    folder = tmp_path_factory.mktemp("cut")
    contents = stored(folder)
    (folder / "map.npz").write_bytes(contents[: int(share * len(contents))])
    with pytest.raises(SomError, match="map.npz: "):
        Som.load(folder / "map.npz")
