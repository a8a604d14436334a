"""`actum`, or `python -m actum_command`."""

import os
from typing import Annotated

from actum import __version__
from actum.runtime import end_with_parent, needs_extra

with needs_extra("actum-command"):
    import typer

    from actum_command import (
        calibrating,
        demo,
        doctor,
        drawing,
        import_commands,
        inspecting,
        learning,
        marker_sheets,
        marks,
        models,
        scene,
        streaming,
        system,
        takes_commands,
        watching,
    )
    from actum_command.context import connect, console, say
    from actum_command.misspelt import misspelt
    from actum_command.plain_help import PlainTyper

app = PlainTyper(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Online recognition of what a person does and to which object. ACTUM_CONNECT names the router, "
    "ACTUM_SENSOR the viewpoint.",
)


def _show_version(asked: bool) -> None:
    if asked:
        say(f"actum {__version__}")
        raise typer.Exit


@app.callback()
def _actum(
    _version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_show_version, help="print the version and end")
    ] = False,
) -> None:
    """Take what goes before every command."""


app.command("demo")(demo.demo)
app.command("up")(system.up)
app.command("router")(system.router)
app.add_typer(marks.app, name="segment")
app.command("record")(streaming.record)
app.command("play")(streaming.play)
app.add_typer(takes_commands.app, name="takes")
app.add_typer(import_commands.app, name="import")
app.add_typer(models.app, name="models")
app.command("draw")(drawing.draw_command)
app.command("markers")(marker_sheets.markers)
app.add_typer(calibrating.app, name="calibrate")
app.command("train")(learning.train_command)
app.command("evaluate")(learning.evaluate_command)
app.command("inspect")(inspecting.inspect_command)
app.command("simulate")(scene.simulate)
app.command("scene")(scene.scene)
app.command("watch")(watching.watch)


@app.command("doctor")
def diagnose() -> None:
    """Check router, services, rates, versions and the names of settings; exit 1 if anything is wrong."""
    with connect() as client:
        findings = doctor.examine(client)
    doctor.show(findings, console)
    problems = [*misspelt(os.environ), *(problem for finding in findings for problem in finding.problems)]
    for problem in problems:
        say(problem, style="red")
    if problems:
        raise typer.Exit(1)
    console.print("[green]all services are there, alive and of one version[/green]")


def main() -> None:
    """Run the command line."""
    end_with_parent()
    app()


if __name__ == "__main__":
    main()
