"""Which object the hands of the OptiTrack takes act on: the plain proximity measure and the joint one, as Markdown.

python -m benchmarks.bimacs DIR [--varied], the folder of the takes (see actum_dataset_importer.bimacs). Fusion gets the
hands, objects and the bounds of each segment; what is done in it, and to what, is compared afterwards. The takes have
no bodies, in which a classifier could find segments by itself: instead, the marked bounds are moved by as much as those
found in the simulated scene are off. With --varied fusion gets hands and objects also as another person, other things
or poorer cameras would have given them (see bimacs_variations).
"""

import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from pathlib import Path

import numpy as np
from benchmarks.bimacs_tracks import read, written
from benchmarks.bimacs_variations import VARIATIONS, Change, bounds_as_found

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Action, Event, Message, Segment, Truth
from actum.node import replay
from actum.recording import Recording
from actum_dataset_importer.bimacs import HandsTake, read_take, take_files
from actum_dataset_importer.importing import import_bimacs
from actum_model_trainer.evaluation import wilson_interval

ACTIONS = ("lift", "place", "hold", "approach", "retreat", "pour", "stir", "idle")
APPLIED = ("pour", "stir")
NAMELESS = "act"
MEASURES = {"proximity": Settings(measure="proximity"), "joint": Settings(measure="joint")}
SEEDS = {True: 0, False: 100}
"""Of variations that were looked at while the fusion was made, and of those that were not."""
DRAWS = range(200, 205)
"""Seeds of the errors of bounds: each segment is tried with as many."""


@dataclass(frozen=True)
class Trial:
    """A labelled segment: what is done, to which object, with what in the hand; and each measure's event."""

    label: str
    seconds: float
    target: int | None
    tool: int | None
    events: Mapping[str, Event]

    def object_right(self, measure: str) -> bool:
        found = self.events[measure].object
        return (None if found is None else found.id) == self.target

    def held_right(self, measure: str) -> bool:
        held = self.events[measure].held
        return held is not None and held.id == self.tool

    def outcome_is(self, outcome: str) -> bool:
        return self.events["joint"].outcome == outcome


VARIED_LINES: Mapping[str, tuple[str, Callable[[Trial, str], bool]]] = {
    **{label: (label, Trial.object_right) for label in ACTIONS},
    **{f"{label}: in the hand": (label, Trial.held_right) for label in APPLIED},
}


def trials(folder: Path) -> Iterator[Trial]:
    """Take what `actum import bimacs` writes."""
    with tempfile.TemporaryDirectory() as out:
        import_bimacs(folder, Path(out), lambda done, total: None)
        for file in sorted(Path(out).glob("*.mcap")):
            yield from _trials(list(Recording(file).messages()))


def _trials(heard: Sequence[Message], measures: Mapping[str, Settings] = MEASURES) -> Iterator[Trial]:
    marks = [m for m in heard if isinstance(m, Segment)]
    starts = {m.segment_id: m for m in marks if m.kind == "start"}
    ends = {m.segment_id: m for m in marks if m.kind == "end"}
    truths = {m.segment_id: m for m in heard if isinstance(m, Truth)}
    events = {name: _events(heard, starts, ends, settings) for name, settings in measures.items()}
    tools = _tools(starts, truths)
    for number, start in starts.items():
        target = truths[number].object_id if number in truths else None
        seconds = (_stamp_of(ends[number]) - _stamp_of(start)) / 1e9
        found = {name: of_segment[number] for name, of_segment in events.items()}
        yield Trial(str(start.label), seconds, target, tools.get(number), found)


def _events(
    messages: Sequence[Message], starts: Mapping[str, Segment], ends: Mapping[str, Segment], settings: Settings
) -> dict[str, Event]:
    """Let the fusion hear postures, objects, and at each segment's end that something was done in it."""
    unseen = [m for m in messages if not isinstance(m, (Segment, Truth))]
    actions = [_nameless(start, ends[number]) for number, start in starts.items()]
    stream = sorted([*unseen, *actions], key=attrgetter("stamp_ns"))
    answered = replay(ActionFusion(settings), [(m.stamp_ns, m) for m in stream])
    return {event.segment_id: event for event in answered if isinstance(event, Event)}


def _stamp_of(mark: Segment) -> int:
    """Return the stamp that the importer gave a mark."""
    assert mark.stamp_ns is not None
    return mark.stamp_ns


def _nameless(start: Segment, end: Segment) -> Action:
    return Action(
        stamp_ns=_stamp_of(end),
        sensor=start.sensor,
        agent=start.agent or 0,
        segment_id=start.segment_id,
        start_ns=_stamp_of(start),
        end_ns=_stamp_of(end),
        final=True,
        action=NAMELESS,
        confidence=1.0,
        activations={},
        part=None,
        hand=start.hand,
        frames=0,
        missed=0,
    )


