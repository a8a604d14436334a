"""Settings of the classifier."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, FiniteFloat
from pydantic_settings import NoDecode

from actum.settings import ServiceSettings
from som_classifier.segmentation import Segmentation, WantedSegments
from som_classifier.spotting.spotted import SpottingOptions

Seconds = Annotated[FiniteFloat, Field(ge=0)]


def _names(value: Any) -> Any:
    """Split `wave,clap` at the commas; return what is no text unchanged."""
    return [name.strip() for name in value.split(",") if name.strip()] if isinstance(value, str) else value


def _pairs(value: Any) -> Any:
    """Split `wave=3,clap=1` into a mapping; return what is no text unchanged.

    Raises:
        ValueError: a part of it has no `=`.
    """
    if not isinstance(value, str):
        return value
    if lacking := next((name for name in _names(value) if "=" not in name), None):
        raise ValueError(
            f"{lacking!r} is not of the form ACTION=SECONDS: give each action a number of seconds, such as "
            "wave=3,clap=1"
        )
    return {action.strip(): seconds for action, _, seconds in (pair.rpartition("=") for pair in _names(value))}


Names = Annotated[frozenset[str], NoDecode, BeforeValidator(_names)]


class Settings(ServiceSettings):
    """What the classifier can be told beside what every service can."""

    model: Path | None = Field(
        None,
        description="the model file (.npz), loaded whenever it appears or changes; without one no action is recognised",
    )
    publish_maps: bool = Field(
        False,
        description="publish, with each final action, the activity of the model's maps, which the web page draws",
    )
    segments: WantedSegments = Field(
        "both",
        description=(
            "which actions to recognise: those between start and end marks (marks), those that the classifier finds "
            "without marks (auto), or both, where marks take precedence"
        ),
    )
    false_alarms_per_min: float | None = Field(
        None,
        gt=0,
        allow_inf_nan=False,
        description=(
            "accepted rate of false alarms while no action is done; a higher rate misses fewer actions. "
            "Default: the rate stored in the model (1/min)"
        ),
    )
    shortest_pause_s: Seconds = Field(
        0.0, description="minimum pause between two actions that the classifier finds without marks (s)"
    )
    cooldown_s: Annotated[dict[str, Seconds], NoDecode, BeforeValidator(_pairs)] = Field(
        {},
        description=(
            "minimum time until the same action is published again, by action, such as wave=3,clap=1; marked "
            "actions are not affected. Default: 0 for all (s)"
        ),
    )
    enabled_actions: Names = Field(
        frozenset(),
        description=(
            "publish only these actions, such as wave,clap; marked actions are not affected. Default: all actions "
            "of the model"
        ),
    )
    disabled_actions: Names = Field(
        frozenset(),
        description="never publish these actions, such as wave,clap; marked actions are not affected. Default: none",
    )

    @property
    def segmentation(self) -> Segmentation:
        """The settings of the search for segments."""
        options = SpottingOptions(
            self.false_alarms_per_min, self.shortest_pause_s, self.cooldown_s, self.disabled_actions
        )
        return Segmentation(self.segments, options, self.enabled_actions)
