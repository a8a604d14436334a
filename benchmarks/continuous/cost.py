"""What four people at once cost on one core, and whether they disturb each other."""

import json
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

from benchmarks.recognition.scores import percent, table

from .bench import Bench, number
from .four_people import ALONE_MINUTES, PEOPLE

MOST_MS = 20
"""The 99th percentile of a decision is required to be below."""


def cost(bench: Bench) -> Iterator[str]:
    """Times, memory, and the answers to each of four people without the others."""
    path = bench.data.imported / "simulated.npz"
    bench.model_of(bench.data.simulated.training).save(path)
    program = [sys.executable, "-m", "benchmarks.continuous.four_people", str(path)]
    yield from told(json.loads(subprocess.run(program, check=True, stdout=subprocess.PIPE, text=True).stdout))


def told(own: dict[str, Any]) -> Iterator[str]:
    """Write a `four_people.Cost` as Markdown, given as JSON."""
    yield f"""{PEOPLE} simulated people side by side act and do everyday things, {own["minutes"]:g} minutes at 30 frames
a second, in a process of its own with preprocessor and classifier. Times are the processor's, so that what else it does
does not count; below {MOST_MS} ms is required of the 99th percentile. {own["told"]} actions were told."""
    yield table(
        ("ms", "median", "99 %", "largest"),
        [
            ["one posture in the classifier", *map(number, own["posture_ms"])],
            [f"one frame of {PEOPLE} people, preprocessor and classifier", *map(number, own["frame_ms"])],
        ],
    )
    yield f"Preprocessor and classifier take {percent(own['core'])} % of a core."
    yield table(("memory, MB", "after a minute", "in the end"), _memory(own["early"], own["late"]))
    yield f"""The resident memory is the process's, with the simulated people. In the first {ALONE_MINUTES:g} minutes
everybody once more without the other three:"""
    answers = (
        [str(k), str(count), "the same" if same else "others"] for k, (count, same) in enumerate(own["alone"], 1)
    )
    yield table(("person", "answers alone", "among the others"), answers)


def _memory(early: dict[str, Any], late: dict[str, Any]) -> Iterator[list[str]]:
    names = {"resident_mb": "resident", "classifier_mb": "the classifier, without its model", "spotters_mb": "spotters"}
    for key, name in names.items():
        yield [name, number(early[key]), number(late[key])]