def _tools(starts: Mapping[str, Segment], truths: Mapping[str, Truth]) -> dict[str, int]:
    """Tell by the labels what each hand has lifted and not yet placed."""
    tools = {}
    ordered = sorted(starts.values(), key=lambda start: (str(start.hand), start.stamp_ns))
    for _, of_hand in groupby(ordered, key=attrgetter("hand")):
        held: int | None = None
        for start in of_hand:
            if start.label == "lift":
                held = truths[start.segment_id].object_id
            if held is not None:
                tools[start.segment_id] = held
            if start.label == "place":
                held = None
    return tools


def row(
    what: str,
    done: Sequence[Trial],
    as_found: Sequence[Trial],
    right: Callable[[Trial, str], bool],
    measures: Sequence[str] = ("joint",),
) -> str:
    """Write what share is right by each measure and, by the joint one, of all draws of bounds as found."""
    cells = [_share(sum(right(t, name) for t in done), len(done)) if name in measures else "" for name in MEASURES]
    drawn = f"{sum(right(t, 'joint') for t in as_found) / len(as_found):.0%}" if as_found else "-"
    return f"| {what} | {len(done)} | {' | '.join(cells)} | {drawn} |"


def _share(right: int, n: int) -> str:
    low, high = wilson_interval(right, n)
    return f"{right} ({right / n:.0%}; {low:.0%} to {high:.0%})" if n else "-"


def table(done: Sequence[Trial], as_found: Sequence[Trial]) -> Iterator[str]:
    """Tabulate what is right with the marked bounds, and with bounds as a classifier finds them."""
    by_label, found = _by_label(done), _by_label(as_found)
    yield "| segments, and what is to be right | n | plain proximity | joint | joint, bounds as found |"
    yield "|---|---:|---|---|---:|"
    for label in ACTIONS:
        what = "no object" if label == "idle" else "object"
        yield row(f"{label}: {what}", by_label[label], found[label], Trial.object_right, list(MEASURES))
        if label in APPLIED:
            yield row(f"{label}: in the hand", by_label[label], found[label], Trial.held_right)
    for label, outcome in (("lift", "lifted"), ("place", "put down")):
        yield row(
            f"{label}: {outcome}", by_label[label], found[label], lambda t, m, o=outcome: t.events[m].outcome == o
        )
    idle = by_label["idle"]
    seconds = {name: sum(t.seconds for t in idle if not t.object_right(name)) for name in MEASURES}
    total = sum(trial.seconds for trial in idle)
    claimed = ", ".join(f"{seconds[name] / total:.1%} ({name})" for name in MEASURES) if total else "-"
    yield f"\nOf {total:.0f} s idle an object is claimed for: {claimed}. Intervals are Wilson's, 95 %."


def _by_label(trials: Sequence[Trial]) -> Mapping[str, list[Trial]]:
    by_label: dict[str, list[Trial]] = defaultdict(list)
    for trial in trials:
        by_label[trial.label].append(trial)
    return by_label


def _changed(takes: Sequence[HandsTake], seed: int, change: Change, *amounts: float) -> list[Trial]:
    """Change every take, and let the joint measure judge it."""
    rngs = [np.random.default_rng([seed, number]) for number in range(len(takes))]
    changed = [written(take, change(read(take), rng, *amounts)) for take, rng in zip(takes, rngs, strict=True)]
    return [trial for of_take in changed for trial in _trials(of_take, {"joint": MEASURES["joint"]})]


def variations_table(takes: Sequence[HandsTake]) -> Iterator[str]:
    """Tell of each variation how many of each line stay right, by the joint measure."""
    yield f"\n| variation | | {' | '.join(VARIED_LINES)} |"
    yield f"|---|---|{'---|' * len(VARIED_LINES)}"
    for variation in VARIATIONS:
        for chosen_on, amounts in ((True, variation.chosen_on), (False, variation.looked_at)):
            for amount, numbers in amounts.items():
                done = _changed(takes, SEEDS[chosen_on], variation.change, *numbers)
                by_label = _by_label(done)
                shares = [
                    f"{sum(right(trial, 'joint') for trial in by_label[label])}/{len(by_label[label])}"
                    for label, right in VARIED_LINES.values()
                ]
                how = "" if chosen_on else "*"
                yield f"| {variation.what} | {amount}{how} | {' | '.join(shares)} |"
    yield "\nAmounts without an asterisk were looked at while the fusion was made, those with one after."


def main() -> None:
    folder, varied = sys.argv[1:2], sys.argv[2:] == ["--varied"]
    if len(sys.argv) != 2 + varied:
        sys.exit(__doc__)
    takes = [read_take(file, "optitrack") for file in take_files(Path(folder[0]))]
    as_found = [trial for seed in DRAWS for trial in _changed(takes, seed, bounds_as_found)]
    print("\n".join(table(list(trials(Path(folder[0]))), as_found)), flush=True)
    if varied:
        for line in variations_table(takes):
            print(line, flush=True)


if __name__ == "__main__":
    main()
