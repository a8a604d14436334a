"""The repetitions that are cut out of streams nobody has marked, on public recordings, as a page of Markdown.

python -m benchmarks.cutting [--people development|held-out] [--only ROW], by default the people held out; needs
ACTUM_DATA and ACTUM_POSE_MODEL. benchmarks/cutting.md is what it printed.
"""

import argparse
import sys

from . import counted_along, unmarked


def main() -> None:
    """Measure all sets and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--people", choices=("development", "held-out"), default="held-out")
    parser.add_argument("--only", default="", help="measure the rows whose name contains this")
    told = parser.parse_args()
    print(HEADER.format(people=told.people))
    for name, measure in unmarked.SETS.items():
        if told.only in name:
            for number, results in zip(("told", "not told"), zip(*measure(told.people), strict=True), strict=True):
                print(unmarked.row(name, number, results).replace("nan", ""), flush=True)
            print(f"{name}: done", file=sys.stderr, flush=True)
    print(LIVE_HEADER)
    for name, takes in counted_along.TAKES.items():
        if told.only in name:
            print(counted_along.row(name, list(takes(told.people))), flush=True)
            print(f"{name}: done", file=sys.stderr, flush=True)


HEADER = """# Repetitions cut without marks

`python -m benchmarks.cutting`, {people} people; one core. What `actum record --times` and `actum label cut` do.

MSRC-12: each file holds one gesture about ten times; a cut is right where it holds exactly one action point. The points
are where the gesture can be recognised, not its bounds; some lie after the movement. MSR-Action3D: the two or three
executions of an action by a person, in turn, at 0.85 to 1.15 times their tempo, with pauses of 0.8 to 2 s and 5 mm of
noise; disturbed, a walk of UTKinect before and after and another action of the person after the second. Scene: five
times the same action on one object; its marks end before the hand goes back, while a cut goes from rest to rest. In
these, a cut is right where it holds the middle of exactly one repetition. Numbers were chosen on the other half of the
people of MSRC-12 (1, 5, 9 and so on) and of MSR-Action3D (those with odd numbers).

*Exact*: every repetition in one cut and no other cut, with Wilson's 95 % interval. IoU: the median over right cuts.
*Sure and exact*: of the streams that the command calls sure, so many are exact.
*Warned and wrong*: of the streams of which it says that the number may be wrong, so many are not exact.

| streams | number | streams | exact | repetitions found | cuts right | IoU | sure and exact | warned and wrong |
|---|---|---:|---|---:|---:|---:|---:|---:|"""
LIVE_HEADER = """
## Takes that are counted along

What the page and `actum record --times` do while somebody acts: a take ends by itself once as many as asked for are
followed by a long rest, and within 30 s of the last one, or not at all. *All right*: it ended by itself, with every
repetition in one cut and no other cut. *Kept*: examples that are kept where nobody moves, after 20 or 40 s.

Simulated: the person of `actum up --driven`, asked by command. Kinect: people of MSRC-12 in their still moments, joined
to and fro, alone or before and after one of their streams. Webcam: the first picture of a clip with 4 grey levels of
noise, swaying by 3 pixels, and waves of the same person, through the pose model. Slow: three times as long as MSR's,
held for a second in the middle.

| takes | takes | ended by themselves | all right | kept | end after the last one (s) |
|---|---:|---:|---:|---:|---:|"""


if __name__ == "__main__":
    main()
