"""The service action_fusion, for which a mark, an action or an event is old after a second: tests wait less for it."""

from action_fusion import __main__
from actum.runtime import inbox, resuming

HISTORY_S = 1.0

if __name__ == "__main__":
    inbox.HISTORY_S = resuming.HISTORY_S = HISTORY_S
    __main__.main()
