"""Jobs on the disk: what each was asked for and what became of it, beyond the end of the service."""

import json
import re
import shutil
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat

from actum.atomic_file import clear_unfinished, write_whole
from actum.commands import Refusal
from actum.recorder import is_being_written
from model_trainer.job_process import CLAIM
from model_trainer.small_files import small_file

MOST_JOBS = 50
"""Ended jobs that are remembered."""
WORK = ".work"
"""Ending of the folder in which a job writes."""
JOB_ID = re.compile(r"job-[0-9]{1,9}")
"""What a job's id, and with it its file, is called."""
INTERRUPTED = "the service ended while this job ran: start the job again"


def _finite(value: Any) -> Any:
    json.dumps(value, allow_nan=False)
    return value


FiniteJson = Annotated[Any, AfterValidator(_finite)]
"""A value that JSON can hold."""


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
    done: Annotated[FiniteFloat, Field(ge=0, le=1)] = 0.0
    """How much of that stage is done, 0 to 1."""
    state: Literal["running", "done", "failed", "cancelled"] = "running"
    """What became of it."""
    message: str = ""
    """The result in a sentence, or why there is none."""
    result: dict[str, FiniteJson] | None = None
    """The result; null while it runs and where there is none."""


class JobStore:
    """The jobs in a folder; those that a service before this one has left running are cancelled first."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        for left in folder.iterdir():
            if left.suffix == WORK and JOB_ID.fullmatch(left.stem) and not self._runs_elsewhere(left.stem):
                shutil.rmtree(left, ignore_errors=True)
        clear_unfinished(folder)
        for job in self.all():
            if job.state == "running" and not self._runs_elsewhere(job.id):
                self.keep(job.model_copy(update={"state": "cancelled", "message": INTERRUPTED}))

    def all(self) -> list[Job]:
        """List the jobs, the oldest first; a file that is none is left out."""
        jobs = [_read(path) for path in self._folder.glob("job-*.json") if JOB_ID.fullmatch(path.stem)]
        return sorted((job for job in jobs if job is not None), key=lambda job: number_of(job.id))

    def newest(self) -> Job | None:
        """Return the newest job that has ended; None before the first."""
        return next((job for job in reversed(self.all()) if job.state != "running"), None)

    def get(self, job_id: str) -> Job:
        """Return a job.

        Raises:
            Refusal: there is none of that id.
        """
        for job in self.all():
            if job.id == job_id:
                return job
        raise Refusal(f"there is no job {job_id!r}: correct the id; only the newest {MOST_JOBS} jobs are kept")

    def new_id(self) -> str:
        """Return the id of the next job, which no file has, whatever is in it."""
        stems = (path.stem for path in self._folder.iterdir())
        return f"job-{max((number_of(stem) for stem in stems if JOB_ID.fullmatch(stem)), default=0) + 1}"

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

    def forget(self, job_id: str) -> None:
        """Delete a job that has not begun, and its folder."""
        self.clear(job_id)
        (self._folder / f"{job_id}.json").unlink(missing_ok=True)

    def clear(self, job_id: str) -> None:
        """Delete the folder in which a job wrote."""
        shutil.rmtree(self._folder / f"{job_id}{WORK}", ignore_errors=True)

    def _runs_elsewhere(self, job_id: str) -> bool:
        """Return whether another trainer runs a job: one of another sensor, in the same folder."""
        return is_being_written(self._folder / f"{job_id}{WORK}" / CLAIM)


def number_of(job_id: str) -> int:
    """Return a job's number, by which jobs are in order."""
    return int(job_id.removeprefix("job-"))


def _read(path: Path) -> Job | None:
    """Read a job; None for a file that is none, or that says it is another than its name."""
    try:
        job = Job.model_validate_json(small_file(path))
    except (OSError, ValueError):
        return None
    return job if job.id == path.stem else None
