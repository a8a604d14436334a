"""`actum record`: streams to files."""

import threading
import time
from collections import Counter
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from actum import keys
from actum.atomic_file import UNFINISHED
from actum.messages import CUT, MANUAL
from actum.recorder import Recorder, TakenError, unfinished
from actum.recording import RecordingError
from actum.rewriting import finish as finished
from actum.rewriting import rewrite, unchanged
from actum.runtime import stop_on_signals
from actum_command.commands.recording_options import refuse_label, refuse_output
from actum_command.commands.service_flags import with_flags_of
from actum_command.commands.terminal import connect, fail, say
from actum_command.history.event_recorder import keep_events
from actum_command.segment_lines import cut_lines
from actum_command.service_settings import HISTORY, Given, arguments_of
from actum_command.streaming import store_all
from actum_examples.repetition_recorder import RepetitionRecorder
from actum_examples.stream_recorder import IMAGES, STREAMS, StreamRecorder

ALL = "all"
"""The value of `--marks` for every origin."""


@with_flags_of(HISTORY)
def record(  # noqa: PLR0913, PLR0917 - one parameter is one option
    output: Annotated[
        Path,
        typer.Argument(
            help=("the recording to write (.mcap); with --events, the folder to which the history is written")
        ),
    ],
    person: Annotated[
        str,
        typer.Option(
            help=(
                "name or number of the person who acts. The recording contains this name, so that a model can be "
                "tested on people on whom the model was not trained"
            )
        ),
    ] = "",
    label: Annotated[
        str | None,
        typer.Option(
            help=(
                "label, such as wave, for every action whose start and end are marked during the recording. Default: "
                "the label in the start mark"
            )
        ),
    ] = None,
    times: Annotated[
        int | None,
        typer.Option(
            min=1,
            help=(
                "number of times that the person will do the action that --label names. The command finds and labels "
                "each repetition, and stops after the last repetition"
            ),
        ),
    ] = None,
    marks: Annotated[
        str | None,
        typer.Option(
            help=(
                "origins of the start and end marks to store, separated by commas. manual: people and other programs. "
                "simulator: the simulated scene. replay: 'actum play'. auto: the classifier. all: all origins. "
                "Default: manual; with --times, only the marks that --times makes are stored"
            )
        ),
    ] = None,
    images: Annotated[bool, typer.Option(help="also store images. Images show faces, which are personal data")] = False,
    seconds: Annotated[
        float | None, typer.Option(min=0, help="length of the recording (s); default: until Ctrl-C")
    ] = None,
    finish: Annotated[
        bool,
        typer.Option(
            "--finish",
            help=(
                "record nothing, but turn the unfinished file OUTPUT.part into the recording OUTPUT. 'actum record' "
                "leaves the file OUTPUT.part if the command was killed or the disk was full"
            ),
        ),
    ] = False,
    events: Annotated[
        bool,
        typer.Option(
            "--events",
            help=(
                "run as a service that stores a history in the folder OUTPUT. The history contains events, start and "
                "end marks, and recognised actions, but no early predictions of actions"
            ),
        ),
    ] = False,
    *,
    given: Given,
) -> None:
    """Record a sensor's streams, and the start and end marks of actions, to a file for training or for playing again.

    No file is ever overwritten. If a recording was interrupted, run the command again with the same OUTPUT and
    --finish.

    With --events, the command runs as a service that stores a history of recognised actions in the folder OUTPUT.

    With --label and --times, the command labels the recording automatically. Example:

    actum record wave.mcap --label wave --times 5
    """
    if events:
        keep_events(output, arguments_of(HISTORY, given))
        return
    if finish:
        _finish(output)
        return
    refuse_output(output)
    _refuse_labelling(label, times)
    stop = stop_on_signals()
    deadline_s = time.monotonic() + (seconds if seconds is not None else float("inf"))
    try:
        with connect() as client, Recorder(output, person=person, source=client.sensor) as recorder:
            topics = STREAMS | IMAGES if images else STREAMS
            stream = StreamRecorder(recorder, topics, label, _origins(marks, times))
            listening = [
                client.listen_back(keys.pattern(topic, client.sensor), 0.0) for topic in keys.TOPICS if topic in topics
            ]
            say(f"recording actum/{client.sensor}/** to {output}; Ctrl-C ends")
            storing = stream if times is None or label is None else _repeating(stream, label, times, stop)
            store_all(listening, storing, stop, deadline_s)
    except TakenError as error:
        fail(str(error))
    except OSError as error:
        _fail_unfinished(output, error)
    _report(stream, output, label)
    if isinstance(storing, RepetitionRecorder):
        _report_cuts(storing, output)


def _refuse_labelling(label: str | None, times: int | None) -> None:
    """Fail before the recording where it could not be labelled as asked."""
    if label is not None:
        refuse_label(label)
    elif times is not None:
        fail("--times needs the name of the repeated action: add --label NAME")


