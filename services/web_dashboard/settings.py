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
    """Tell whether what is served at an address is reached by this machine alone."""
    try:
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        return False


class Settings(ServiceSettings):
    """What the page's service can be told beside what every service can."""

    page_host: str = Field(
        "127.0.0.1", description="the address to listen on; 0.0.0.0 admits other machines and needs a page-token"
    )
    page_port: int | None = Field(
        None, ge=0, le=HIGHEST_PORT, description="the page's port; default: 8080, or the next free one"
    )
    page_token: str | None = Field(
        None,
        min_length=SHORTEST_TOKEN,
        pattern=r"^[A-Za-z0-9_.~-]+$",
        description="the secret that opens the page; required where other machines can reach the page",
    )
    page_guarded: bool = Field(
        False,
        description=(
            "require no page-token, because something else controls access to page-host, such as a container's "
            "port published on 127.0.0.1 alone"
        ),
    )
    page_names: Annotated[frozenset[str], NoDecode, BeforeValidator(_names)] = Field(
        frozenset(),
        description="names by which browsers may address this machine, in addition to its own name and its addresses",
    )

    @model_validator(mode="after")
    def _check_token(self) -> Self:
        if not (is_local(self.page_host) or self.page_guarded or self.page_token):
            raise ValueError(
                f"page-host {self.page_host} admits other machines: set page-token (ACTUM_PAGE_TOKEN) to "
                f"{SHORTEST_TOKEN} characters or more, such as 'openssl rand -hex 16' prints"
            )
        return self
