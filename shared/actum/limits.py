"""Limits that all services share: one that waited shorter, or kept less, than another would miss its answers."""

from typing import Final

from actum.node import SECOND_NS

MAX_SKEW_NS: Final = 2 * SECOND_NS
"""Longest delay between streams (ns): a message may come after another whose stamp is newer by this, on any key."""
MAX_SEGMENT_NS: Final = 60 * SECOND_NS
"""Longest segment (ns): in a longer one the end mark was forgotten. Frames are kept for as long."""
MAX_COORDINATE_M: Final = 100.0
"""Largest plausible coordinate (m): nothing in a room is further away along any axis."""
