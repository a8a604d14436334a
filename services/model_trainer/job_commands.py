"""The commands that start, watch and end jobs."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from actum.commands import Command, Refusal
from actum.messages import JobState
from model_trainer.changes import Changes, on_disk
from model_trainer.job import MODEL, TAKE, Arguments
from model_trainer.job_process import Ended, JobProcess
from model_trainer.job_store import Job, JobStore
from model_trainer.model_store import ModelStore
from model_trainer.replies import Uploaded, counted
from model_trainer.requests import ImportVideo, OfJob, OfSet, Train, Upload
from model_trainer.set_store import SetStore
from model_trainer.upload_store import UploadStore
from som_classifier.model_loading import ModelError
from som_classifier.presets import DEFAULT, PRESETS

Start = Callable[[Arguments], JobProcess]
"""Starts a job."""
KINDS = {"train": "a training", "evaluate": "a test", "import": "a video import"}
"""What a job is called, by its kind."""
UPLOAD = "upload"
"""The folder, within a job's, of the video that it imports."""
LONGEST_TEXT = 1000
"""Characters of a stage or message that are published."""


class JobCommands:
    """Runs one job at a time, and keeps what comes of it."""

    def __init__(
        self,
        sets: SetStore,
        models: ModelStore,
        uploads: UploadStore,
        jobs: JobStore,
        changes: Changes,
        start: Start,
        date: Callable[[], str],
    ) -> None:
        self._sets = sets
        self._models = models
        self._uploads = uploads
        self._jobs = jobs
        self._changes = changes
        self._start_process = start
        self._date = date
        self._job = jobs.newest()
        self._running: JobProcess | None = None

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """What can be asked."""
        return (
            Command("upload", Upload, Uploaded, self._upload),
            Command("import_video", ImportVideo, Job, self._import_video),
            Command("train", Train, Job, self._train),
            Command("evaluate", OfSet, Job, self._evaluate),
            Command("cancel", OfJob, Job, self._cancel),
            Command("job", OfJob, Job, self._ask),
        )

    @property
    def state(self) -> JobState | None:
        """The job that is running, or the newest one; None before the first."""
        job = self._job
        if job is None:
            return None
        return JobState(
            id=job.id,
            kind=job.kind,
            stage=job.stage[:LONGEST_TEXT],
            done=job.done,
            state=job.state,
            message=job.message[:LONGEST_TEXT],
        )

    def working_on(self, name: str) -> str | None:
        """Say which running job reads that set, is to add a take to it or to name it; None where none does."""
        job = self._job
        return KINDS[job.kind] if job is not None and (job.state, job.set) == ("running", name) else None

    def look(self) -> None:
        """Look how far the running job is, and keep what it made once it has ended."""
        if self._running is None:
            return
        assert self._job is not None
        news = self._running.look()
        if isinstance(news, Ended):
            self._running = None
            self._end(self._kept(self._job, news))
        elif news is not None:
            self._job = self._job.model_copy(update={"stage": news.stage, "done": news.done})

    def _upload(self, request: Upload) -> Uploaded:
        """Send a file in pieces, such as a video for 'import_video'."""
        with on_disk():
            size = self._uploads.add(request.name, request.offset, request.data, request.last)
        return Uploaded(upload=request.name, size=size)

    def _import_video(self, request: ImportVideo) -> Job:
        """Make a take of a video that was sent: find the person in it, cut the examples out, and delete the video."""
        self._uploads.refuse_missing(request.upload)
        fields = {"created": self._date(), **request.model_dump(include={"label", "person", "count"})}
        return self._start("import", request.set, fields, request.upload)

    def _train(self, request: Train) -> Job:
        """Train a model on a set; 'activate' puts it into use."""
        if request.preset not in PRESETS:
            raise Refusal(f"there is no preset {request.preset!r}: use one of {', '.join(PRESETS)}")
        fields: dict[str, Any] = request.model_dump(include={"preset", "seed", "continued"})
        if request.update is not None:
            fields["model"] = self._models.get(request.update).path
        return self._start("train", request.set, fields)

    def _evaluate(self, request: OfSet) -> Job:
        """Test what a set teaches, leaving out each person or each third in turn; say what to record next."""
        return self._start("evaluate", request.set, {"preset": DEFAULT.name})

    def _cancel(self, request: OfJob) -> Job:
        """End a running job; it leaves nothing."""
        job = self._jobs.get(request.job)
        if self._running is None or self._job is None or self._job.id != job.id:
            raise Refusal(
                f"the job {job.id} cannot be cancelled, because its state is {job.state}: only running jobs can be "
                "cancelled"
            )
        self._running.end()
        self._running = None
        return self._end(self._job.model_copy(update={"state": "cancelled", "message": "cancelled"}))

    def _ask(self, request: OfJob) -> Job:
        """Return how far a job is, and its result."""
        return self._job if self._job is not None and self._job.id == request.job else self._jobs.get(request.job)

    def _start(self, kind: str, set_name: str, fields: dict[str, Any], upload: str | None = None) -> Job:
        """Start a job; an upload goes into its folder, where nobody can replace it, and is deleted with that."""
        if self._running is not None and self._job is not None:
            raise Refusal(
                f"the job {self._job.id} ({KINDS[self._job.kind]}) is still running: wait until this job ends, or "
                "cancel it"
            )
        takes = self._sets.folder(set_name)
        with on_disk():
            job = Job.model_validate(
                {"id": self._jobs.new_id(), "kind": kind, "set": set_name, "started": self._date()}
            )
            folder = self._jobs.work_folder(job.id)
            video: Path | None = None
            try:
                if upload is not None:
                    (folder / UPLOAD).mkdir()
                    video = self._uploads.move(upload, folder / UPLOAD)
                    fields = {"video": video, **fields}
                self._jobs.keep(job)
                arguments = Arguments.model_validate({"kind": kind, "folder": folder, "takes": takes, **fields})
                self._running = self._start_process(arguments)
            except OSError:
                if video is not None:
                    self._uploads.put_back(video)
                self._jobs.forget(job.id)
                raise
        self._job = job
        return job

    def _end(self, job: Job) -> Job:
        """Note what became of a job, and delete what it wrote besides."""
        self._job = job
        self._jobs.clear(job.id)
        with suppress(OSError):  # a full disk: after a restart it counts as cancelled
            self._jobs.keep(job)
        return job

    def _kept(self, job: Job, ended: Ended) -> Job:
        """Keep what a job has made; return the job as it ended."""
        if ended.result is None:
            return job.model_copy(update={"state": "failed", "message": ended.error})
        try:
            message = self._keep(job, ended.result)
        except (OSError, ModelError, Refusal) as error:
            return job.model_copy(update={"state": "failed", "message": str(error)})
        return job.model_copy(update={"state": "done", "done": 1.0, "message": message, "result": ended.result})

    def _keep(self, job: Job, result: dict[str, Any]) -> str:
        """Keep a job's model or take; return its result in a sentence."""
        folder = self._jobs.work_folder(job.id)
        if job.kind == "train":
            stored = self._models.add(folder / MODEL, job.set, result["scores"], job.started)
            self._changes.revision += 1
            return f"model {stored.id}: {counted(stored.samples, 'example')} of {counted(len(stored.labels), 'action')}"
        if job.kind == "import":
            result["take"] = self._sets.add(job.set, folder / TAKE).id
            self._changes.revision += 1
            return f"{counted(result['examples'], 'example')} cut out of the video"
        part = "person" if result["by"] == "people" else "third"
        tested = counted(result["n"], "example")
        return f"{result['accuracy']:.0%} of {tested} recognised, each {part} left out of the training in turn"
