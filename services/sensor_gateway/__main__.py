"""`python -m sensor_gateway`."""

from actum import steady_clock
from actum.runtime import needs_extra, run_source

with needs_extra("sensor-gateway"):
    from sensor_gateway.settings import Settings
    from sensor_gateway.sources import source_of


def main() -> None:
    """Serve until SIGTERM."""
    run_source(Settings, lambda settings: source_of(settings, start_ns=steady_clock.now_ns()))


if __name__ == "__main__":
    main()
