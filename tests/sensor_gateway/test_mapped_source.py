"""What a gateway adds: how its camera is tilted, and that a file played again is another session."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from actum.messages import Image, Message, Posture, Skeleton
from actum.recorder import write_recording
from people import reaches
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from sensor_gateway.mapped_source import with_session_of
from sensor_gateway.settings import Settings
from sensor_gateway.sources import source_of

UP = [0.0, -0.97, 0.24]


def first_messages(recording: Path, **told: object) -> list[Skeleton | Image]:
    source = source_of(Settings(source="recording", path=recording, **told), start_ns=0)  # type: ignore[arg-type]
    return next(messages for messages in source.frames() if any(isinstance(m, Image) for m in messages))  # type: ignore[return-value]


def test_each_skeleton_says_which_way_is_up(recorded_scene: Path) -> None:
    told = first_messages(recorded_scene, up_in_camera=UP)
    assert [m.up_in_camera for m in told if isinstance(m, Skeleton)] == [UP]
    assert any(isinstance(m, Image) for m in told)


def test_it_reads_it_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_UP_IN_CAMERA", "[0, -0.97, 0.24]")
    assert Settings().up_in_camera == UP


def test_nothing_is_said_where_nothing_is_known(recorded_scene: Path) -> None:
    assert [m.up_in_camera for m in first_messages(recorded_scene) if isinstance(m, Skeleton)] == [None]


@pytest.mark.parametrize("up", [[0, 0, 0], [0, 1e9, 0], [0, -1]])
def test_up_must_be_a_direction(up: list[float]) -> None:
    with pytest.raises(ValidationError, match="up_in_camera"):
        Settings(up_in_camera=up)


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "reaches.mcap"
    write_recording(path, reaches(20), person="1", source="test")
    return path


def test_a_recording_played_again_begins_anew_for_those_who_listen(recording: Path) -> None:
    node, made = PosePreprocessor(PoseSettings.defaults()), []
    for start_ns in (1, 2):
        source = source_of(Settings(source="recording", path=recording), start_ns)
        messages: list[Message] = [message for instant in source.frames() for message in instant]
        made.append([posture for message in messages for posture in node.handle(message)])
    assert [len(postures) for postures in made] == [20, 20]
    assert all(isinstance(posture, Posture) and posture.valid for postures in made for posture in postures)
    assert not node.counters.rejects


def test_the_longest_session_name_still_fits(recording: Path) -> None:
    mapping = with_session_of("f" * 16)
    longest = reaches(1)[0].model_copy(update={"session_id": "s" * 200})
    assert Skeleton.model_validate(mapping(longest).model_dump()).session_id.endswith(".ffffffffffffffff")
