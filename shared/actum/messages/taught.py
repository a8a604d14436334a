"""The message in which the trainer says what it is doing."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from actum.messages.base import Count, Message, Model, Name, Reason


class TakeState(Model):
    """The take that is being recorded, or the newest one."""

    set: Name
    """The set that it belongs to."""
    label: Name
    """The action that is done; empty for background."""
    person: Name
    """Who acts; empty where nobody said."""
    kind: Literal["action", "background"]
    """Whether one action is repeated, or people do none of the actions."""
    asked: Count
    """How many repetitions there are to be; 0 for background."""
    counted: Count
    """How many there are so far."""
    phase: Literal["waiting", "moving", "resting", "done"]
    """What the person does now: waiting before the first movement, moving, resting, or done, as the take has ended."""
    seconds: Annotated[FiniteFloat, Field(ge=0)]
    """How long it has lasted, by the stamps of the skeletons (s)."""
    people: Count = 0
    """How many people are seen in the newest frame."""
    doubts: list[Reason] = Field([])
    """What may be wrong with the take that has ended, in sentences."""


class JobState(Model):
    """The job that is running, or the newest one."""

    id: Name
    """The job's name, by which its result can be asked for."""
    kind: Literal["train", "evaluate", "import"]
    """What it does."""
    stage: Reason
    """What it does just now, in words."""
    done: Annotated[FiniteFloat, Field(ge=0, le=1)]
    """How much of that stage is done."""
    state: Literal["running", "done", "failed", "cancelled"]
    """What became of it."""
    message: Reason
    """The result in a sentence, or why there is none; empty while it runs."""


class Training(Message):
    """What the trainer does and has: put with each change and each second."""

    SCHEMA = "actum.training"
    recording: TakeState | None
    """The take that is being recorded, or the newest one; null before the first."""
    job: JobState | None
    """The job that is running, or the newest one; null before the first."""
    model: Name | None
    """Which model the classifier is to use; null where there is none."""
    can_undo: bool
    """Whether there is a model that was in use before it."""
    revision: Count
    """A number that rises with each change of the sets and models: list them anew."""
    model_set: Name | None = None
    """The set that the model was trained on; null where that is not known."""
    model_file: Reason | None = None
    """The file that the model was copied from: the one that somebody named for use, or the one that ships with actum;
    null where the model was put into use by the trainer."""
