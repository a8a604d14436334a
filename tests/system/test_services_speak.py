"""What a first user has to know is said on a service's own output, once, and by `actum doctor`."""

from pathlib import Path

import pytest

from actum import keys
from actum.messages import Skeleton
from actum_command.doctor.heard import STATUS_S
from camera_videos import write_video
from live import Running, System, collect, described, wait_until
from people import reaches
from sensors import marker_camera, recording

pytestmark = pytest.mark.system


def wait_for_line(service: Running, *words: str) -> None:
    """Wait until one line, and no second one, has all these words."""

    def lines() -> list[str]:
        return [line for line in service.said().splitlines() if all(word in line for word in words)]

    wait_until(lambda: len(lines()) > 0, f"it says {words}")
    assert len(lines()) == 1


def diagnosed(running: System) -> str:
    """Return what doctor prints, which takes some seconds."""
    examined = running.actum("doctor")
    assert examined.returncode == 1
    return " ".join(examined.stdout.split())


def test_a_gateway_of_a_simulated_scene_says_so_without_a_router_and_doctor_does_with_one(running: System) -> None:
    gateway = running.start("scene_simulator")
    wait_for_line(gateway, "sensor_gateway: sensor kinect0: simulated scene, no camera")
    running.start_router()
    with running.client() as client:
        running.wait_for_services(client, "sensor_gateway")
        info = described(client)
        assert (info.source or "").startswith("simulated scene")
        assert info.host
        assert "sensor: simulated scene, no camera" in diagnosed(running)


def test_a_model_that_is_not_there_is_named(running: System, scene_model: Path, tmp_path: Path) -> None:
    model = tmp_path / "later.npz"
    classifier = running.start("som_classifier", "--model", str(model))
    wait_for_line(classifier, f"no model: there is no {model} yet")
    running.start_router()
    with running.client() as client:
        running.wait_for_services(client, "som_classifier")
        lacking = f"som_classifier has the state 'no model: there is no {model} yet' and therefore recognises no action"
        assert lacking in diagnosed(running)
        model.write_bytes(b"not yet whole")
        wait_for_line(classifier, f"no model: {model}: the file is not a model of actum")
        (tmp_path / "whole.npz").write_bytes(scene_model.read_bytes())
        (tmp_path / "whole.npz").rename(model)
        wait_for_line(classifier, "running again")
        model.write_bytes(b"damaged")
        wait_for_line(classifier, f"model not renewed: {model}: the file is not a model of actum")
    wait_for_line(classifier, f"no model: there is no {model} yet")


def test_a_classifier_that_is_told_of_no_model_says_so(running: System) -> None:
    wait_for_line(running.start("som_classifier"), "no model: --model (ACTUM_MODEL) names none")


def test_a_camera_file_that_is_not_there_is_named_and_that_it_came(running: System, tmp_path: Path) -> None:
    running.start_router()
    missing = tmp_path / "none.avi"
    gateway = running.start("sensor_gateway", *marker_camera(tmp_path, missing))
    state, source = "camera lost: it cannot be opened", f"(file {missing} (marker camera))"
    lost = f"{state} {source}"
    wait_for_line(gateway, lost)
    assert f"marker_camera has the state '{state}' {source} and keeps trying to open the camera" in diagnosed(running)
    write_video(tmp_path / "arriving.avi").rename(missing)
    wait_for_line(gateway, "running again")
    wait_for_line(gateway, lost)
    assert "ended" not in gateway.said(), "it is played again and again"


def test_a_router_that_is_lost_and_comes_back_is_told(running: System) -> None:
    router = running.start_router_process()
    service = running.start("action_fusion")
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        router.process.kill()
        wait_for_line(
            service, f"the connection to the router at {running.settings.connect} is lost: waiting for the router"
        )
        running.start_router_process()
        wait_for_line(service, f"connected to {running.settings.connect} again")


def test_the_end_of_a_recording_is_told_with_its_name(running: System, tmp_path: Path) -> None:
    running.start_router()
    gateway = running.start("sensor_gateway", *recording(tmp_path / "a.mcap", *reaches(3)))
    source = f"(file {tmp_path / 'a.mcap'} (recording))"
    ended = f"source ended {source}"
    wait_for_line(gateway, ended)
    problem = (
        f"sensor_gateway has the state 'source ended' {source}: restart sensor_gateway to play the source once more"
    )
    assert problem in diagnosed(running)
    assert STATUS_S > 1.0, "doctor heard two reports meanwhile"
    wait_for_line(gateway, ended)


def test_a_recording_can_be_played_again_and_again(running: System, tmp_path: Path) -> None:
    running.start_router()
    with running.client() as client:
        skeletons = client.listen(keys.pattern(keys.SKELETON, client.sensor))
        gateway = running.start("sensor_gateway", *recording(tmp_path / "a.mcap", *reaches(3)), "--loop")
        found = collect(skeletons, Skeleton, lambda found: len(found) >= 7)
        stamps = [skeleton.stamp_ns for skeleton in found]
        assert stamps == sorted(set(stamps))
        assert [skeleton.agents for skeleton in found[:3]] == [skeleton.agents for skeleton in found[3:6]]
    assert "ended" not in gateway.said()
