"""A folder for one run of a program: it is deleted with the run, or, if the run is killed, by the next one."""

import shutil
import weakref
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp
from typing import BinaryIO

from actum.atomic_file import claim
from actum.recorder import is_being_written

CLAIM = ".running"
"""The file in the folder of a run that its process has claimed while it runs."""


class RunFolder:
    """A new folder, by default in the system's folder of temporary files; those that killed runs have left are deleted.

    Attributes:
        path: of the folder, whose name begins with `prefix`.

    Raises:
        OSError: it cannot be made.
    """

    def __init__(self, prefix: str, parent: Path | None = None) -> None:
        self.path = Path(mkdtemp(prefix=prefix, dir=parent))
        self.delete = weakref.finalize(self, _delete, self.path, _claimed(self.path))
        _delete_ended(self.path, prefix)


def _claimed(folder: Path) -> BinaryIO:
    """Claim a folder until the file that is returned is closed or the process ends, however it ends."""
    file = (folder / CLAIM).open("wb")
    claim(file)
    file.write(b"claimed\n")  # a file that is empty yet is no claim for others
    file.flush()
    return file


def _delete(folder: Path, claimed: BinaryIO) -> None:
    claimed.close()
    shutil.rmtree(folder, ignore_errors=True)


def _delete_ended(own: Path, prefix: str) -> None:
    """Delete the folders of runs that were killed; none where this run's own claim shows that files are not locked."""
    if not is_being_written(own / CLAIM):
        return
    for claimed in own.parent.glob(f"{prefix}*/{CLAIM}"):
        with suppress(OSError):  # another run has deleted it meanwhile, or it is another user's
            if claimed.stat().st_size and not is_being_written(claimed):
                shutil.rmtree(claimed.parent, ignore_errors=True)
