"""Where the pose model lies: the file that `actum models fetch` makes and the gateway reads."""

import os
import sys
from pathlib import Path

MODEL_NAME = "pose_landmarker_full.task"


def data_folder() -> Path:
    """Name the folder that this system keeps a user's program data in, and ours in it."""
    home = Path.home()
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = home / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_DATA_HOME") or home / ".local" / "share")
    return base / "actum"


def default_model() -> Path:
    """Name the file where the pose model is looked for unless told otherwise."""
    return data_folder() / MODEL_NAME
