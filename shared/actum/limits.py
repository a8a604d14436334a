"""Bounds that services share: one that waits less, or keeps less, than another would lose what that one answers."""

from typing import Final

from actum.node import SECOND_NS

MAX_SKEW_NS: Final = 2 * SECOND_NS
"""How much later than the newest message one of an earlier stamp may still come, on whichever key (ns)."""
MAX_SEGMENT_NS: Final = 60 * SECOND_NS
"""How long a segment may last (ns): what is longer is a mark that was forgotten, and memory is kept for as long."""
MAX_COORDINATE_M: Final = 100.0
"""What is further away in any axis (m) is no place in a room."""
