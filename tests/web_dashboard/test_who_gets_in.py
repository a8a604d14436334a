"""Who may open the page: only under its own names, only from its own origin, and from elsewhere with its token."""

import http.client
import re
from pathlib import Path

import pytest
from pydantic import ValidationError
from websockets.exceptions import InvalidStatus

import web_dashboard
from actum.settings import SettingsError
from dashboards import Served, heard, served
from web_dashboard.server import bound_socket
from web_dashboard.settings import Settings

TOKEN = "0123456789abcdef"
PAGE = Path(web_dashboard.__file__).parent / "page"


@pytest.fixture(scope="module")
def page() -> Served:
    with served() as made:
        yield made


@pytest.fixture(scope="module")
def guarded() -> Served:
    with served(page_host="0.0.0.0", page_token=TOKEN, page_names="lab.example") as made:
        yield made


def get(page: Served, path: str = "/", **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", int(page.host.rpartition(":")[2]), timeout=10)
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    response.text = response.read().decode()  # type: ignore[attr-defined]
    connection.close()
    return response


def port_of(page: Served) -> str:
    return page.host.rpartition(":")[2]


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]"])
def test_it_is_opened_by_the_names_of_this_machine(page: Served, name: str) -> None:
    assert get(page, Host=f"{name}:{port_of(page)}").status == 200


@pytest.mark.parametrize(
    "name", ["evil.example", "127.0.0.1.evil.example", "192.0.2.1", "", "[", "localhost.evil.example"]
)
def test_under_another_name_it_is_not_served(page: Served, name: str) -> None:
    refused = get(page, Host=f"{name}:{port_of(page)}")
    assert refused.status == 421
    assert page.rejects()["refused_browser"] > 0


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://localhost"])
def test_a_page_of_another_site_opens_no_websocket(page: Served, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused, page.browser(origin=origin):
        pass
    assert refused.value.response.status_code == 403


def test_its_own_page_does(page: Served) -> None:
    with page.browser(origin=page.address.rstrip("/")) as browser:
        heard(browser, "hello")


def test_nor_does_one_whose_name_was_made_to_point_here(page: Served) -> None:
    name = f"evil.example:{port_of(page)}"
    with pytest.raises(InvalidStatus) as refused, page.browser(host=name, origin=f"http://{name}"):
        pass
    assert refused.value.response.status_code == 403


def test_other_machines_need_the_token_for_every_file_and_the_websocket(guarded: Served) -> None:
    for path in ("/", "/page/main.js", "/?token=wrong", f"/?token={TOKEN}x", "/?token="):
        assert get(guarded, path).status == 401, path
    with pytest.raises(InvalidStatus), guarded.browser(host=f"127.0.0.1:{port_of(guarded)}"):
        pass


def test_the_token_opens_it_once_and_a_cookie_from_then_on(guarded: Served) -> None:
    opened = get(guarded, f"/?token={TOKEN}")
    assert (opened.status, opened.headers["location"]) == (303, "/")
    cookie = opened.headers["set-cookie"]
    assert "HttpOnly" in cookie and "SameSite=strict" in cookie
    assert TOKEN not in cookie
    held = cookie.partition(";")[0]
    assert get(guarded, Cookie=held).status == 200
    assert get(guarded, Cookie=held + "x").status == 401
    with guarded.browser(host=f"127.0.0.1:{port_of(guarded)}", headers={"Cookie": held}) as browser:
        heard(browser, "hello")


def test_a_page_for_others_has_the_names_that_are_listed_and_no_other(guarded: Served) -> None:
    assert get(guarded, f"/?token={TOKEN}", Host="lab.example").status == 303
    assert get(guarded, f"/?token={TOKEN}", Host="192.0.2.7:8080").status == 303
    assert get(guarded, f"/?token={TOKEN}", Host="evil.example").status == 421


def test_others_are_not_let_in_without_a_token() -> None:
    with pytest.raises(
        ValidationError, match="lets other machines open the page, which therefore needs a token: set page-token"
    ):
        Settings(page_host="0.0.0.0")
    with pytest.raises(ValidationError, match="at least 16 characters"):
        Settings(page_host="0.0.0.0", page_token="short")
    assert Settings(page_host="0.0.0.0", page_guarded=True).page_token is None


def test_a_port_that_is_taken_is_refused_and_the_next_one_taken_where_none_is_set() -> None:
    with bound_socket("127.0.0.1", None) as first, bound_socket("127.0.0.1", None) as second:
        assert first.getsockname()[1] < second.getsockname()[1]
        with pytest.raises(SettingsError, match="choose another --page-port"):
            bound_socket("127.0.0.1", first.getsockname()[1])


@pytest.mark.parametrize(
    "path", ["/page/../settings.py", "/page/%2e%2e/settings.py", "/page/..%2fsettings.py", "/etc/passwd"]
)
def test_only_the_pages_own_files_are_served(page: Served, path: str) -> None:
    assert get(page, path).status == 404


def test_nothing_from_elsewhere_is_allowed_or_named(page: Served) -> None:
    policy = get(page).headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "http" not in policy
    own = [file for file in PAGE.rglob("*") if file.suffix in (".js", ".css", ".html") and "vendored" not in file.parts]
    assert len(own) > 15
    named = {address for file in own for address in re.findall(r"(?:https?|wss?)://[\w.]+", file.read_text())}
    assert named == set()


def test_every_answer_is_kept_from_frames_guessing_and_referrers(page: Served) -> None:
    for path in ("/", "/page/main.js", "/nowhere"):
        headers = get(page, path).headers
        assert headers["x-content-type-options"] == "nosniff"
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert headers["referrer-policy"] == "no-referrer"
    assert "access-control-allow-origin" not in get(page, Origin="http://evil.example").headers
