"""The rate of the scene's images can be given as text: by a flag or by the environment."""

import pytest
from pydantic import ValidationError

from scene_simulator.settings import Settings


@pytest.mark.parametrize("rate", ["0", "5", "10", "15", "30"])
def test_the_image_rate_is_read_from_text(rate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_IMAGE_HZ", rate)
    assert Settings().image_hz == int(rate)


@pytest.mark.parametrize("rate", ["7", "", "-5", "fast"])
def test_other_rates_are_refused(rate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_IMAGE_HZ", rate)
    with pytest.raises(ValidationError, match="image_hz"):
        Settings()
