"""`python -m web_dashboard`."""

from actum.runtime import needs_extra, run_front

with needs_extra("web-dashboard"):
    from web_dashboard.node import WebDashboard
    from web_dashboard.settings import Settings


def main() -> None:
    """Serve until SIGTERM."""
    run_front(Settings, WebDashboard.configured)


if __name__ == "__main__":
    main()
