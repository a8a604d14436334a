"""`actum`, or `python -m actum_command`."""

from importlib.util import find_spec
from typing import Annotated

from actum import __version__
from actum.runtime import end_with_parent, needs_extra
from actum.settings import NodeSettings

with needs_extra("actum-command"):
    import typer

    from actum_command.commands import (
        demo_command,
        deploy_commands,
        doctor_command,
        evaluate_command,
        foxglove_commands,
        inspect_command,
        label_commands,
        play_command,
        pose_model_commands,
        recording_commands,
        scene_commands,
        segment_commands,
        system_commands,
        training_commands,
        tune_command,
        view_command,
        watch_command,
    )
    from actum_command.commands.plain_help import PlainTyper
    from actum_command.commands.service_flags import with_router_flags
    from actum_command.commands.terminal import refuse_without, say

app = PlainTyper(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Recognise online what a person does and to which object. Start with 'actum up', which runs everything on "
    "this machine, and 'actum watch', which prints the recognised events.",
)


def _show_version(asked: bool) -> None:
    if asked:
        say(f"actum {__version__}")
        raise typer.Exit


@app.callback()
def _actum(
    _version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_show_version, help="print the version and exit")
    ] = False,
) -> None:
    """Take what goes before every command."""


def _add_picture_commands() -> None:
    """Add the commands that read or draw pictures; without OpenCV, as in containers, each says what to install."""
    if find_spec("cv2") is None:
        for name in ("import", "draw", "markers", "calibrate"):
            whatever = {"allow_extra_args": True, "ignore_unknown_options": True}
            refusing = app.command(name, context_settings=whatever, help="Not installed.")
            refusing(lambda: refuse_without("cv2", "OpenCV", "actum-command"))
        return
    from actum_command.commands import calibrate_commands, draw_command, import_commands, markers_command

    app.add_typer(import_commands.app, name="import")
    app.command("draw")(draw_command.draw)
    app.command("markers")(markers_command.markers)
    app.add_typer(calibrate_commands.app, name="calibrate")


app.command("demo")(with_router_flags(demo_command.demo))
app.command("up")(with_router_flags(system_commands.up, NodeSettings))
app.command("router")(system_commands.router)
app.add_typer(segment_commands.app, name="segment")
app.command("record")(with_router_flags(recording_commands.record))
app.command("play")(with_router_flags(play_command.play))
app.add_typer(label_commands.app, name="label")
_add_picture_commands()
app.add_typer(pose_model_commands.app, name="models")
app.command("train")(training_commands.train_command)
app.command("evaluate")(evaluate_command.evaluate_command)
app.command("tune")(tune_command.tune)
app.command("inspect")(inspect_command.inspect)
app.command("simulate")(scene_commands.simulate)
app.command("scene")(with_router_flags(scene_commands.scene))
app.command("watch")(with_router_flags(watch_command.watch))
app.command("ros2")(with_router_flags(system_commands.ros2))
app.command("view")(with_router_flags(view_command.view))
app.command("foxglove")(with_router_flags(foxglove_commands.foxglove))
app.command("export")(foxglove_commands.export)
app.add_typer(deploy_commands.app, name="deploy")
app.command("doctor")(with_router_flags(doctor_command.doctor, NodeSettings))


def main() -> None:
    """Run the command line."""
    end_with_parent()
    app()


if __name__ == "__main__":
    main()
