"""What is asked of the search, as a person writes it: by flags, in the environment, in a file."""

from pathlib import Path

import pytest

from actum.command_line import from_command_line
from actum.settings import complaint
from som_classifier.node import SomClassifier
from som_classifier.segmentation import DEFAULT, Segmentation
from som_classifier.settings import Settings
from som_classifier.spotting.spotted import SpottingOptions

ASKED = Segmentation(
    "auto",
    SpottingOptions(0.5, 0.3, {"wave": 3.0, "clap": 1.0}, frozenset({"push", "pull"})),
    frozenset({"wave", "clap"}),
)
FLAGS = [
    "--segments=auto",
    "--false-alarms-per-min=0.5",
    "--shortest-pause-s=0.3",
    "--cooldown-s=wave=3,clap=1",
    "--disabled-actions=push,pull",
    "--enabled-actions=wave,clap",
]
FILE = """
segments = "auto"
false_alarms_per_min = 0.5
shortest_pause_s = 0.3
cooldown_s = {wave = 3, clap = 1}
disabled_actions = ["push", "pull"]
enabled_actions = "wave, clap"
"""


def told(monkeypatch: pytest.MonkeyPatch, *flags: str) -> Settings:
    monkeypatch.setattr("sys.argv", ["som_classifier", *flags])
    return from_command_line(Settings, "som_classifier")


def test_where_nothing_is_asked_everything_is_told_and_both_are_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch).segmentation == DEFAULT == Segmentation("both", SpottingOptions(), frozenset())


def test_flags(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch, *FLAGS).segmentation == ASKED


def test_a_flag_may_be_given_for_each_action(monkeypatch: pytest.MonkeyPatch) -> None:
    """As `actum up` hands them on."""
    each = ["--cooldown-s=wave=3", "--cooldown-s=clap=1", "--disabled-actions=push", "--disabled-actions=pull"]
    assert told(monkeypatch, *FLAGS[:3], *each, FLAGS[5]).segmentation == ASKED


def test_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for flag in FLAGS:
        name, _, value = flag.removeprefix("--").partition("=")
        monkeypatch.setenv(f"ACTUM_{name.upper().replace('-', '_')}", value)
    assert told(monkeypatch).segmentation == ASKED


def test_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "actum.toml").write_text(FILE)
    monkeypatch.setenv("ACTUM_CONFIG", str(tmp_path / "actum.toml"))
    assert told(monkeypatch).segmentation == ASKED


@pytest.mark.parametrize(
    ("flag", "said"),
    [
        ("--segments=found", "segments"),
        (
            "--cooldown-s=wave",
            "'wave' is not of the form ACTION=SECONDS: give each action a number of seconds, such as wave=3,clap=1",
        ),
        ("--cooldown-s=wave=-1", "cooldown_s.wave"),
        ("--cooldown-s=wave=inf", "cooldown_s.wave"),
        ("--shortest-pause-s=-1", "shortest_pause_s"),
        ("--false-alarms-per-min=0", "false_alarms_per_min"),
    ],
)
def test_what_cannot_be_meant_is_refused_by_name(flag: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError) as refused:
        told(monkeypatch, flag)
    assert said in complaint(refused.value)


def test_they_reach_the_service(monkeypatch: pytest.MonkeyPatch) -> None:
    node = SomClassifier.configured(told(monkeypatch, *FLAGS))
    assert node._segmentation == ASKED
