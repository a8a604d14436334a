"""The preset by the protocols that the paper's system and its relatives were measured by."""

from collections.abc import Iterator

from benchmarks.recognition.scores import table

from som_classifier.presets import DEFAULT, Preset

from .data import LOOK_ALIKES, TESTED_EACH, TRAINED_EACH, Data
from .measuring import ARM, BODY, DRAWS, PART, PROTOCOLS, SEEDS, shown

ROWS: dict[str, Preset] = {
    "`paper`, the right arm": ARM,
    "`paper`, the part that moves most": PART,
    "`paper`, the whole body": BODY,
    "`paper`, the whole body from the middle of the hips": shown("all", origin="hips"),
    "`paper`, the part that moves most, axes of every posture anew": shown(axes="posture"),
    "`paper`, the whole body, axes of every posture anew": shown("all", axes="posture"),
    f"`{DEFAULT.name}`, the default": DEFAULT,
}
REPORTED = {
    "published (Gharaee, Gärdenfors and Johnsson)": ("83", "", "", ""),
}


def protocols(data: Data) -> Iterator[str]:
    """Four protocols."""
    yield f"""Right answers in %, mean ± standard deviation. The author's set: her {len(data.set1)} sequences of ten
actions, {DRAWS} draws of a quarter to test, the same people on both sides. Look-alikes:
{", ".join(LOOK_ALIKES)} of that set, {TRAINED_EACH} of each to learn from and {TESTED_EACH} to
test, {DRAWS} draws. MSR Action3D: all 20 actions, people 1, 3, 5, 7 and 9 learnt, the others tested. UTKinect: each of
ten people on a model of the others. {SEEDS} seeds each. The last row is the authors' own, of an earlier version."""
    rows = [[name, *(str(protocol.shares(data, preset)) for protocol in PROTOCOLS)] for name, preset in ROWS.items()]
    reported = [[name, *cells] for name, cells in REPORTED.items()]
    yield table(("recogniser", *(protocol.name for protocol in PROTOCOLS)), [*rows, *reported])
