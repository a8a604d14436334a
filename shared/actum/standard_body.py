"""The skeleton's bones, and joints scaled to a body whose bones have standard lengths."""

import numpy as np

from actum.arrays import Array, has_unknown
from actum.geometry import SMALLEST_M, DegenerateError
from actum.skeletons import INDEX

BONES: tuple[tuple[int, int, float], ...] = tuple(
    (INDEX[parent], INDEX[child], length_m)
    for parent, child, length_m in (
        ("torso", "neck", 0.24),
        ("neck", "head", 0.20),
        ("neck", "left_shoulder", 0.18),
        ("left_shoulder", "left_elbow", 0.28),
        ("left_elbow", "left_hand", 0.32),
        ("neck", "right_shoulder", 0.18),
        ("right_shoulder", "right_elbow", 0.28),
        ("right_elbow", "right_hand", 0.32),
        ("torso", "left_hip", 0.26),
        ("left_hip", "left_knee", 0.42),
        ("left_knee", "left_foot", 0.44),
        ("torso", "right_hip", 0.26),
        ("right_hip", "right_knee", 0.42),
        ("right_knee", "right_foot", 0.44),
    )
)
"""The skeleton as a tree with the torso as its root, parents first: parent, child, standard length in metres."""

_PARENTS = np.array([parent for parent, _, _ in BONES])
"""Index of the joint where each bone begins: (14,)."""
_CHILDREN = np.array([child for _, child, _ in BONES])
"""Index of the joint where each bone ends: (14,)."""
_LENGTHS_M = np.array([length for _, _, length in BONES])
"""Standard lengths (m): (14,)."""


def _paths_from_torso() -> Array:
    """Return 1 for each bone on the path from the torso to a joint, else 0: (15, 14), joints by bones."""
    paths = np.zeros((len(INDEX), len(BONES)))
    for bone, (parent, child, _) in enumerate(BONES):
        paths[child] = paths[parent]
        paths[child, bone] = 1.0
    return paths


_PATHS = _paths_from_torso()
"""Which bones lie on the path from the torso to each joint: (15, 14), 1 or 0."""


def bones_of(joints: Array) -> tuple[Array, Array]:
    """Return the bones of joints (15, 3) as vectors (14, 3), and their squared lengths (14,); NaN where unknown."""
    bones = joints[_CHILDREN] - joints[_PARENTS]
    return bones, np.einsum("ij,ij->i", bones, bones)


def scaled(joints: Array) -> Array:
    """Return the joints, (15, 3), with each bone at its standard length in its own direction, the torso unmoved.

    A joint of the result is NaN where any joint on its path from the torso is unknown.

    Args:
        joints: (15, 3), NaN where unknown; the torso is known.

    Raises:
        DegenerateError: a bone has no length, so that its direction is undefined.
    """
    bones, lengths2 = bones_of(joints)
    lengths = np.sqrt(lengths2)
    if np.fmin.reduce(lengths) < SMALLEST_M:
        raise DegenerateError(
            "two neighbouring joints of the skeleton are at the same position: send it without one of them"
        )
    standard = bones * (_LENGTHS_M / lengths)[:, None]
    from_torso = _positions_where_known(standard) if has_unknown(lengths) else _PATHS @ standard
    result: Array = joints[INDEX["torso"]] + from_torso
    return result


def in_own_size(standard: Array, metric: Array) -> Array:
    """Return postures of a standard body with the bones of a person's own lengths, (…, 15, 3), the torso at 0.

    A bone that is shorter than its standard length, as in a mean of postures, stays so in proportion. One that is
    longer, as no mean has it, gets the person's.

    Args:
        standard: (…, 15, 3), in any frame, NaN where unknown.
        metric: (15, 3), the person's joints in metres, in any frame, NaN where unknown.
    """
    bones = standard[..., _CHILDREN, :] - standard[..., _PARENTS, :]
    ratios = np.sqrt(bones_of(metric)[1]) / np.maximum(np.linalg.norm(bones, axis=-1), _LENGTHS_M)
    return _positions_where_known(bones * ratios[..., None])


def _positions_where_known(bones: Array) -> Array:
    """Return joints relative to the torso, (…, 15, 3), NaN where a bone (…, 14, 3) on the path to them is unknown."""
    unknown = np.isnan(bones[..., 0])
    positions: Array = _PATHS @ np.where(unknown[..., None], 0.0, bones)
    positions[unknown @ _PATHS.T > 0] = np.nan
    return positions
