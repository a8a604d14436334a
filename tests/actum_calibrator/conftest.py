"""Views of rendered boards, found once for all tests."""

import numpy as np
import pytest
from numpy.typing import NDArray

from actum_calibrator.board import Board
from actum_calibrator.board_views import BoardFinder, View
from actum_calibrator.pairs import Pair
from boards import Lens, facing, good_poses, photograph

MARKERS_LENS = Lens()
PEOPLE_LENS = Lens(matrix=(530.0, 532.0, 314.0, 245.0), distortion=(0.06, -0.1, 0.0, 0.0, 0.0))
PAIR_PLACES = (
    ((-0.10, -0.05, 0.60), (30, 0, 0)), ((0.05, 0.05, 0.70), (0, 32, -8)), ((0.10, -0.04, 0.65), (6, -10, 10)),
    ((-0.05, 0.06, 0.70), (25, 25, 0)), ((0.00, 0.00, 0.65), (-28, 8, 15)),
)  # fmt: skip


@pytest.fixture(scope="session")
def board() -> Board:
    return Board()


@pytest.fixture(scope="session")
def finder(board: Board) -> BoardFinder:
    return BoardFinder(board)


@pytest.fixture(scope="session")
def good_views(board: Board, finder: BoardFinder) -> list[View]:
    poses = enumerate(good_poses(board))
    return [finder.find(photograph(MARKERS_LENS, board, pose, seed=n), f"view {n}") for n, pose in poses]


@pytest.fixture(scope="session")
def pairs_of(board: Board, finder: BoardFinder):
    """Make pairs of views: two cameras whose true transform is given see the board at the same places."""

    def make(skeleton_from_image: NDArray[np.float64], count: int = len(PAIR_PLACES)) -> list[Pair]:
        pairs = []
        for n, (place, turn) in enumerate(PAIR_PLACES[:count]):
            pose = facing(board, place, turn)
            markers = photograph(MARKERS_LENS, board, pose, seed=n)
            people = photograph(PEOPLE_LENS, board, skeleton_from_image @ pose, seed=50 + n)
            pairs.append(Pair(f"pair {n}", finder.find(markers, f"{n}_a"), finder.find(people, f"{n}_b")))
        return pairs

    return make
