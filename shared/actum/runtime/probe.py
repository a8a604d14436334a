"""Whether a router answers at `ACTUM_CONNECT`, for its container's health check: `python -m actum.runtime.probe`."""

import sys

from actum.runtime.client import Client
from actum.runtime.session import RouterUnreachableError
from actum.settings import ServiceSettings


def main() -> None:
    """End with code 1 and the reason if no router answers."""
    try:
        with Client(ServiceSettings(), wait_s=0):
            pass
    except RouterUnreachableError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
