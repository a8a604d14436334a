"""A folder of credentials, which `actum deploy init` writes for one role: who a program is to a router that asks."""

import json
import os
import ssl
from pathlib import Path
from typing import Any

from actum.settings import SettingsError

AUTHORITY = "ca.pem"
"""The certificates of the authority that all others of a deployment are signed by."""
CERTIFICATE = "certificate.pem"
"""The role's own certificate: its common name is what routers know it by."""
KEY = "key.pem"
"""The private key of that certificate."""
USER = "user.json5"
"""The role's user name and password, where the routers ask for these too."""
USERS = "users.txt"
"""The user names and passwords that a router accepts, in its own folder."""

TLS = "transport/link/tls"
"""Where Zenoh's configuration has what concerns TLS."""
LOGIN = "transport/auth/usrpwd"
"""Where it has user names and passwords."""


def client_values(folder: Path) -> dict[str, Any]:
    """Return the values of Zenoh's configuration by which a client shows its certificate and asks for the router's."""
    return {
        f"{TLS}/root_ca_certificate": str(folder / AUTHORITY),
        f"{TLS}/connect_certificate": str(folder / CERTIFICATE),
        f"{TLS}/connect_private_key": str(folder / KEY),
        f"{TLS}/enable_mtls": True,
        f"{TLS}/close_link_on_expiration": True,
    }


def router_values(folder: Path, passwords: bool) -> dict[str, Any]:
    """Return the same for a router, which shows its certificate to clients and to other routers.

    With `passwords` it lets in only who is in its list of users as well.
    """
    return {
        **client_values(folder),
        f"{TLS}/listen_certificate": str(folder / CERTIFICATE),
        f"{TLS}/listen_private_key": str(folder / KEY),
        **({f"{LOGIN}/dictionary_file": str(folder / USERS)} if passwords else {}),
    }


def login_values(folder: Path) -> dict[str, str]:
    """Return user name and password as values of Zenoh's configuration; none where the folder has none.

    They are secret: they go into a configuration just before it is opened, and nowhere else.

    Raises:
        SettingsError: the file cannot be used; the text does not quote it.
    """
    file = folder / USER
    if not file.exists():
        return {}
    try:
        login = json.loads(file.read_text(encoding="utf-8"))["transport"]["auth"]["usrpwd"]
        return {f"{LOGIN}/{name}": login[name] for name in ("user", "password")}
    except OSError as error:
        raise SettingsError(_unreadable(file, error)) from None
    except (ValueError, TypeError, KeyError):
        raise SettingsError(
            f"credentials: {file} contains no user name and password: copy the credentials folder to this machine again"
        ) from None


def check(folder: Path) -> None:
    """Check that a folder's files can be used together.

    Raises:
        SettingsError: a file is missing, cannot be read, or the key is not the certificate's.
    """
    for name in (AUTHORITY, CERTIFICATE, KEY):
        try:
            (folder / name).open("rb").close()
        except OSError as error:
            raise SettingsError(_unreadable(folder / name, error)) from None
    try:
        ssl.create_default_context(cafile=folder / AUTHORITY).load_cert_chain(folder / CERTIFICATE, folder / KEY)
    except ssl.SSLError as error:
        problem = error.reason or "no certificate"
        raise SettingsError(
            f"credentials: the certificate and key files in {folder} cannot be used together ({problem}): copy the "
            "credentials folder to this machine again"
        ) from None


def _unreadable(file: Path, error: OSError) -> str:
    missing = isinstance(error, FileNotFoundError)
    remedy = (
        "correct ACTUM_CREDENTIALS, or copy the credentials folder to this machine again"
        if missing
        else "give that user read permission"
    )
    who = f"user {os.getuid()}" if hasattr(os, "getuid") else "this user"
    return f"credentials: {file} cannot be read by {who} ({error.strerror}): {remedy}"
