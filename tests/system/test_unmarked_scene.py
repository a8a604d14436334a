"""The shipped model, live: the actions of the simulated scene are found without a mark, and as in its recording."""

from pathlib import Path

import pytest

from actum import keys
from actum.messages import AUTO, Action, Segment, Skeleton, Status
from actum.recording import Recording
from actum_command.scene_marks import write_examples
from actum_command.simulated_model import SIMULATED_MODEL
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import found_by
from live import PATIENCE_S, System, collect
from som_classifier.model_loading import load_model

pytestmark = pytest.mark.system
BURST = 200
"""Frames put at once: fewer than a ring holds, so that none is lost however slow the services are."""


def test_a_new_person_who_acts_without_marks_is_answered_as_in_the_recording(running: System, tmp_path: Path) -> None:
    write_examples(tmp_path / "new.mcap", repetitions=1, actor=5, seed=9)
    recording = Recording(tmp_path / "new.mcap")
    offline = found_by(load_model(SIMULATED_MODEL), [recording])
    expected = [(each.agent, each.start_ns, each.end_ns, each.label, each.confidence) for each in offline.detections]

    actions, marks = live(running, SIMULATED_MODEL, [*recording.messages((keys.SKELETON,))], len(expected))

    assert [(m.agent, m.start_ns, m.end_ns, m.action, m.confidence) for m in actions] == expected
    assert [m.stamp_ns for m in marks] == [ns for _, start_ns, end_ns, *_ in expected for ns in (start_ns, end_ns)]
    assert {m.origin for m in marks} == {AUTO} and all(m.missed == 0 for m in actions)
    assert scores_of(offline).event.right >= 4, "of five"


def live(running: System, model: Path, skeletons: list[Skeleton], answers: int) -> tuple[list[Action], list[Segment]]:
    """Put skeletons, and return the final actions and marks that follow, up to so many answers and whatever is more."""
    running.start_router()
    running.start("pose_preprocessor")
    running.start("som_classifier", "--model", str(model))
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor", "som_classifier")
        assert client.wait_for_subscriber(keys.SKELETON, PATIENCE_S)
        statuses, actions, segments = (
            client.listen(keys.pattern(topic, client.sensor)) for topic in (keys.STATUS, keys.ACTION, keys.SEGMENT)
        )
        for end in [*range(BURST, len(skeletons), BURST), len(skeletons)]:
            for skeleton in skeletons[(end - 1) // BURST * BURST : end]:
                client.put(skeleton)
            collect(statuses, Status, lambda said, end=end: said and max(map(postures_handled, said)) >= end)
        put = collect(actions, Action, lambda found: sum(m.final for m in found) >= answers)
        marks = collect(segments, Segment, lambda found: len(found) >= 2 * answers)
    return [m for m in put if m.final], marks


def postures_handled(status: Status) -> int:
    """How many the classifier has handled, 0 for another service's status."""
    return status.handled.get("actum/kinect0/posture/1", 0) if status.service == "som_classifier" else 0
