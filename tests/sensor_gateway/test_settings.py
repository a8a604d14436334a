"""Every setting can be given as text: by a flag or by the environment."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from sensor_gateway.settings import Settings


@pytest.mark.parametrize("written", ["1", '"1"'])
def test_a_cameras_number_in_a_file_may_be_a_number(
    written: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "actum.toml"
    file.write_text(f"camera = {written}")
    monkeypatch.setenv("ACTUM_CONFIG", str(file))
    assert Settings().camera == "1"


def test_a_cameras_name_is_none_of_other_kinds() -> None:
    with pytest.raises(ValidationError, match="camera"):
        Settings(camera=True)  # type: ignore[arg-type]
