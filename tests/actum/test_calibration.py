"""A calibration's file: written, read and refused."""

import datetime

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from actum.calibration import Calibration, CalibrationError, ExtrinsicsQuality, IntrinsicsQuality

TURNED = [0.0, -1.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.2, 0.0, 0.0, 1.0, 0.3, 0.0, 0.0, 0.0, 1.0]
WHOLE = Calibration(
    image_size=(640, 480),
    K=[560.5, 0.0, 319.5, 0.0, 559.25, 239.5, 0.0, 0.0, 1.0],
    distortion=[-0.2, 0.1, 0.001, -0.001, 0.0],
    skeleton_from_image=TURNED,
    intrinsics=IntrinsicsQuality(
        date=datetime.date(2026, 3, 1), views=12, rms_px=0.1, standard_deviations_px=[0.5, 0.5, 0.8, 0.7], coverage=0.6
    ),
    extrinsics=ExtrinsicsQuality(
        date=datetime.date(2026, 3, 2),
        pairs=6,
        rms_px=0.1,
        position_standard_deviation_mm=0.5,
        rotation_standard_deviation_deg=0.04,
    ),
)
LEAST = "image_size: [640, 480]\nK: [500, 0, 320, 0, 500, 240, 0, 0, 1]\ndistortion: []\n"


def test_what_is_saved_is_loaded(tmp_path) -> None:
    WHOLE.save(tmp_path / "c.yaml")
    assert Calibration.load(tmp_path / "c.yaml") == WHOLE


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return tmp_path_factory.mktemp("calibration") / "c.yaml"


finite = st.floats(min_value=-10, max_value=10)


@given(
    focal=st.floats(min_value=1e-3, max_value=1e5), centre=finite, distortion=st.lists(finite, min_size=5, max_size=5)
)
def test_every_number_survives_exactly(file, focal: float, centre: float, distortion: list[float]) -> None:
    made = Calibration(image_size=(64, 48), K=[focal, 0, centre, 0, focal, centre, 0, 0, 1], distortion=distortion)
    made.save(file)
    assert Calibration.load(file) == made
    assert all(isinstance(number, float) for number in yaml.safe_load(file.read_text())["distortion"])


def test_any_yaml_reader_reads_it(tmp_path) -> None:
    WHOLE.save(tmp_path / "c.yaml")
    content = yaml.safe_load((tmp_path / "c.yaml").read_text())
    assert content["K"] == WHOLE.K
    assert content["skeleton_from_image"] == TURNED
    assert content["image_size"] == [640, 480]


def test_figures_written_by_hand_suffice(tmp_path) -> None:
    (tmp_path / "c.yaml").write_text(LEAST)
    fields = Calibration.load(tmp_path / "c.yaml").image_fields()
    assert fields["K"][0] == 500
    assert np.reshape(fields["skeleton_from_image"], (4, 4)).tolist() == np.eye(4).tolist()


def test_the_id_depends_on_the_content_not_on_its_writing(tmp_path) -> None:
    (tmp_path / "c.yaml").write_text(LEAST)
    (tmp_path / "d.yaml").write_text("# by hand\n" + LEAST.replace("500", "500.0"))
    (tmp_path / "e.yaml").write_text(LEAST.replace("500", "501"))
    ids = [Calibration.load(tmp_path / name).id for name in ("c.yaml", "d.yaml", "e.yaml")]
    assert ids[0] == ids[1] != ids[2]
    assert len(ids[0]) == 12
    assert set(ids[0]) <= set("0123456789abcdef")


FOREIGN = {
    "text": ("nothing of the kind", "the file"),
    "no YAML": ("K: [1, 2", "not YAML"),
    "binary": (b"\x80\xff\x00", "not YAML"),
    "an impossible date": (LEAST + "intrinsics: {date: 2026-13-45}", "not YAML"),
    "a date that is none": (LEAST + "intrinsics: {date: !!timestamp foo}", "not YAML"),
    "an integer that is none": (LEAST.replace("640", "!!int foo"), "not YAML"),
    "an integer that is empty": (LEAST.replace("640", "!!int ''"), "not YAML"),
    "a truth that is none": (LEAST.replace("640", "!!bool foo"), "not YAML"),
    "endlessly nested": ("[\n" * 3000, "not YAML"),
    "itself": ("&it {image_size: *it}", "image_size: "),
    "beyond what a number holds": (LEAST.replace("[500", f"[1{'0' * 400}"), "K"),
    "empty": ("", "the file"),
    "K missing": ("image_size: [640, 480]\ndistortion: []", "K: Field required"),
    "K too short": (LEAST.replace(", 0, 0, 1]", "]"), "K: List should have at least 9"),
    "K column-major": (LEAST.replace("0, 320, 0, 500, 240, 0, 0, 1", "0, 0, 0, 500, 0, 320, 240, 1"), "K: .*fx, 0, cx"),
    "focal length zero": (LEAST.replace("[500", "[0"), "K: .*above 0"),
    "not a number": (LEAST.replace("[500", "[.nan"), "K.0: .*finite"),
    "three coefficients": (LEAST.replace("[]", "[0.1, 0.1, 0.1]"), "distortion: .*3 distortion coefficients"),
    "no rigid transform": (LEAST + f"skeleton_from_image: {[2 * n for n in TURNED]}", "skeleton_from_image: .*rigid"),
    "a mistyped field": (LEAST + "skeletom_from_image: []", "skeletom_from_image: Extra"),
    "a later format": (LEAST + "format: actum.calibration/2", "format"),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_what_is_no_calibration_is_refused_by_name_and_place(tmp_path, name: str) -> None:
    content, place = FOREIGN[name]
    path = tmp_path / "camera.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    refused = f"camera.yaml is not a calibration .*{place}.*actum calibrate intrinsics"
    with pytest.raises(CalibrationError, match=refused):
        Calibration.load(path)


def test_a_missing_file_is_refused_by_name(tmp_path) -> None:
    with pytest.raises(CalibrationError, match=r"camera.yaml cannot be read \(No such file"):
        Calibration.load(tmp_path / "camera.yaml")


def test_images_of_another_size_are_refused() -> None:
    WHOLE.check_size(640, 480, "a.png")
    with pytest.raises(CalibrationError, match=r"a\.png is 1280x720, but the calibration is for 640x480"):
        WHOLE.check_size(1280, 720, "a.png")
