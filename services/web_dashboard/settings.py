"""Settings of the web page."""

from ipaddress import ip_address
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_settings import NoDecode

from actum.settings import HIGHEST_PORT, ServiceSettings

SHORTEST_TOKEN = 16
"""Characters: too many to guess, as nobody is stopped from trying."""


def _names(value: object) -> object:
    """Split `lab.local,robot` at the commas; return what is no text unchanged."""
    return [name.strip().lower() for name in value.split(",") if name.strip()] if isinstance(value, str) else value


def is_local(host: str) -> bool:
    """Return whether what is served at an address is reached by this machine alone."""
    try:
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        return False


class Settings(ServiceSettings):
    """Settings of the page's service, beside those of every service."""

    page_host: str = Field(
        "127.0.0.1",
        description=(
            "address on which the web page listens. With 127.0.0.1, only this machine can open the page. With 0.0.0.0, "
            "other machines can also open the page, and --page-token is required"
        ),
    )
    page_port: int | None = Field(
        None,
        ge=0,
        le=HIGHEST_PORT,
        description="port of the web page; default: 8080 or, if that is in use, the next free port",
    )
    page_token: str | None = Field(
        None,
        min_length=SHORTEST_TOKEN,
        pattern=r"^[A-Za-z0-9_.~-]+$",
        description=(
            f"secret of at least {SHORTEST_TOKEN} characters that a browser needs to open the web page; required if "
            "--page-host lets other machines open the page"
        ),
    )
    page_guarded: bool = Field(
        False,
        description=(
            "serve the web page to other machines although no --page-token is set. Use this option only if something "
            "else guards the page, such as a container host that publishes the container's port on 127.0.0.1 only"
        ),
    )
    page_names: Annotated[frozenset[str], NoDecode, BeforeValidator(_names)] = Field(
        frozenset(),
        description=(
            "further host names under which browsers can open the web page, such as lab.example.org. This machine's "
            "own name and addresses are always allowed; requests for any other name are refused. Default: no further "
            "names"
        ),
    )

    @model_validator(mode="after")
    def _check_token(self) -> Self:
        if not (is_local(self.page_host) or self.page_guarded or self.page_token):
            raise ValueError(
                f"page-host {self.page_host} lets other machines open the page, which therefore needs a token: set "
                f"page-token (ACTUM_PAGE_TOKEN) to {SHORTEST_TOKEN} characters or more. 'openssl rand -hex 16' prints "
                "a suitable token"
            )
        return self
