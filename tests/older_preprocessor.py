"""The preprocessor of an earlier version of actum, as a process."""

from actum.runtime import reporting
from pose_preprocessor import __main__

if __name__ == "__main__":
    reporting.__version__ = "0.0.9"
    __main__.main()
