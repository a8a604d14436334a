"""What a gateway reads, in words: somebody who looks for their camera is to see at once where there is none."""

from pathlib import Path
from urllib.parse import urlsplit

from sensor_gateway.devices.video import SUFFIXES
from sensor_gateway.settings import Settings


def description(settings: Settings) -> str:
    """Say what the settings have the gateway read: a file or folder, or which camera."""
    if settings.source in ("camera", "marker-camera"):
        return _camera(settings.source.replace("-", " "), settings.camera)
    if settings.path is None:
        return f"depth camera ({settings.source})"
    return f"{'folder' if settings.path.is_dir() else 'file'} {settings.path} ({settings.source})"


def _camera(kind: str, camera: str) -> str:
    if "://" in camera:
        return f"{kind} {_public(camera)}"
    if Path(camera).is_file() or Path(camera).suffix.lower() in SUFFIXES:
        return f"file {camera} ({kind})"
    return f"{kind} {camera}"


def _public(url: str) -> str:
    """Leave out what an address may hold of names, passwords and tokens."""
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"
