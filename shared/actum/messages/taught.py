"""The message in which the trainer says what it is doing."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from actum.messages.base import Count, Message, Model, Name, Reason


class TakeState(Model):
    """The take that is being recorded, or the newest one."""

    set: Name
    """The set to which the take belongs."""
    label: Name
    """The action that is done; empty for background."""
    person: Name
    """The name of the person who acts; empty if not given."""
    kind: Literal["action", "background"]
    """`action` if one action is repeated, `background` if people do none of the actions."""
    asked: Count
    """Number of repetitions to record; 0 for background."""
    counted: Count
    """Number of repetitions counted so far."""
    phase: Literal["waiting", "moving", "resting", "done"]
    """What the person does now: waiting before the first movement, moving, or resting; done if the take has ended."""
    seconds: Annotated[FiniteFloat, Field(ge=0)]
    """How long the take has lasted, by the stamps of the skeletons (s)."""
    people: Count = 0
    """Number of people in the newest frame."""
    doubts: list[Reason] = Field([])
    """What may be wrong with the take, in sentences, once it has ended."""


class JobState(Model):
    """The job that is running, or the newest one."""

    id: Name
    """The job's id, with which its result can be requested."""
    kind: Literal["train", "evaluate", "import"]
    """What the job does."""
    stage: Reason
    """What the job is doing now, in words."""
    done: Annotated[FiniteFloat, Field(ge=0, le=1)]
    """The fraction of this stage that is done."""
    state: Literal["running", "done", "failed", "cancelled"]
    """Whether the job is running or how it ended."""
    message: Reason
    """The result in a sentence, or why there is none; empty while the job runs."""


class Training(Message):
    """What the trainer does and has: put with each change and each second."""

    SCHEMA = "actum.training"
    recording: TakeState | None
    """The take that is being recorded, or the newest one; null before the first take."""
    job: JobState | None
    """The job that is running, or the newest one; null before the first job."""
    model: Name | None
    """The model that the classifier is to use; null if there is none."""
    can_undo: bool
    """Whether there is a previous model to return to."""
    revision: Count
    """A number that rises with each change of the sets and models; after a change, list them again."""
    model_set: Name | None = None
    """The set on which the model was trained; null if unknown."""
    model_file: Reason | None = None
    """The file from which the model was copied: the file that somebody named for use, or the one that ships with actum;
    null if the trainer put the model into use."""
