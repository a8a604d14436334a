"""Run the marker tracker: `python -m marker_tracker`."""

from actum.runtime import needs_extra, run

with needs_extra("marker-tracker"):
    from marker_tracker.node import MarkerTracker
    from marker_tracker.settings import Settings


def main() -> None:
    """Serve until SIGTERM."""
    run(Settings, MarkerTracker)


if __name__ == "__main__":
    main()
