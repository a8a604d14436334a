"""Which segments are answered and found, as a user asks, held against what a model can find."""

from dataclasses import dataclass, field, replace
from typing import Literal

from actum.states import State
from som_classifier.model import Model
from som_classifier.spotting.search import NO_SEARCH, SearchPlan
from som_classifier.spotting.spotted import SpottingOptions

WantedSegments = Literal["marks", "auto", "both"]
"""Which segments are to be answered: the marked ones, those that the classifier finds by itself, or both."""
CANNOT = "finds no segments by itself: the model was trained without continuous recordings"
"""What the state says of a model without a spotter."""
NO_BACKGROUND = "no background in the training data: the false-alarm rate is unknown"
"""What the state says of a model that has never seen people do anything else."""


@dataclass(frozen=True)
class Segmentation:
    """How the streams are segmented, whichever model there is.

    Attributes:
        segments: which ones are answered.
        options: what is asked of the search.
        enabled: the only actions that are published of those found; empty where all are.
    """

    segments: WantedSegments = "both"
    options: SpottingOptions = field(default_factory=SpottingOptions)
    enabled: frozenset[str] = frozenset()

    def plan(self, model: Model) -> SearchPlan:
        """Return how a model is to search the streams; it does not where only marked segments are wanted."""
        if self.segments == "marks":
            return NO_SEARCH
        others = frozenset(model.labels) - self.enabled if self.enabled else frozenset()
        options = replace(self.options, disabled=self.options.disabled | others)
        return SearchPlan(lambda: model.spotter(options), options)

    def state(self, model: Model) -> str:
        """Describe how far a model does as wanted: `running`, and after a semicolon each thing to know."""
        if self.segments == "marks":
            return State.RUNNING
        finds = model.spotter(self.options) is not None
        if self.segments == "auto" and not finds:
            return State.NOTHING_TO_DO.because(f"marks are not wanted (segments auto), and it {CANNOT}")
        if problem := self.misnamed(model):
            return problem
        if not finds:
            return State.RUNNING.noting(CANNOT)
        return State.RUNNING.noting(NO_BACKGROUND) if model.background_s == 0 else State.RUNNING

    def misnamed(self, model: Model) -> str | None:
        """Say which of the actions that are named the model does not know; None where it knows them all."""
        named = self.options.disabled | self.options.cooldown_s.keys() | self.enabled
        unknown = sorted(named - set(model.labels))
        return State.UNKNOWN_ACTIONS.because(", ".join(unknown)) if unknown else None


DEFAULT = Segmentation()
"""How streams are segmented where nothing is asked for."""
