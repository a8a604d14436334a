"""The cameras that this machine has, as Linux lists them."""

import sys
from pathlib import Path

LISTED = Path("/sys/class/video4linux")
"""Linux's folder with a folder for each video device: its name, and its index among those of one camera."""


def present_cameras(listed: Path = LISTED) -> str | None:
    """Return this machine's cameras in words, by the numbers that `--camera` takes; None where none can be listed."""
    if not sys.platform.startswith("linux"):
        return None
    numbered = {int(path.name.removeprefix("video")): path for path in listed.glob("video[0-9]*")}
    cameras = [
        f"{number} ({_text(path / 'name')})"
        for number, path in sorted(numbered.items())
        if _text(path / "index") == "0"  # the others give no pictures, but what belongs to them
    ]
    return f"the cameras here are {', '.join(cameras)}" if cameras else "this machine has no camera"


def _text(file: Path) -> str:
    try:
        return file.read_text(errors="replace").strip()
    except OSError:
        return ""
