"""The commands that read or draw pictures, for which OpenCV is needed: the images of containers leave it out."""

from importlib.util import find_spec

from actum_command.commands.plain_help import PlainTyper
from actum_command.commands.viewed_streams import refuse_without

NAMES = ("import", "draw", "markers", "calibrate")


def add_picture_commands(app: PlainTyper) -> None:
    """Add these commands to a program; where OpenCV is not installed, each says what to install instead."""
    if find_spec("cv2") is None:
        for name in NAMES:
            whatever = {"allow_extra_args": True, "ignore_unknown_options": True}
            app.command(name, context_settings=whatever, help="Not installed.")(_refuse)
        return
    from actum_command.commands import calibrate_commands, draw_command, import_commands, markers_command

    app.add_typer(import_commands.app, name="import")
    app.command("draw")(draw_command.draw)
    app.command("markers")(markers_command.markers)
    app.add_typer(calibrate_commands.app, name="calibrate")


def _refuse() -> None:
    refuse_without("cv2", "OpenCV", "actum-command")
