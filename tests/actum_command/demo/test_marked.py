"""What the demo's numbers say: what was done beside what was told, and what a guess would reach."""

from actum.messages import Event, Truth
from actum_command.demo.marked import TEST_SEED, Score, summary
from actum_model_trainer.evaluation import Evaluation
from scene_simulator.programme import balanced_programme

NAMES = {1: "cup", 2: "box", 3: "book"}


def truth(segment_id: str, action: str, object_id: int) -> Truth:
    return Truth(
        stamp_ns=0,
        sensor="kinect0",
        kind="end",
        segment_id=segment_id,
        agent=1,
        hand="right",
        action=action,
        object_id=object_id,
        object_name=NAMES[object_id],
        displacement_m=None,
    )


def event(segment_id: str, action: str, object_id: int) -> Event:
    message = {
        "stamp_ns": 0, "sensor": "kinect0", "agent": 1, "segment_id": segment_id, "start_ns": 0, "end_ns": 1,
        "action": action, "confidence": 1.0, "activations": {}, "hand": "right", "frames": 1, "missed": 0,
        "object": {"id": object_id, "name": NAMES[object_id], "distance_m": 0.1}, "held": None, "motion": None,
        "objects_present": [], "distances_m": {}, "result": None, "sentence": "",
    }  # fmt: skip
    return Event.model_validate(message)


def scored(*done: tuple[str, int]) -> Score:
    score = Score(expected=len(done))
    for number, (action, object_id) in enumerate(done):
        score.truths[str(number)] = truth(str(number), action, object_id)
        score.events[str(number)] = event(str(number), action, object_id)
    return score


def test_of_the_demos_people_the_action_alone_tells_a_third_of_the_objects() -> None:
    people = range(1, 10)
    samples = [s for person in people for s in balanced_programme(1, TEST_SEED, person)]
    score = scored(*((s.action, s.object_id) for s in samples))

    assert (len(samples), score.objects_by_majority()) == (45, 15)


def test_where_each_action_is_always_done_to_one_object_the_action_tells_all() -> None:
    assert scored(("push", 1), ("push", 1), ("lift", 2)).objects_by_majority() == 3


def test_the_summary_says_what_the_action_alone_would_tell() -> None:
    nothing = Evaluation(())
    text = summary(scored(("push", 1), ("push", 2)), nothing, nothing, people=2)

    assert "objects that the action alone would tell: 1 of 2" in text
