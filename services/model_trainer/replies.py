"""What the trainer's commands answer."""

from typing import Literal

from pydantic import BaseModel, ConfigDict

from actum.messages import MANUAL, JobState, TakeState
from actum_examples.marked_segment import MarkedSegment
from actum_examples.take import Take
from model_trainer.stored_model import StoredModel

Joint = list[float] | None


class Reply(BaseModel):
    """An answer; what stands below each field is its description."""

    model_config = ConfigDict(use_attribute_docstrings=True)


class Done(Reply):
    """The command was carried out."""

    revision: int
    """A number that rises with each change of the sets and models."""


class TakeListed(Reply):
    """A take of a set."""

    id: str
    """Its name."""
    kind: Literal["action", "background"]
    """What it was recorded for."""
    person: str
    """Who acts; empty where nobody said."""
    created: str
    """When it was recorded (ISO 8601)."""
    duration_s: float
    """How long it is (s)."""
    examples: int
    """How many examples are in it."""
    doubts: list[str]
    """What may be wrong with the take as a whole."""

    @classmethod
    def of(cls, take: Take) -> "TakeListed":
        """Describe a take."""
        return cls(
            id=take.id,
            kind=take.kind,
            person=take.person,
            created=take.created,
            duration_s=(take.last_ns - take.first_ns) / 1e9,
            examples=len(take.examples),
            doubts=list(take.doubts),
        )


class SetListed(Reply):
    """A set."""

    name: str
    """Its name."""
    created: str
    """When it was made (ISO 8601); empty where that cannot be read."""
    actions: dict[str, int]
    """The number of examples of each action."""
    people: list[str]
    """Who is in it."""
    background_s: float
    """For how long its takes show people who do none of the actions (s)."""
    corrections: int
    """How many corrections in it the model in use does not know: those made after its training began."""
    takes: list[TakeListed]
    """Its recordings."""
    unreadable: list[str]
    """Of each file in it that cannot be read, or not to its end, why."""


class ModelListed(Reply):
    """A model."""

    id: str
    """Its name: a digest of all it holds."""
    created: str
    """When its training began, or when it came from elsewhere (ISO 8601)."""
    set: str
    """The set that it was trained on; empty where that is not known."""
    labels: list[str]
    """The actions that it tells apart."""
    people: list[str]
    """Whose examples it was trained on."""
    samples: int
    """How many examples these were."""
    active: bool
    """Whether the classifier uses it."""
    scores: dict[str, float]
    """How well it does: `accuracy_held_out` is the share of right answers to examples that were left out."""

    @classmethod
    def of(cls, stored: StoredModel, active: str | None) -> "ModelListed":
        """Describe a model."""
        return cls(id=stored.id, active=stored.id == active, **stored.model_dump())


class Everything(Reply):
    """All sets and models."""

    sets: list[SetListed]
    """The sets, by name."""
    models: list[ModelListed]
    """The models, the oldest first."""
    active: str | None
    """The model that the classifier is to use; null where there is none."""
    presets: list[str]
    """The names of training parameters, the usual one first."""
    revision: int
    """A number that rises with each change of the sets and models."""
    unreadable: list[str] = []
    """Of each set and model that cannot be read, why."""


class ExampleListed(Reply):
    """An example."""

    id: str
    """What commands call it."""
    take: str
    """The take that it is part of."""
    label: str
    """What is done in it."""
    person: str
    """Who acts; empty where nobody said."""
    agent: int | None
    """Who acts, by the number in the take's skeletons; null where whoever is nearest is meant."""
    start_ns: int
    """Stamp at which it starts (ns)."""
    end_ns: int
    """Stamp at which it ends (ns)."""
    origin: str
    """Who marked it: `cut`, where it was cut out by itself, else as in `segment`."""
    mirrored: bool
    """Whether left and right were exchanged."""
    doubts: list[str]
    """What may be wrong with it."""

    @classmethod
    def of(cls, take: Take, example: MarkedSegment) -> "ExampleListed":
        """Describe an example of a take."""
        assert example.bounds_ns is not None
        start_ns, end_ns = example.bounds_ns
        return cls(
            id=take.name_of(example),
            take=take.id,
            label=example.label or "",
            person=take.person,
            agent=example.agent,
            start_ns=start_ns,
            end_ns=end_ns,
            origin=example.origin or MANUAL,
            mirrored=example.mirrored,
            doubts=list(example.doubts),
        )


class Examples(Reply):
    """All examples of a set."""

    examples: list[ExampleListed]
    """Take by take, in order of time."""


class FilmReply(Reply):
    """One example to look at."""

    stamps_ns: list[int]
    """Stamps of its pictures (ns), 15 in a second at the most."""
    joints: list[list[Joint]]
    """The fifteen joints of each, upright frame, m, of the standard body; null where one is missing."""
    trace: list[list[float]] | None
    """Its way over the posture map of the model in use, rows and columns; null without one."""


class TakeReply(Reply):
    """A take that has begun or ended."""

    take: str | None
    """The take's name; null while it is recorded, and where nothing was kept of it."""
    examples: int
    """How many examples are in it."""
    doubts: list[str]
    """What may be wrong with it, or why nothing was kept."""


class State(Reply):
    """What the trainer does and has, as it puts it on `training`, for programs that ask instead of listening."""

    recording: TakeState | None
    """The take that is being recorded, or the newest one; null before the first."""
    job: JobState | None
    """The job that is running, or the newest one; null before the first."""
    model: str | None
    """Which model the classifier is to use; null where there is none."""
    can_undo: bool
    """Whether there is a model that was in use before it."""
    revision: int
    """A number that rises with each change of the sets and models."""
    model_set: str | None
    """The set that the model was trained on; null where that is not known."""
    model_file: str | None
    """The file that the model was copied from: the one that somebody named for use, or the one that ships with actum;
    null where the model was put into use by the trainer."""


class Uploaded(Reply):
    """How much of a file has come."""

    upload: str
    """The file's name, for `import_video`."""
    size: int
    """Bytes so far: the offset of the next piece."""


class Comparison(Reply):
    """Two models side by side."""

    model: ModelListed
    """The one."""
    other: ModelListed
    """The other."""
    added: list[str]
    """The actions that only the one tells apart."""
    missing: list[str]
    """The actions that only the other tells apart."""
    sentence: str
    """What the difference comes to."""


def counted(number: int, one: str, several: str = "") -> str:
    """Return a number with its noun: 1 example, 2 examples."""
    return f"{number} {one if number == 1 else several or f'{one}s'}"
