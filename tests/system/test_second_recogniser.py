"""A classifier process whose tables know one more kind of model answers as its replay does, with marks and without."""

from pathlib import Path

import pytest

from actum import keys
from actum.messages import Action, Message
from actum_model_trainer.training import train_to_spot
from chain import replayed
from live import PATIENCE_S, System, collect
from nearest_recogniser import NEAREST, TABLES
from som_classifier.node import SomClassifier
from unmarked import postures, scene, taught
from wire import without_seq

CLASSIFIER = Path(__file__).parents[1] / "nearest_recogniser.py"
SCENE = scene(("lift", "push"), seed=3)
pytestmark = pytest.mark.system


def test_a_second_recogniser_runs_live(running: System, monkeypatch: pytest.MonkeyPatch) -> None:
    for table, own in TABLES:
        monkeypatch.setitem(table, NEAREST.kind, own)
    model = train_to_spot(taught().usable, taught().streams, NEAREST)
    model.save(running.folder / "model.npz")
    marks = [mark for mark in SCENE.marks() if mark.segment_id == "0"]
    messages: list[Message] = [*marks, *postures(SCENE.skeletons())]
    put = replayed(SomClassifier(model), [(each.stamp_ns or 0, each) for each in messages])
    expected = [message for _, message in put if isinstance(message, Action) and message.final]
    running.start_router()
    running.start_script(CLASSIFIER, "--model", str(running.folder / "model.npz"))
    with running.client() as client:
        running.wait_for_services(client, "som_classifier")
        actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
        for message in messages:
            client.put(message)
        told = collect(actions, Action, lambda found: sum(each.final for each in found) >= len(expected))
    finals = [each for each in told if each.final]
    assert [each.action for each in expected] == ["lift", "push"]
    assert without_seq(finals) == without_seq(expected)
    assert len(told) > len(finals)
