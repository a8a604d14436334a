"""Who may use what is served to browsers: checks of names, origins and tokens, and the headers of every answer.

A page of another site must not get in through a visitor's browser: neither by a WebSocket, which browsers open across
sites (so the origin is checked), nor under a name that is made to point here (DNS rebinding, so the host is checked).
"""

import hashlib
import hmac
import socket
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from urllib.parse import parse_qs, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from web_dashboard.settings import is_local

MISDIRECTED, UNAUTHORIZED, FORBIDDEN = 421, 401, 403
TOKEN_NEEDED = """This page needs its token: open it as http://…/?token=TOKEN

The token is what was set as ACTUM_PAGE_TOKEN or --page-token where the page is served.
"""


@dataclass(frozen=True)
class Rule:
    """Who may come in.

    Attributes:
        host: the address that is served.
        names: names of this machine, beside its own and its addresses.
        token: the word that opens what is served; None where none is needed.
        origins: other sites whose pages may open a WebSocket.
        advice: what to do where somebody is refused wrongly, by the status code of the refusal.
    """

    host: str
    names: Collection[str] = ()
    token: str | None = None
    origins: Collection[str] = ()
    advice: Mapping[int, str] = field(default_factory=dict)


class Admission:
    """Middleware that refuses who may not come in."""

    def __init__(self, app: ASGIApp, rule: Rule, refused: Callable[[str], object]) -> None:
        self._app = app
        self._rule = rule
        self._refused = refused
        self._secret = hashlib.sha256((rule.token or "").encode()).hexdigest()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        answer = self._answer(scope)
        if answer is None:
            await self._app(scope, receive, send)
        elif scope["type"] == "http":
            await answer(scope, receive, send)
        else:
            await send({"type": "websocket.close", "code": 1008})  # before it is accepted: HTTP 403

    def _answer(self, scope: Scope) -> Response | None:
        """Return what is answered instead of the page; None where the request may pass."""
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if not self._is_ours(host):
            return self._refusal(MISDIRECTED, f"{host!r} is no name of what is served here")
        own = (None, f"http://{host}", f"https://{host}")
        if scope["type"] == "websocket" and headers.get("origin") not in (*own, *self._rule.origins):
            return self._refusal(FORBIDDEN, f"a page of {headers.get('origin')!r} may not come in here")
        if self._rule.token is None or self._has_cookie(scope, headers):
            return None
        given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        if scope["type"] == "http" and hmac.compare_digest(given.encode(), self._rule.token.encode()):
            answer = RedirectResponse("/", status_code=303)
            answer.set_cookie(_cookie_name(scope), self._secret, httponly=True, samesite="strict", max_age=30 * 86400)
            return answer
        return self._refusal(UNAUTHORIZED, TOKEN_NEEDED)

    def _refusal(self, status: int, refusal: str) -> Response:
        advice = self._rule.advice.get(status)
        answer = f"{refusal}: {advice}" if advice else refusal
        self._refused(answer.partition("\n")[0][:200])
        return PlainTextResponse(answer, status)

    def _is_ours(self, host: str) -> bool:
        """Return whether a Host header names this machine: by an address, or by a name that is known to be its."""
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            return False
        if name == "localhost" or name in self._rule.names:
            return True
        local = is_local(self._rule.host)
        try:
            return ip_address(name).is_loopback or not local
        except ValueError:
            return not local and name in {self._rule.host, *_own_names()}

    def _has_cookie(self, scope: Scope, headers: Headers) -> bool:
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(_cookie_name(scope))
        except CookieError:
            return False
        return cookie is not None and hmac.compare_digest(cookie.value.encode(), self._secret.encode())


def _cookie_name(scope: Scope) -> str:
    """Name the cookie after the port: browsers send cookies to all ports of a machine."""
    return f"actum_page_{scope['server'][1]}"


def _own_names() -> set[str]:
    name = socket.gethostname().lower()
    return {name, f"{name}.local"}


class Guarding:
    """Middleware that adds the headers that keep the page to itself."""

    def __init__(self, app: ASGIApp, policy: str) -> None:
        self._app = app
        self._headers = {
            "content-security-policy": policy,
            "x-content-type-options": "nosniff",
            "referrer-policy": "no-referrer",
            "cross-origin-opener-policy": "same-origin",
            "cross-origin-resource-policy": "same-origin",
            "permissions-policy": "camera=(), microphone=(), geolocation=()",
            "cache-control": "no-cache",
        }

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, and add to the answer's headers."""

        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(self._headers)
            await send(message)

        await self._app(scope, receive, send_guarded)
