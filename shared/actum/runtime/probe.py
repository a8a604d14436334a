"""Whether a router answers at `ACTUM_CONNECT`, for its container's health check: `python -m actum.runtime.probe`."""

import sys

from actum.runtime.client import Client
from actum.runtime.session import RouterUnreachableError
from actum.settings import ServiceSettings, complaint


def main() -> None:
    """End with code 1 and the reason if no router answers, or settings cannot be used."""
    try:
        with Client(ServiceSettings(), wait_s=0):
            pass
    except (RouterUnreachableError, ValueError) as error:
        sys.exit(complaint(error) if isinstance(error, ValueError) else str(error))


if __name__ == "__main__":
    main()
