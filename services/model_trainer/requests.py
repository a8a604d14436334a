"""The fields of the trainer's commands."""

import base64
import binascii
from typing import Annotated, Literal

from pydantic import BeforeValidator, ConfigDict, Field

from actum import commands
from actum_examples.cutting.choice import MOST_REPETITIONS
from model_trainer.names import Id, Label, LabelOrNone, Name, NameOrNone, SetName
from som_classifier.presets import DEFAULT

USUAL_COUNT = 5
"""Repetitions of an action unless a number is given: fewer say little about how they vary."""
Stamp = Annotated[int, Field(ge=0, lt=2**62)]


def _bytes(data: object) -> object:
    """Decode base64, as JSON has to use it; bytes, which MessagePack can hold, are as they are.

    Raises:
        ValueError: a text is no base64.
    """
    try:
        return base64.b64decode(data, validate=True) if isinstance(data, str) else data
    except binascii.Error:
        raise ValueError(
            "the field 'data' is not valid base64: send base64 text in JSON, or bytes in MessagePack"
        ) from None


class Request(commands.Request):
    """The fields of a command; what stands below each is its description."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True, populate_by_name=True)


class OfSet(Request):
    """Which set is meant."""

    set: SetName
    """The set's name, as `list` gives it."""


class CreateSet(Request):
    """A set to be made."""

    set: Name
    """The set's name: letters, digits, spaces, `_`, `-`, `.`; 64 characters at the most."""


class RenameSet(OfSet):
    """A set's other name."""

    name: Name
    """The new name."""


class Record(OfSet):
    """What is recorded."""

    label: LabelOrNone = ""
    """The action; may be empty for background."""
    person: NameOrNone = ""
    """Who does it: a model is tested on people who were left out of its training."""
    count: Annotated[int, Field(ge=1, le=MOST_REPETITIONS)] = USUAL_COUNT
    """The number of repetitions after which the take ends; ignored for background."""
    kind: Literal["action", "background"] = "action"
    """Repetitions of one action, or background: people who do none of the actions."""
    agent: Annotated[int, Field(ge=1, lt=2**31)] | None = None
    """Who is meant, by the number in `skeleton`; null for whoever repeats something, the nearest of several."""


class Correct(OfSet):
    """What was really done in an event."""

    agent: Annotated[int, Field(ge=1, lt=2**31)]
    """Who acted, as the `event` or `held_back` message says."""
    start_ns: Stamp
    """Stamp of the event's start (ns)."""
    end_ns: Stamp
    """Stamp of its end (ns)."""
    label: LabelOrNone = ""
    """The action that was done; empty where it was none of the actions."""
    person: NameOrNone = ""
    """Who did it, by name: a model is tested on people who were left out of its training."""


class OfExample(OfSet):
    """Which example is meant."""

    example: Id
    """The example's `id` in the reply to `examples`."""


class Relabel(OfExample):
    """An example's other label."""

    label: Label
    """The action that is done in it."""


class Trim(OfExample):
    """An example's other bounds."""

    start_ns: Stamp
    """Stamp at which it starts (ns), as those of the film."""
    end_ns: Stamp
    """Stamp at which it ends (ns)."""


class DeleteAction(OfSet):
    """Which action is meant."""

    label: Id
    """The action of which all examples are deleted."""


class Upload(Request):
    """A piece of a file."""

    name: Name
    """What the file is called from now on."""
    offset: Annotated[int, Field(ge=0, lt=2**40)]
    """Where the piece begins (bytes): at the end of what was sent before, or 0 to begin anew."""
    data: Annotated[bytes, BeforeValidator(_bytes), Field(json_schema_extra={"contentEncoding": "base64"})]
    """The piece: base64 in JSON, bytes in MessagePack; a whole request has at most 8 MB."""
    last: bool
    """Whether the file is complete with it."""


class ImportVideo(OfSet):
    """What a video shows."""

    upload: Name
    """The name under which it was sent by `upload`."""
    label: Label
    """The action that is repeated in it."""
    person: NameOrNone = ""
    """Who does it."""
    count: Annotated[int, Field(ge=1, le=MOST_REPETITIONS)] | None = None
    """How often it is done; null if that is not known."""


class Train(OfSet):
    """How to train."""

    preset: Annotated[str, Field(max_length=100)] = DEFAULT.name
    """The training parameters, by name; see `actum train --help`. A model that is updated keeps its own, if known."""
    update: Id | None = None
    """The `id` of a model that is to find the same segments, and learn anew what these are. Null, or where the set has
    other actions than the model: everything is trained anew."""
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    """The same seed and examples make the same model."""
    continued: bool = False
    """Whether to train how a person's posture goes on in the next second, too."""


class OfJob(Request):
    """Which job is meant."""

    job: Id
    """The job's `id`."""


class OfModel(Request):
    """Which model is meant."""

    model: Id
    """The model's `id`."""


class Compare(OfModel):
    """Which models are compared."""

    with_: Id | None = Field(None, alias="with")
    """The other model's `id`; null for the one in use."""
