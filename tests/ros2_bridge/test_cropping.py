"""People cut out of the camera's image, where that is chosen."""

import sys

import cv2
import numpy as np
import pytest

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.installing import install_command
from actum.messages import Image
from actum.settings import SettingsError
from humans import Room, image
from people import STANDING, skeleton
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.settings import Settings

AT_NS = 7_000_000_008
WORDS = "tf,bodies,persons,cropped"
PICTURE = np.random.default_rng(0).integers(0, 256, (480, 640, 3), dtype=np.uint8)


def picture(stamp_ns: int = AT_NS, **fields: object) -> Image:
    given = {"stamp_ns": stamp_ns, "format": "bgr8", "data": PICTURE.tobytes(), **fields}
    return image().model_copy(update=given)


def test_a_body_is_cut_out_of_the_image_by_its_region() -> None:
    room = Room(ros_topics=WORDS).handle(picture(), skeleton(AT_NS, STANDING))
    region, cut = room.of_body("roi"), room.of_body("cropped")
    left, top = int(region.xmin * 640), int(region.ymin * 480)
    assert (cut.encoding, cut.step) == ("bgr8", 3 * cut.width)
    pixels = np.frombuffer(bytes(cut.data), np.uint8).reshape(cut.height, cut.width, 3)
    assert (pixels == PICTURE[top : top + cut.height, left : left + cut.width]).all()
    assert cut.width == pytest.approx((region.xmax - region.xmin) * 640, abs=2)


def test_a_jpeg_is_decoded_in_colour() -> None:
    blue = np.zeros((480, 640, 3), np.uint8)
    blue[..., 0] = 200
    jpeg = cv2.imencode(".jpg", blue)[1].tobytes()
    room = Room(ros_topics=WORDS).handle(picture(format="jpeg", data=jpeg), skeleton(AT_NS, STANDING))
    pixels = np.frombuffer(bytes(room.of_body("cropped").data), np.uint8).reshape(-1, 3)
    assert pixels.mean(axis=0) == pytest.approx([200, 0, 0], abs=3)


def test_each_image_is_cut_once_and_only_by_skeletons_of_its_time() -> None:
    room = Room(ros_topics=WORDS).handle(picture(), skeleton(AT_NS, STANDING), skeleton(AT_NS + 33_000_000, STANDING))
    topic = f"/humans/bodies/{room.bodies[0]}/cropped"
    assert len(room.said[topic]) == 1
    room.handle(picture(AT_NS + 66_000_000), skeleton(AT_NS + 166_000_000, STANDING))
    assert len(room.said[topic]) == 1


def test_everybody_is_cut_out_of_an_image() -> None:
    apart = np.array([0.8, 0, 0])
    room = Room(ros_topics=WORDS).handle(picture(), skeleton(AT_NS, STANDING - apart, STANDING + apart))
    assert all(f"/humans/bodies/{body}/cropped" in room.said for body in room.bodies)


def test_a_damaged_image_is_counted_and_the_rest_goes_on() -> None:
    room = Room(ros_topics=WORDS).handle(picture(data=b"short"), skeleton(AT_NS, STANDING))
    assert room.bridge.counters.rejects == {"unusable_image": 1}
    assert f"/humans/bodies/{room.bodies[0]}/cropped" not in room.said
    assert room.of_body("roi").c == 1


def test_people_are_cut_out_only_where_that_is_chosen() -> None:
    room = Room().handle(picture(), skeleton(AT_NS, STANDING))
    assert not any(topic.endswith("/cropped") for topic in room.declared)


def test_images_of_people_can_be_all_that_is_chosen() -> None:
    room = Room(ros_topics="cropped").handle(picture(), skeleton(AT_NS, STANDING))
    assert [topic.rpartition("/")[2] for topic in room.said] == ["cropped"]


def test_without_opencv_it_is_refused_with_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    for module in ("actum.images", "ros2_bridge.hri_out.cropping"):
        monkeypatch.delitem(sys.modules, module, raising=False)
    with pytest.raises(SettingsError) as refused:
        Ros2Bridge(Settings(ros_topics=WORDS))
    assert str(refused.value).startswith("ros_topics: the topic 'cropped' needs cv2, which is not installed: run ")
    assert install_command("marker-tracker") in str(refused.value)
