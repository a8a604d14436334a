"""The compiled kernel against the one in NumPy: the same map to the bit."""

import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.som import Schedule, SequentialTraining, Som, adapt_in_numpy
from actum.som.kernel import Kernel

needs_numba = pytest.mark.skipif(find_spec("numba") is None, reason="Numba is not installed")


def trained(som: Som, vectors: np.ndarray, kernel: Kernel) -> np.ndarray:
    order = np.random.default_rng(5).integers(len(vectors), size=150)
    training = SequentialTraining(som, vectors, order, Schedule((0.6, 0.05), (4.0, 0.3)), kernel)
    training.run(150)
    return training.som.weights


@needs_numba
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@given(
    rows=st.integers(1, 9),
    cols=st.integers(1, 9),
    dim=st.integers(1, 13),
    gaps=st.sampled_from([0.0, 0.3]),
    seed=st.integers(0, 99),
)
def test_both_kernels_give_the_same_map_to_the_bit(
    rows: int, cols: int, dim: int, gaps: float, seed: int, dtype: type
) -> None:
    from actum.som.compiled import compiled_kernel

    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=(20, dim)).astype(dtype)
    vectors[:, 1:][rng.random((20, dim - 1)) < gaps] = np.nan
    som = Som.random(rows, cols, dim, rng, dtype)
    assert trained(som, vectors, compiled_kernel()).tobytes() == trained(som, vectors, adapt_in_numpy).tobytes()


@needs_numba
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_both_kernels_take_the_first_of_equals(dtype: type) -> None:
    from actum.som.compiled import compiled_kernel

    som = Som(3, 5, np.zeros((15, 2)).astype(dtype))
    vectors = np.array([[1.0, 1.0]], dtype)
    for kernel in (adapt_in_numpy, compiled_kernel()):
        weights = trained(som, vectors, kernel)
        assert weights[:, 0].argmax() == 0
    assert (trained(som, vectors, adapt_in_numpy) == trained(som, vectors, compiled_kernel())).all()


def run(program: str) -> str:
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


TRAINING = """
import numpy as np
from actum.som import Schedule, Som
from actum.som.kernel import adapt_in_numpy
from actum.som.sequential import fastest_kernel
vectors = np.random.default_rng(0).random((50, 3))
start = Som.random(4, 4, 3, np.random.default_rng(1), np.float32)
som = start.train(vectors, 99, Schedule((0.5, 0.1), (2.0, 1.0)), np.random.default_rng(2))
print(fastest_kernel() is adapt_in_numpy, som.weights.tobytes().hex())
"""


@pytest.fixture(scope="module")
def as_installed() -> str:
    return run(TRAINING)


@pytest.mark.long
@needs_numba
def test_without_a_place_for_compiled_code_it_is_compiled_anew(as_installed: str) -> None:
    """Numba tries each place for its cache with a temporary file."""
    nowhere = (
        "import tempfile\ndef refuse(*_, **__): raise PermissionError(13, 'no')\ntempfile.TemporaryFile = refuse\n"
    )
    assert run(nowhere + TRAINING) == as_installed
    assert as_installed.startswith("False")


REFUSED = """
import sys
class Refusing:
    def find_spec(self, name, path=None, target=None):
        if name == "numba":
            raise ImportError("not here")
sys.meta_path.insert(0, Refusing())
"""


@pytest.mark.parametrize("hidden", ["import sys\nsys.modules['numba'] = None\n", REFUSED], ids=["absent", "refused"])
def test_without_numba_the_map_is_the_same(as_installed: str, hidden: str) -> None:
    by_numpy = run(hidden + TRAINING)
    assert by_numpy.startswith("True")
    assert by_numpy.split()[1] == as_installed.split()[1]
