"""Jobs on the disk: what each was asked for and what became of it, beyond the end of the service."""

import shutil
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from actum.atomic_file import UNFINISHED, write_whole
from actum.commands import Refusal

MOST_JOBS = 50
"""Ended jobs that are remembered."""
WORK = ".work"
"""Ending of the folder in which a job writes."""
INTERRUPTED = "the service ended while it ran: start it again"


class Job(BaseModel):
    """A job: what it is for, how far it is, and what came of it."""

    model_config = ConfigDict(frozen=True, use_attribute_docstrings=True)

    id: str
    """Its name."""
    kind: Literal["train", "evaluate", "import"]
    """What it does."""
    set: str
    """The set that it works on."""
    started: str
    """When it was started (ISO 8601)."""
    stage: str = "starting"
    """What it does just now, in words."""
    done: float = 0.0
    """How much of that stage is done, 0 to 1."""
    state: Literal["running", "done", "failed", "cancelled"] = "running"
    """What became of it."""
    message: str = ""
    """The result in a sentence, or why there is none."""
    result: dict[str, Any] | None = None
    """The result; null while it runs and where there is none."""


class JobStore:
    """The jobs in a folder; those that a service before this one has left running are cancelled first."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        for left in [*folder.glob(f"*{WORK}")]:
            shutil.rmtree(left, ignore_errors=True)
        for unfinished in folder.glob(f".*{UNFINISHED}"):
            unfinished.unlink(missing_ok=True)
        for job in self.all():
            if job.state == "running":
                self.keep(job.model_copy(update={"state": "cancelled", "message": INTERRUPTED}))

    def all(self) -> list[Job]:
        """List the jobs, the oldest first; a file that is none is left out."""
        jobs = [_read(path) for path in self._folder.glob("job-*.json")]
        return sorted((job for job in jobs if job is not None), key=lambda job: number_of(job.id))

    def get(self, job_id: str) -> Job:
        """Return a job.

        Raises:
            Refusal: there is none of that id.
        """
        for job in self.all():
            if job.id == job_id:
                return job
        raise Refusal(f"there is no job {job_id!r}; the newest {MOST_JOBS} are remembered")

    def new_id(self) -> str:
        """Return the id of the next job: no file has it, also none that cannot be read."""
        return f"job-{max((number_of(path.stem) for path in self._folder.glob('job-*.json')), default=0) + 1}"

    def keep(self, job: Job) -> None:
        """Write a job, and forget the oldest where there are many."""
        write_whole(self._folder / f"{job.id}.json", job.model_dump_json().encode())
        for old in self.all()[:-MOST_JOBS]:
            (self._folder / f"{old.id}.json").unlink(missing_ok=True)

    def work_folder(self, job_id: str) -> Path:
        """Make the folder in which a job writes."""
        folder = self._folder / f"{job_id}{WORK}"
        folder.mkdir(exist_ok=True)
        return folder

    def clear(self, job_id: str) -> None:
        """Delete the folder in which a job wrote."""
        shutil.rmtree(self._folder / f"{job_id}{WORK}", ignore_errors=True)


def number_of(job_id: str) -> int:
    """Return a job's number, by which jobs are in order; 0 where a file is named otherwise."""
    digits = job_id.removeprefix("job-")
    return int(digits) if digits.isdecimal() else 0


def _read(path: Path) -> Job | None:
    try:
        return Job.model_validate_json(path.read_bytes())
    except (OSError, ValidationError):
        return None
