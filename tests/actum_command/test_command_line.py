import json
import re
import signal
import socket
import tempfile
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import pytest
import typer
from typer.testing import CliRunner

from actum import __version__
from actum.messages import Segment
from actum.recorder import write_recording
from actum.recording import Recording
from actum.runtime import RouterUnreachableError
from actum.settings import ServiceSettings
from actum_command.__main__ import app
from actum_command.commands import (
    demo_command,
    evaluate_command,
    recording_options,
    segment_commands,
    system_commands,
    terminal,
)
from actum_command.commands.plain_help import PlainCommand, PlainTyper
from actum_command.commands.training_commands import preset_named
from actum_command.demo import marked, unmarked
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.training import SEARCHES
from command_lines import invoke, refused, written
from people import FRAME_NS
from performers import TINY, TINY_PAPER, mark, performance
from recognisers import tiny_model
from som_classifier.attention import PostureInput
from som_classifier.model_loading import load_model
from som_classifier.presets import DEFAULT, PAPER, PRESETS, PaperPreset


def commands_of(group: typer.Typer, words: tuple[str, ...] = ()) -> Iterator[str]:
    """List a group's own name and all commands below it, as a user types them."""
    yield " ".join(words)
    for command in group.registered_commands:
        name = command.name or getattr(command.callback, "__name__", "")
        yield " ".join((*words, name.replace("_", "-")))
    for below in group.registered_groups:
        if below.typer_instance is not None and below.name is not None:
            yield from commands_of(below.typer_instance, (*words, below.name))


COMMANDS = tuple(dict.fromkeys(commands_of(app)))


