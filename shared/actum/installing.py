"""How this package is installed: from its repository's folder or from a wheel, for no package index has it."""

import json
import shlex
from importlib.metadata import distribution
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from actum import __version__

INDEX_NAME: str | None = None
"""The name of this package on PyPI, None while it is not there: whoever registers `actum` has their code run.

Once it is set, error texts name it, and `make pages` writes it on the pages."""
FOLDER = "."
"""The repository's folder, for a shell that is in it."""
WHEEL = f"./actum-{__version__}-py3-none-any.whl"
"""The wheel that `make wheel` writes, for a shell that is in its folder."""


def pip_install(extras: str, origin: str = FOLDER, flag: str = "") -> str:
    """Return the command that installs this package with extras, from an index that has it or else from an origin."""
    if INDEX_NAME is not None:
        return f"pip install '{INDEX_NAME}[{extras}]'"
    return f"pip install {flag}{shlex.quote(f'{origin}[{extras}]')}"


def install_command(extras: str) -> str:
    """Return the command that adds extras to this installation, from the folder or the wheel that it came from."""
    from urllib.request import url2pathname  # it imports HTTP, which running services do without

    text = distribution("actum").read_text("direct_url.json")
    written_by_pip: dict[str, Any] = json.loads(text) if text else {}
    url = urlsplit(written_by_pip.get("url", ""))
    origin = Path(url2pathname(url.path))
    if url.scheme == "file" and origin.exists():
        return pip_install(extras, str(origin), "-e " if written_by_pip.get("dir_info", {}).get("editable") else "")
    return pip_install(extras) if INDEX_NAME else f"{pip_install(extras)} in the folder of actum's repository"
