"""Settings of the classifier."""

import csv
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, FiniteFloat
from pydantic_settings import NoDecode

from actum.settings import RememberingSettings
from som_classifier.segmentation import Segmentation, WantedSegments
from som_classifier.spotting.spotted import SpottingOptions

Seconds = Annotated[FiniteFloat, Field(ge=0)]


def _names(value: Any) -> Any:
    """Split `wave,"up, down"` at the commas outside quotes, as in CSV; return what is no text unchanged."""
    if not isinstance(value, str):
        return value
    return [
        name.strip()
        for row in csv.reader(value.splitlines(True), skipinitialspace=True)
        for name in row
        if name.strip()
    ]


def _pairs(value: Any) -> Any:
    """Split `wave=3,clap=1` into a mapping; return what is no text unchanged.

    Raises:
        ValueError: a part of it has no `=`.
    """
    if not isinstance(value, str):
        return value
    if entry := next((name for name in _names(value) if "=" not in name), None):
        raise ValueError(
            f"{entry!r} is not of the form ACTION=SECONDS: give each action a number of seconds, such as wave=3,clap=1"
        )
    return {action.strip(): seconds for action, _, seconds in (pair.rpartition("=") for pair in _names(value))}


Names = Annotated[frozenset[str], NoDecode, BeforeValidator(_names)]


class Settings(RememberingSettings):
    """The settings of the classifier, beside those of every service."""

    model: Path | None = Field(
        None,
        description=(
            "the model file (.npz). The classifier loads this file as soon as the file exists, and again whenever the "
            "file changes. Without a model, no action is recognised"
        ),
    )
    publish_maps: bool = Field(
        False,
        description=(
            "publish the activity of the model's self-organizing maps with each recognised action, so that the web "
            "page can draw this activity"
        ),
    )
    segments: WantedSegments = Field(
        "both",
        description=(
            "which actions to recognise. marks: only actions whose start and end are marked by another program. auto: "
            "only actions that the classifier finds by itself. both: both kinds; if a found action overlaps a marked "
            "action, only the marked action is published"
        ),
    )
    false_alarms_per_min: float | None = Field(
        None,
        gt=0,
        allow_inf_nan=False,
        description=(
            "accepted number of false alarms per minute while nobody does an action; with a higher number the "
            "classifier misses fewer actions. Default: the number stored in the model"
        ),
    )
    shortest_pause_s: Seconds = Field(
        0.0,
        description=(
            "shortest pause between two actions of one person (s). An action that the classifier finds by itself is "
            "not published if the pause between the end of the person's previous action and the start of this action "
            "is shorter. This option does not affect actions whose start and end are marked by another program"
        ),
    )
    cooldown_s: Annotated[dict[str, Seconds], NoDecode, BeforeValidator(_pairs)] = Field(
        {},
        description=(
            "for each action, the shortest pause between two repetitions by one person (s). With wave=3,clap=1, for "
            "example, a wave is not published if it starts less than 3 s after the end of the person's last published "
            "wave. This option does not affect actions whose start and end are marked by another program. Default: 0 s "
            "for all actions"
        ),
    )
    enabled_actions: Names = Field(
        frozenset(),
        description=(
            "the only actions, such as wave,clap, to publish among those that the classifier finds by itself. If "
            "another program marks an action's start and end, the action is always published. Default: all actions"
        ),
    )
    disabled_actions: Names = Field(
        frozenset(),
        description=(
            "do not publish these actions, such as wave,clap, when the classifier finds them by itself. If another "
            "program marks an action's start and end, the action is always published. Default: none"
        ),
    )

    @property
    def segmentation(self) -> Segmentation:
        """The settings of the search for segments."""
        options = SpottingOptions(
            self.false_alarms_per_min, self.shortest_pause_s, self.cooldown_s, self.disabled_actions
        )
        return Segmentation(self.segments, options, self.enabled_actions)
