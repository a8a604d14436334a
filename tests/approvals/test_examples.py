"""How the repetitions of actions are found in recordings, and what is listed of them."""

from collections.abc import Iterable, Iterator

import numpy as np
import pytest

from actum.messages import Skeleton
from actum_command.segment_lines import cut_lines
from actum_examples.cutting.courses import PersonTracks
from actum_examples.cutting.repetitions import Cuts, cut
from approving import Approve
from repeating import GOGGLES, SCRATCH, WAVE, Stream, eased, held, moved, rest, walk

STREAMS = {
    "waves": Stream().then(walk(2)).repeat([moved(eased(frames), WAVE) for frames in (40, 48, 36, 44)]).then(rest(1)),
    "goggles": Stream().repeat([moved(held(60), GOGGLES)] * 3, 0.8).then(moved(eased(30), SCRATCH)).then(rest(2)),
    "unlike": Stream().repeat([moved(eased(40), WAVE), moved(eased(25), GOGGLES), moved(eased(44), WAVE)], 0.5),
    "seamless": Stream().then(rest(1)).then(np.concatenate([moved(eased(36), WAVE)] * 5)).then(rest(1.5)),
}


def cuts_of(skeletons: Iterable[Skeleton], asked: int | None) -> Cuts | None:
    tracks = PersonTracks()
    for each in skeletons:
        tracks.receive(each)
    return cut(tracks.courses(), asked, 0)


@pytest.mark.parametrize("name", STREAMS)
def test_repetitions_are_cut_as_approved(name: str, approve: Approve) -> None:
    skeletons = STREAMS[name].skeletons()
    found = {str(asked): cuts_of(skeletons, asked) for asked in (None, 3, 5)}
    lines = {asked: {f"{i:02}": line for i, line in enumerate(lines_of(cuts))} for asked, cuts in found.items()}
    approve(f"cuts-{name}", {"found": found, "lines": lines}, 1e-6)


def lines_of(cuts: Cuts | None) -> Iterator[str]:
    if cuts is not None:
        yield from cut_lines(cuts, 0)