def test_the_commands_are_found_in_all_groups() -> None:
    assert {"", "demo", "segment toggle", "import msrc12", "calibrate up", "label delete"} <= set(COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself_without_pythons_types(command: str) -> None:
    asked = CliRunner().invoke(app, [*command.split(), "--help"], env={"COLUMNS": "200"})
    assert asked.exit_code == 0
    assert "Usage" in asked.output
    assert (
        re.findall(
            r"default factory|typing|pathlib|<class|\bNone\b|<(?:str|int|float|bool|path|file)\b|list\[", asked.output
        )
        == []
    )


def test_the_version_is_told() -> None:
    assert invoke("--version").stdout == f"actum {__version__}\n"


@pytest.mark.parametrize(
    ("command", "name", "right"),
    [
        ("record {}", "push", "push.mcap"),
        ("simulate {}", "scene.npz", "scene.mcap"),
        ("train a.mcap -o {}", "model.pkl", "model.npz"),
        ("evaluate m.npz a.mcap --json {}", "report.txt", "report.json"),
        ("markers -o {}", "sheet.png", "sheet.pdf"),
        ("calibrate intrinsics pictures -o {}", "camera.json", "camera.yaml"),
        ("models fetch -o {}", "pose.npz", "pose.task"),
    ],
)
def test_a_file_that_would_be_named_as_another_kind_is_refused_with_the_right_name(
    command: str, name: str, right: str, tmp_path: Path
) -> None:
    said = refused(*(word.format(tmp_path / name) for word in command.split()))
    assert f"{tmp_path / name} does not end in {Path(right).suffix}" in said
    assert said.endswith(f"name the file {tmp_path / right}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("command", "content", "told"),
    [
        ("train {0} -o {0}/m.npz", "nothing of the kind", "a.mcap"),
        ("train {0} -o {0}/m.npz", None, "no recordings"),
        ("inspect model.npz -o {0}/map.png", None, "give a folder"),
        ("evaluate {0}/a.mcap {0}", "PK not a model", "actum train"),
        ("evaluate {0}/a.mcap {0}", "a recording, named as the model", "a.mcap: the file is not a model of actum"),
        ("evaluate m.npz", None, "a model and at least one recording are needed"),
        ("watch everything", None, "event"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(command: str, content: str | None, told: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "a.mcap").write_text(content)
    said = refused(*command.format(tmp_path).split())
    assert told in said
    assert "pickle" not in said, "nobody is advised to load a file unsafely"


@pytest.mark.parametrize(
    ("source", "remedy"),
    [
        ("simulator", "--source recording"),
        ("none", "--source recording"),
        ("camera", "leave out --path. To read a video file, set ACTUM_CAMERA to that file"),
    ],
)
def test_a_file_is_not_passed_over_by_a_source_that_plays_none(
    source: str, remedy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(system_commands, "refuse_taken", lambda _: None)
    assert remedy in refused("up", "--source", source, "--path", "a.mcap")


def test_an_unknown_preset_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    assert invoke("simulate", tmp_path / "a.mcap", "--repetitions", "1").exit_code == 0
    message = refused("train", tmp_path, "-o", tmp_path / "m.npz", "--preset", "best")
    assert "is not a preset" in message
    assert "paper" in message


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (("paper", "attention=arms"), "attention=arms is not a setting"),
        (("paper", "beta=1"), "beta=1 is not a setting"),
        (("paper", "axes"), "axes= is not a setting"),
        (("pyramid", "attention=all"), "preset pyramid has no settings"),
    ],
)
def test_a_setting_that_a_preset_does_not_know_is_refused_with_the_known_ones(
    tmp_path: Path, given: tuple[str, str], told: str
) -> None:
    preset, setting = given
    message = refused("train", tmp_path, "-o", tmp_path / "m.npz", "--preset", preset, "--set", setting)
    assert told in message
    assert "attention" in message


def test_the_papers_preset_is_trained_as_it_was_set() -> None:
    preset = preset_named("paper", ["attention=all", "origin=hips"])
    assert isinstance(preset, PaperPreset)
    assert preset == replace(PAPER, posture=PostureInput(PAPER.posture.axes, "hips", "all"))
    assert preset_named("paper", ()) is PAPER


def test_training_and_evaluating_on_simulated_examples(tmp_path: Path) -> None:
    assert invoke("simulate", tmp_path / "a.mcap", "--repetitions", "2").exit_code == 0
    trained = invoke("train", tmp_path / "a.mcap", "-o", tmp_path / "m.npz")
    assert "10 samples of 5 actions" in " ".join(trained.output.split())
    assert "Too few examples: " in trained.output
    assert "There are only 14 s of background" in " ".join(trained.output.split())
    report = tmp_path / "report.json"
    command = ["evaluate", tmp_path / "m.npz", tmp_path / "a.mcap", "--json", report]
    assert "accuracy" in invoke(*command).output
    assert '"predictions"' in report.read_text()


@pytest.mark.usefixtures("quick_training")
def test_an_evaluation_warns_of_people_whom_the_model_was_trained_on(examples: Path, tmp_path: Path) -> None:
    model, nameless = tmp_path / "m.npz", tmp_path / "b.mcap"
    assert invoke("train", examples, "-o", model).exit_code == 0
    assert invoke("simulate", tmp_path / "other.mcap", "--actor", "1", "--repetitions", "1").exit_code == 0
    write_recording(nameless, Recording(tmp_path / "other.mcap").messages(), person="", source="test")
    said = {
        name: " ".join(invoke("evaluate", *arguments).output.split())
        for name, arguments in {
            "same": (model, examples),
            "other": (model, tmp_path / "other.mcap"),
            "nameless": (model, nameless),
            "left out": ("--leave-one-person-out", examples, nameless),
        }.items()
    }
    assert "the model was trained on person simulated 0, whom it recognises better than others" in said["same"]
    assert "accuracy" in said["other"] and "person" not in said["other"]
    assert "a recording names no person" in said["nameless"]
    assert "a recording names no person" in said["left out"]


@pytest.fixture
def quick_training(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both presets are small ones, and the search, which takes most of the time, is left out."""
    for preset, small in ((DEFAULT, TINY), (PAPER, TINY_PAPER)):
        monkeypatch.setitem(PRESETS, preset.name, replace(small, name=preset.name))
    monkeypatch.delitem(SEARCHES, DEFAULT.kind)


@pytest.mark.usefixtures("quick_training")
def test_an_evaluation_names_the_actions_that_no_model_could_recognise(examples: Path, tmp_path: Path) -> None:
    model, other = tmp_path / "m.npz", tmp_path / "other.mcap"
    assert invoke("train", examples, "-o", model).exit_code == 0
    assert invoke("simulate", other, "--actor", "1", "--repetitions", "2").exit_code == 0
    evaluated = ("evaluate", model, other), ("evaluate", "--leave-one-person-out", examples, other)
    assert not any("counts as missed" in invoke(*command).output for command in evaluated)
    assert invoke("label", "relabel", other, "1", "wave").exit_code == 0
    given, left_out = (" ".join(invoke(*command).output.split()) for command in evaluated)
    assert "the model does not know wave, which the recordings contain: each one counts as missed" in given
    assert "only one person does wave, which the model that is tested on this person therefore does not" in left_out


@pytest.mark.usefixtures("quick_training")
def test_training_holds_the_examples_against_the_background_that_is_named(examples: Path, tmp_path: Path) -> None:
    def trained(*background: object) -> str:
        flags = [flag for each in background for flag in ("--background", each)]
        done = invoke("train", examples, "-o", tmp_path / "m.npz", *flags)
        assert done.exit_code == 0, done.output
        return load_model(tmp_path / "m.npz").id

    default, none, own = trained(), trained("none"), trained(examples)
    assert default == trained("shipped")
    assert len({default, none, own, trained("shipped", examples)}) == 4
    nothing = tmp_path / "no.mcap"
    assert str(nothing) in refused("train", examples, "-o", tmp_path / "m.npz", "--background", nothing)


@pytest.mark.usefixtures("quick_training")
def test_a_model_predicts_how_postures_go_on_only_where_that_is_asked_for(examples: Path, tmp_path: Path) -> None:
    for name, flags in (("without", ()), ("with", ("--continue",))):
        done = invoke("train", examples, "-o", tmp_path / f"{name}.npz", *flags)
        assert done.exit_code == 0, done.output
    assert load_model(tmp_path / "without.npz").continuation is None
    assert load_model(tmp_path / "with.npz").continuation is not None


@pytest.mark.usefixtures("quick_training")
def test_examples_are_added_to_a_model_file(examples: Path, tmp_path: Path) -> None:
    before, after = tmp_path / "before.npz", tmp_path / "after.npz"
    assert invoke("train", examples, "-o", before, "--jobs", "1").exit_code == 0
    added = invoke("train", examples, "-o", after, "--add-to", before)
    assert added.exit_code == 0, added.output
    known = load_model(before)
    assert load_model(after).metadata.samples == 2 * known.metadata.samples
    assert f"{2 * known.metadata.samples} samples of {len(known.labels)} actions" in " ".join(added.output.split())
    assert str(tmp_path / "no.npz") in refused("train", examples, "-o", after, "--add-to", tmp_path / "no.npz")


@pytest.mark.parametrize(
    ("flags", "named"),
    [
        (("--background", "none"), "--background"),
        (("--continue",), "--continue"),
        (("--preset", DEFAULT.name), "--preset"),
        (("--preset", "paper", "--set", "axes=posture"), "--preset and --set"),
    ],
)
def test_what_an_addition_keeps_is_refused_as_a_flag_before_anything_is_read(
    flags: tuple[str, ...], named: str, tmp_path: Path
) -> None:
    (tmp_path / "broken.mcap").write_bytes(b"no recording")
    files = tmp_path / "broken.mcap", "-o", tmp_path / "after.npz", "--add-to", tmp_path / "no.npz"
    said = " ".join(refused("train", *files, *flags).split())
    assert said.endswith(
        f"with --add-to, the model keeps its preset, settings, background and continuation: leave out {named}"
    )


def test_the_model_to_add_to_is_loaded_before_recordings(tmp_path: Path) -> None:
    (tmp_path / "broken.mcap").write_bytes(b"no recording")
    files = tmp_path / "broken.mcap", "-o", tmp_path / "after.npz", "--add-to", tmp_path / "no.npz"
    said = refused("train", *files)
    assert str(tmp_path / "no.npz") in said and "broken" not in said


@pytest.mark.usefixtures("quick_training")
def test_a_model_that_cannot_find_actions_by_itself_says_what_to_do(examples: Path, tmp_path: Path) -> None:
    model = tmp_path / "m.npz"
    assert invoke("train", examples, "-o", model, "--preset", "paper").exit_code == 0
    assert "cannot find actions without marks: train it again" in refused("evaluate", "--continuous", model, examples)


def test_what_is_found_without_marks_is_told_and_written(
    examples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No model is needed to see how it is told: this one finds the first action alone."""

    def found(*_: object) -> Found:
        return Found([first], [truth, truth_missed], [Stretch("a.mcap", 1, 0, 60 * 10**9)])

    first = Detection("a.mcap", 1, 0, 10**9, 2 * 10**9, "lift", 0.9)
    truth, truth_missed = Truth("a.mcap", 1, 0, 10**9, "lift"), Truth("a.mcap", 1, 5 * 10**9, 6 * 10**9, "push")
    monkeypatch.setattr(evaluate_command, "load_model", lambda _: tiny_model())
    monkeypatch.setattr(evaluate_command, "found_by", found)
    report = tmp_path / "report.json"
    done = invoke("evaluate", "--continuous", "m.npz", examples, "--json", report)
    assert "1 of 2 actions found, 0 false detections" in done.output
    written = json.loads(report.read_text())
    assert (written["detections"][0]["label"], written["truths"][1]["label"]) == ("lift", "push")
    assert written["scores"]["event_f1"] == pytest.approx(2 / 3)


def test_everyday_doings_lengthen_an_example_and_are_not_marked(tmp_path: Path) -> None:
    def simulated(*choices: str) -> tuple[float, int]:
        path = tmp_path / f"{choices[1]}.mcap"
        assert invoke("simulate", path, "--repetitions", "1", *choices).exit_code == 0
        messages = list(Recording(path).messages())
        return messages[-1].stamp_ns / 1e9, sum(isinstance(message, Segment) for message in messages)

    plain_s, marks = simulated("--everyday", "none")
    lively_s, marks_among_doings = simulated("--everyday", "familiar")
    idle_s, marks_without_actions = simulated("--everyday", "only", "--minutes", "2")
    assert lively_s > 2 * plain_s
    assert marks == marks_among_doings == 10
    assert (idle_s >= 120, marks_without_actions) == (True, 0)


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("examples") / "a.mcap"
    assert invoke("simulate", path, "--repetitions", "2").exit_code == 0
    return path


@pytest.fixture(scope="module")
def broken_off(examples: Path) -> Path:
    """The same examples, without the last of what stands behind the messages."""
    path = examples.with_name("broken.mcap")
    path.write_bytes(examples.read_bytes()[:-1])
    return path


@pytest.mark.thorough
def test_training_and_evaluating_name_the_recording_that_breaks_off(broken_off: Path, tmp_path: Path) -> None:
    model = tmp_path / "m.npz"
    for command in (["train", broken_off, "-o", model, "--preset", "paper"], ["evaluate", model, broken_off]):
        done = invoke(*command)
        assert done.exit_code == 0
        assert f"{broken_off} is truncated" in done.stdout


@pytest.mark.parametrize("place", ["nowhere/x.json", "folder", "file/x.json"])
def test_where_nothing_can_be_written_nothing_is_trained_or_evaluated(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    monkeypatch.setattr(evaluate_command, "load_model", lambda _: pytest.fail("the model was loaded"))
    monkeypatch.setattr(recording_options, "select", lambda *_: pytest.fail("the recordings were opened"))
    assert place in refused("evaluate", "m.npz", "a.mcap", "--json", str(tmp_path / place))
    assert place in refused("train", "a.mcap", "-o", str(tmp_path / place))


@pytest.mark.parametrize(
    ("name", "value", "complaint"),
    [
        ("ACTUM_SENSOR", "Kinect 0", "settings: sensor: 'Kinect 0' is not a name: use 1 to 64 of the characters a-z"),
        ("ACTUM_CONNECT", "127.0.0.1:7551", "'127.0.0.1:7551' is not an endpoint: use tcp/host:port"),
        ("ACTUM_CONNECT", "foo", "'foo' is not an endpoint: use tcp/host:port"),
        ("ACTUM_ZENOH_CONFIG", "/nowhere.json5", "/nowhere.json5 is not a valid Zenoh configuration"),
        ("ACTUM_CONFIG", "/nowhere.toml", "/nowhere.toml, which does not exist or is not a file"),
    ],
)
@pytest.mark.parametrize("command", ["doctor", "watch", "scene", "segment end a"])
def test_settings_that_cannot_be_used_end_a_command_with_one_line(
    name: str, value: str, complaint: str, command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(name, value)
    refused = invoke(*command.split())
    assert isinstance(refused.exception, SystemExit), refused.exception
    assert (refused.exit_code, refused.stderr.count("\n")) == (1, 1)
    assert complaint in refused.stderr


def test_a_command_for_one_sensor_refuses_several(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_SENSOR", "left,right")
    assert "sensor: 'left,right' is more than one name: name one" in invoke("watch").stderr


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> list[str | None]:
    """The endpoints that a router was to listen on, without any router."""
    endpoints: list[str | None] = []
    monkeypatch.setattr(system_commands, "serve_router", lambda endpoint, *_: endpoints.append(endpoint))
    monkeypatch.setattr(system_commands, "stop_on_signals", lambda: None)
    return endpoints


@pytest.mark.parametrize("option", ["--listen", "--link"])
@pytest.mark.parametrize("endpoint", ["udp7551", "tcp/127.0.0.1:99999", "7552", "tcp/127.0.0.1"])
def test_a_router_refuses_what_is_no_endpoint(option: str, endpoint: str, served: list[str | None]) -> None:
    assert f"'{endpoint}' is not an endpoint: use tcp/host:port" in refused("router", option, endpoint)
    assert served == []


@pytest.mark.parametrize("host", ["127.0.0.1", "[::]", "[::1]", "localhost"])
def test_a_router_listens_on_either_family(host: str, served: list[str | None]) -> None:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family) as probe:
        try:
            probe.bind((host.strip("[]"), 0))
        except OSError:
            pytest.skip("this machine has no IPv6")
        port = probe.getsockname()[1]
        probe.listen()
        taken = refused("router", "--listen", f"tcp/{host}:{port}")
    assert "the router cannot listen at" in taken
    assert invoke("router", "--listen", f"tcp/{host}:{port}").exit_code == 0
    assert served == [f"tcp/{host}:{port}"]


@pytest.mark.parametrize("command", [("router", "--listen"), ("up", "--connect")])
def test_a_router_at_an_address_that_this_machine_does_not_have_is_advised_to_use_its_own(
    command: tuple[str, str], served: list[str | None]
) -> None:
    foreign = refused(*command, "tcp/192.0.2.1:7447")  # an address that no machine has: RFC 5737
    assert "set ACTUM_CONNECT to an address of this machine" in foreign
    assert "stop the program" not in foreign
    assert served == []


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [([""], "segment_id: "), (["x" * 1000], "segment_id: "), (["a", "--agent", "9999999999"], "agent: ")],
)
def test_a_mark_that_is_none_is_refused_without_a_router(arguments: list[str], complaint: str) -> None:
    refused = invoke("segment", "start", *arguments)
    assert (refused.exit_code, refused.stderr.count("\n")) == (1, 1)
    assert complaint in refused.stderr


def test_a_switch_that_is_left_leaves_the_line_to_the_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(segment_commands, "connect", lambda: nullcontext(None))
    monkeypatch.setattr(segment_commands, "Answers", lambda _: None)
    left = CliRunner().invoke(app, ["segment", "toggle"], input="")
    assert left.exit_code == 0
    assert left.stdout == "press Enter to start action 1, Ctrl-D to quit \n"


def test_who_waits_for_a_router_says_so_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tried: list[float] = []

    def opened(here: ServiceSettings, wait_s: float) -> None:
        tried.append(wait_s)
        if len(tried) == 1:
            raise RouterUnreachableError(here.connect)

    monkeypatch.setattr(terminal, "Client", opened)
    terminal.connect_whenever()
    assert tried == [0, float("inf")]
    assert capsys.readouterr().out == f"there is no router at {ServiceSettings().connect} yet: waiting for a router\n"


@pytest.fixture
def _handlers() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs inherit that it is ignored
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("_handlers")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize(
    ("way", "module", "step"), [([], demo_command, "learned_from"), (["--marked"], marked, "train_model")]
)
def test_a_demo_ends_where_it_is_and_leaves_no_files(
    number: signal.Signals,
    way: list[str],
    module: ModuleType,
    step: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", tmp_path)
    monkeypatch.setattr(demo_command, "refuse_taken", lambda _: None)
    monkeypatch.setattr(module, step, lambda *_: signal.raise_signal(number))
    for of, later in ((marked, "nearest_neighbour_baseline"), (unmarked, "run")):
        monkeypatch.setattr(of, later, lambda *_: pytest.fail("it went on"))
    interrupted = invoke("demo", *way)
    assert isinstance(interrupted.exception, SystemExit), interrupted.exception
    assert interrupted.exit_code == 128 + number
    assert list(tmp_path.iterdir()) == []


def test_a_router_refuses_a_configuration_that_zenoh_refuses(tmp_path: Path) -> None:
    (tmp_path / "router.json5").write_text("{nonsense")
    assert "the router cannot start with " in refused("router", "--config", tmp_path / "router.json5")


def test_why_nothing_could_be_learnt_is_said_before_that_it_could_not(tmp_path: Path) -> None:
    skeletons, _ = performance(["lift"])
    written(
        tmp_path / "short.mcap",
        *skeletons,
        mark("start", 2 * FRAME_NS, "s1", "lift"),
        mark("end", 3 * FRAME_NS, "s1"),
        person="1",
    )
    done = invoke("train", tmp_path, "-o", tmp_path / "model.npz")
    assert done.exit_code == 1
    assert "s1 of " in done.stdout and "was not used" in done.stdout
    assert "2 usable frames, at least 3 are needed" in done.stdout
    assert "a model needs examples of at least two actions" in done.stderr


def leaves(command: Any) -> Iterator[Any]:
    """Every command, those in groups too."""
    for each in getattr(command, "commands", {}).values():
        yield from leaves(each)
    if not hasattr(command, "commands"):
        yield command


@pytest.mark.parametrize("value", ["inf", "nan", "1e999"])
def test_a_number_that_is_not_finite_is_refused_as_argument_and_as_option(value: str) -> None:
    measured: list[float] = []
    measuring = PlainTyper()

    @measuring.command()
    def measure(start: Annotated[float, typer.Argument()], seconds: Annotated[float, typer.Option()] = 1.0) -> None:
        measured.append(start + seconds)

    for arguments in ([value], ["1", "--seconds", value]):
        refused = CliRunner().invoke(measuring, arguments, standalone_mode=False).exception
        assert isinstance(refused, typer.BadParameter) and "is not a finite number" in refused.message
    assert not measured


def test_every_command_holds_its_numbers_to_that() -> None:
    assert all(isinstance(command, PlainCommand) for command in leaves(typer.main.get_command(app)))


@pytest.mark.parametrize(
    ("typed", "meant"),
    [("recrod", "record"), ("eval", "evaluate"), ("scnee", "scene"), ("nonsense", None), ("tools", None), ("x", None)],
)
def test_a_command_is_suggested_only_where_one_is_like_what_was_typed(typed: str, meant: str | None) -> None:
    refused = invoke(typed)
    assert refused.exit_code == 2
    assert f"No such command '{typed}'." in refused.stderr
    assert ("Did you mean" in refused.stderr) == (meant is not None)
    assert meant is None or f"Did you mean '{meant}'?" in refused.stderr
