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
        raise ValueError(f"{lacking!r} is no action with its seconds: write wave=3,clap=1")
    return {action.strip(): seconds for action, _, seconds in (pair.rpartition("=") for pair in _names(value))}


Names = Annotated[frozenset[str], NoDecode, BeforeValidator(_names)]


class Settings(ServiceSettings):
    """What the classifier can be told beside what every service can."""

    model: Path | None = Field(None, description="the model file; it may appear or change at any time")
    publish_maps: bool = Field(False, description="put the maps' activities and the trace with each final action")
    segments: WantedSegments = Field(
        "both",
        description="answer marked segments (marks), those that the classifier finds by itself (auto), or both;"
        " where both are, the marked ones win",
    )
    false_alarms_per_min: float | None = Field(
        None,
        gt=0,
        allow_inf_nan=False,
        description="how many wrong actions in a minute of other doings are accepted: more of them means fewer missed"
        " actions; default: what the model was trained for",
    )
    shortest_pause_s: Seconds = Field(
        0.0, description="an action found sooner than this after the one before it is not told"
    )
    cooldown_s: Annotated[dict[str, Seconds], NoDecode, BeforeValidator(_pairs)] = Field(
        {}, description="for how long after one of an action no other of it is told: wave=3,clap=1"
    )
    enabled_actions: Names = Field(
        frozenset(), description="of those found only these are told: wave,clap; default: all of the model's"
    )
    disabled_actions: Names = Field(frozenset(), description="of those found these are not told: wave,clap")

    @property
    def segmentation(self) -> Segmentation:
        """The settings of the search for segments."""
        options = SpottingOptions(
            self.false_alarms_per_min, self.shortest_pause_s, self.cooldown_s, self.disabled_actions
        )
        return Segmentation(self.segments, options, self.enabled_actions)