def _fail_unfinished(output: Path, error: OSError) -> NoReturn:
    """Fail, naming what was stored before the error and what to do with it."""
    left = (
        f"; the messages stored before this error are in {unfinished(output)}: turn this file into a recording with "
        f"'actum record {output} --finish'"
    )
    fail(f"{output} cannot be written ({error.strerror})" + (left if unfinished(output).exists() else ""))


def _finish(output: Path) -> None:
    """Make a recording of what was left unfinished under a name, which may be given with or without its suffix."""
    output = output.with_suffix("") if output.suffix == UNFINISHED else output
    try:
        count = finished(output)
    except FileNotFoundError:
        fail(
            f"there is no unfinished recording {unfinished(output)}: give the name of a recording that was interrupted"
        )
    except RecordingError as error:
        fail(
            f"{error.path} cannot be turned into a recording ({error.problem}) and was not changed: move or delete "
            "this file"
        )
    except TakenError as error:
        fail(str(error))
    except OSError as error:
        fail(
            f"{output} cannot be written ({error.strerror}): solve this problem, then use --finish again; "
            f"{unfinished(output)} was not changed"
        )
    say(f"{count} messages, all that are complete in the unfinished file, written to {output}")


def _origins(marks: str | None, times: int | None) -> list[str] | None:
    """Return the origins of the marks to store, None for all."""
    if marks == ALL:
        return None
    named = MANUAL if marks is None and times is None else marks or ""
    return [origin.strip() for origin in named.split(",") if origin.strip()] + ([CUT] if times is not None else [])


def _repeating(stream: StreamRecorder, label: str, times: int, stop: threading.Event) -> RepetitionRecorder:
    """Tell the person what to do, and return what counts it and stops at the end."""
    say(f"do {label!r} {times} times and stand still for a second or two before each; stand still at the end", "bold")

    def done() -> None:
        if not stop.is_set():
            say("that was the last: stopping")
        stop.set()

    return RepetitionRecorder(stream, label, times, lambda count: say(f"{count} of {times}"), done)


def _report_cuts(repeating: RepetitionRecorder, output: Path) -> None:
    """Print the cuts, what may be wrong with them, and how to mend it."""
    if repeating.lacks_some:
        _exclude(output)
        say(
            "training leaves this recording out, because it would learn the missing repetitions as background; once "
            "you have labelled them with 'actum label', train with --all",
            style="yellow",
        )
    if repeating.cuts is None or repeating.counter.first_ns is None:
        why = repeating.counter.why_none
        say(f"no repetition was found in the recording: {why}, and record the action again", style="red")
        return
    for line in cut_lines(repeating.cuts, repeating.counter.first_ns):
        say(line)
    for doubt in repeating.cuts.doubts:
        say(doubt, style="yellow")
    say(
        f"to look at the repetitions: actum label picture {output} -o {output.with_suffix('.png')}; to correct them: "
        "actum label --help"
    )


def _exclude(output: Path) -> None:
    """Have training leave a recording out; fail where that cannot be stored, for training would use it."""
    try:
        rewrite(output, unchanged, metadata={"excluded": "true"})
    except OSError as error:
        fail(
            f"repetitions are missing in {output}, and the recording could not be marked as excluded "
            f"({error.strerror}), so training would learn the missing repetitions as background: delete {output}"
        )


def _report(stream: StreamRecorder, output: Path, label: str | None) -> None:
    """Print the counts of stored messages and marks, and warnings about those that are missing."""
    say(f"{stream.stored} messages, {stream.actions.total()} marked actions, written to {output}")
    for (origin, named), count in stream.actions.items():
        say(f"  {count} marked by {origin}, {'without a label' if named is None else f'labelled {named!r}'}")
    if stream.unended:
        say(
            f"  marked without an end, so training does not use them: {', '.join(sorted(stream.unended))}",
            style="yellow",
        )
    for origin, count in (+stream.left_out).items():
        say(f"  {count} marked by {origin} not stored: to store them, use --marks {origin} or --marks {ALL}")
    if stream.counters.rejects:
        say(f"not stored: {_listed(stream.counters.rejects)} (the last: {stream.counters.last_error})", style="yellow")
    if stream.undecodable:
        say(f"not decodable: {stream.undecodable.total()} ({_listed(stream.undecodable)})", style="yellow")
    if not stream.stored:
        say("nothing was stored: check with 'actum doctor' that a gateway runs for this sensor", style="yellow")
    elif label is not None and not stream.actions:
        say(f"no action was marked, so nothing is labelled {label!r}: mark with 'actum segment toggle'", style="yellow")


def _listed(counts: Counter[str]) -> str:
    return ", ".join(f"{kind} {count}" for kind, count in sorted(counts.items()))
