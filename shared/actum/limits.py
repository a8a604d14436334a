"""Limits that all services share: one that waited shorter, or kept less, than another would miss its answers."""

from typing import Final

from actum.node import SECOND_NS

MAX_SKEW_NS: Final = 2 * SECOND_NS
"""Longest delay between streams (ns): a message may come after another whose stamp is newer by this, on any key."""
MAX_SEGMENT_NS: Final = 60 * SECOND_NS
"""Longest segment (ns): in a longer one the end mark was forgotten. Frames are kept for as long."""
MOST_OPEN_SEGMENTS: Final = 32
"""Most marked segments that are open at once: both hands of as many people as a camera tells apart."""
MOST_STREAMS: Final = 64
"""Most people of whom something is kept: as many as one has in a minute whom the sensor numbers anew each second."""
MOST_FRAMES: Final = 60_000
"""Most frames kept of all people together, a few kilobytes each: a minute of 16 people at 60 frames a second."""
MAX_COORDINATE_M: Final = 100.0
"""Largest plausible coordinate (m): nothing in a room is further away along any axis."""
