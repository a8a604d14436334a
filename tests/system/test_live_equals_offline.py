"""Real Kinect recordings through live processes give the very labels of the offline evaluation, and continuations.

They hold no objects, so nothing is said of what people are about to touch: `test_live_intents` compares that.
"""

import json
import shutil
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Continuation, Event, PostureAhead
from actum.recording import Recording
from actum_dataset_importer.importing import import_msr_action3d, import_utkinect
from actum_dataset_importer.msr_action3d import EXCLUDED, NAME, sequence_files
from actum_dataset_importer.utkinect import LABELS
from actum_model_trainer.evaluation import Evaluation, evaluate
from actum_model_trainer.sample_reading import samples_from, select
from actum_model_trainer.training import train, with_continuation
from live import System, collect
from models import QUICK, QUICK_PAPER
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.model_loading import load_model
from som_classifier.node import SomClassifier
from som_classifier.presets import PRESETS

pytestmark = [pytest.mark.system, pytest.mark.data]

TRAINING_PEOPLE = ("1", "3", "5", "7", "9")
TEST_PEOPLE = ("2", "4", "6", "8", "10")
SPEED = 4.0
"""Speed at which no frame may be lost: publishers keep 300, here 2.5 s, and a busy machine may stall for longer than
half of that."""
HIGH_SPEED = 8.0
LIVE_MINUTES = 3.0
TRAINED = (QUICK, pytest.param(QUICK_PAPER, marks=pytest.mark.long))


