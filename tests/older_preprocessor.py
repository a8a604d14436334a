"""The preprocessor of an earlier version of actum, as a process."""

import actum

actum.__version__ = "0.0.9"

from pose_preprocessor import __main__  # noqa: E402  once it is of that version

if __name__ == "__main__":
    __main__.main()
