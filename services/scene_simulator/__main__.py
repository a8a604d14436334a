"""`python -m scene_simulator`."""

from actum import steady_clock
from actum.runtime import needs_extra, run_source

with needs_extra("scene-simulator"):
    import scene_simulator.render  # noqa: F401 - what draws is loaded late, and is missed now
    from scene_simulator.endless_simulator import simulator_of
    from scene_simulator.settings import Settings


def main() -> None:
    """Serve until SIGTERM."""
    run_source(Settings, lambda settings: simulator_of(settings, start_ns=steady_clock.now_ns()))


if __name__ == "__main__":
    main()