@pytest.fixture(scope="module")
def msr(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("msr")
    import_msr_action3d(data / "msr_action3d", out, lambda _done, _total: None)
    return out


def sequences_of(people: Sequence[str], files: Sequence[Path]) -> list[Path]:
    """The files of some people that belong to the usual protocol."""
    named = [(file, match) for file in files if (match := NAME.fullmatch(file.name))]
    return [file for file, name in named if str(int(name["person"])) in people and name[1] not in EXCLUDED]


@pytest.fixture(scope="module")
def few_of_msr(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Every fourth sequence of the training people, and twenty of the others."""
    folder, out = tmp_path_factory.mktemp("few"), tmp_path_factory.mktemp("few-msr")
    files = sequence_files(data / "msr_action3d")
    for file in (*sequences_of(TRAINING_PEOPLE, files)[::4], *sequences_of(TEST_PEOPLE, files)[::14][:20]):
        shutil.copy(file, folder)
    import_msr_action3d(folder, out, lambda _done, _total: None)
    return out


@pytest.fixture(scope="module", params=TRAINED, ids=lambda preset: preset.name)
def quick_model(request: pytest.FixtureRequest, few_of_msr: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("model") / "quick.npz"
    train(samples_from(select([few_of_msr], TRAINING_PEOPLE)).usable, request.param).save(path)
    return path


def play_live(running: System, model: Path, files: Sequence[Path], speed: float, expected: int) -> list[Event]:
    """Play recordings through a router, preprocessor, classifier and fusion of their own."""
    running.start_router()
    running.start("pose_preprocessor")
    running.start("som_classifier", "--model", str(model))
    running.start("action_fusion")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor", "som_classifier", "action_fusion")
        events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        running.start("actum_command", "play", *map(str, files), "--speed", str(speed), "--all")
        return collect(events, Event, lambda found: len(found) >= expected, patience_s=60 * LIVE_MINUTES)


def assert_agree(events: Sequence[Event], offline: Evaluation) -> None:
    predicted = {p.segment_id: p.predicted for p in offline.predictions}
    assert {event.segment_id for event in events} == set(predicted)
    differing = {e.segment_id: (e.action, predicted[e.segment_id]) for e in events if e.missed == 0}
    assert {name: pair for name, pair in differing.items() if pair[0] != pair[1]} == {}


@pytest.mark.thorough
def test_twenty_msr_sequences(running: System, few_of_msr: Path, quick_model: Path) -> None:
    files = sorted(recording.path for recording in select([few_of_msr], TEST_PEOPLE))
    offline = evaluate(load_model(quick_model), [Recording(file) for file in files])
    events = play_live(running, quick_model, files, SPEED, expected=20)
    assert [event.missed for event in events] == [0] * 20
    assert_agree(events, offline)
    assert all(event.valid for event in events)


def test_a_continuous_utkinect_recording(running: System, data: Path, quick_model: Path, tmp_path: Path) -> None:
    for name in ("joints_s01_e01.txt", LABELS):
        shutil.copy(data / "utkinect" / name, tmp_path)
    import_utkinect(tmp_path, tmp_path / "utkinect", lambda _done, _total: None)
    recording = Recording(tmp_path / "utkinect" / "s01_e01.mcap")
    offline = evaluate(load_model(quick_model), [recording])
    assert offline.n == 10
    events = play_live(running, quick_model, [recording.path], SPEED, expected=10)
    assert [event.missed for event in events] == [0] * 10
    assert_agree(events, offline)


def continued_offline(model: Path, recording: Recording) -> list[Continuation]:
    preprocessor, classifier = PosePreprocessor(PoseSettings.defaults()), SomClassifier(load_model(model))
    postures = [p for frame in recording.messages((keys.SKELETON,)) for p in preprocessor.handle(frame)]
    return [put for posture in postures for put in classifier.handle(posture) if isinstance(put, Continuation)]


def by_time(continuations: Sequence[Continuation]) -> list[tuple[int, list[PostureAhead]]]:
    """What is expected, by the time since the first: a recording that is played gets other stamps."""
    return [(each.stamp_ns - continuations[0].stamp_ns, each.ahead) for each in continuations]


def test_continuations_of_a_continuous_utkinect_recording(
    running: System, data: Path, few_of_msr: Path, quick_model: Path, tmp_path: Path
) -> None:
    for name in ("joints_s01_e01.txt", LABELS):
        shutil.copy(data / "utkinect" / name, tmp_path)
    import_utkinect(tmp_path, tmp_path / "utkinect", lambda _done, _total: None)
    recording, model = Recording(tmp_path / "utkinect" / "s01_e01.mcap"), tmp_path / "continued.npz"
    with_continuation(load_model(quick_model), samples_from(select([few_of_msr], TRAINING_PEOPLE)).streams).save(model)
    offline = continued_offline(model, recording)
    assert len(offline) > 100
    running.start_router()
    running.start("pose_preprocessor")
    running.start("som_classifier", "--model", str(model))
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor", "som_classifier")
        continuations = client.listen(keys.pattern(keys.CONTINUATION, client.sensor))
        running.start("actum_command", "play", str(recording.path), "--speed", str(SPEED))
        put = collect(continuations, Continuation, lambda found: len(found) >= len(offline))
    assert by_time(put) == by_time(offline)


@pytest.mark.live
@pytest.mark.timeout(400)
@pytest.mark.parametrize("preset", PRESETS)
def test_all_msr_test_sequences_by_the_command_line(running: System, msr: Path, tmp_path: Path, preset: str) -> None:
    model, report = tmp_path / "model.npz", tmp_path / "report.json"
    of_people = "--person", ",".join(TRAINING_PEOPLE)
    trained = running.actum("train", str(msr), "-o", str(model), "--preset", preset, *of_people, timeout_s=200)
    assert trained.returncode == 0, trained.stderr
    people = ",".join(TEST_PEOPLE)
    tested = running.actum("evaluate", str(model), str(msr), "--person", people, "--json", str(report), timeout_s=200)
    assert tested.returncode == 0, tested.stderr
    predictions = json.loads(report.read_text())["predictions"]
    assert len(predictions) == 273
    began_s = time.monotonic()
    events = play_live(running, model, [Path(p["file"]) for p in predictions], HIGH_SPEED, expected=273)
    minutes = (time.monotonic() - began_s) / 60
    offline = {p["segment_id"]: p["predicted"] for p in predictions}
    assert {e.segment_id for e in events} == set(offline)
    assert {e.segment_id: e.action for e in events if e.missed == 0 and e.action != offline[e.segment_id]} == {}
    complete = sum(e.missed == 0 for e in events)
    print(f"{complete} of {len(events)} events from all their frames, every label as offline, {minutes:.1f} minutes")
    assert minutes < LIVE_MINUTES
