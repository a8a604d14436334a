"""The description of a gateway's source in `info`, by which a user notices that the wrong camera or file is read."""

from pathlib import Path
from urllib.parse import urlsplit

from sensor_gateway.devices.video import SUFFIXES
from sensor_gateway.settings import Settings


def description(settings: Settings) -> str:
    """Describe the source that the settings name: a file, a folder or a camera."""
    if settings.source in ("camera", "marker-camera"):
        return _camera_description(settings.source.replace("-", " "), settings.camera)
    if settings.path is None:
        return f"depth camera ({settings.source})"
    return f"{'folder' if settings.path.is_dir() else 'file'} {settings.path} ({settings.source})"


def _camera_description(kind: str, camera: str) -> str:
    if "://" in camera:
        return f"{kind} {_without_credentials(camera)}"
    if Path(camera).is_file() or Path(camera).suffix.lower() in SUFFIXES:
        return f"file {camera} ({kind})"
    return f"{kind} {camera}"


def _without_credentials(url: str) -> str:
    """Return an address without user name, password and query, which may hold secrets."""
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"
