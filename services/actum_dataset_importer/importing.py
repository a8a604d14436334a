"""Turns public skeleton sets and video clips into recordings."""

from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from pathlib import Path

from actum.limits import MAX_SKEW_NS
from actum.recorder import refuse_taken, write_recording
from actum_dataset_importer import bimacs, msr_action3d, msrc12, utkinect
from actum_dataset_importer.bimacs import HandsTake
from actum_dataset_importer.clips import Naming, check_names, clip_files, read_clip, recording_name
from actum_dataset_importer.msrc12_composed import STREAMS, composed
from actum_dataset_importer.msrc12_cuts import trimmed
from actum_dataset_importer.takes import Take
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Estimator
from sensor_gateway.perceiver import OTHER_SIZE

SENSOR = "kinect0"
"""The services' default sensor: such recordings can be played without a flag."""
MOST_NAMES = 12
"""Most actions or persons that the report lists: they fit some lines of a terminal."""
Progress = Callable[[int, int], None]
"""Called after each file with how many are done and how many there are."""

ODDITIES = {
    utkinect.DUPLICATE_ROW: "duplicate rows removed",
    utkinect.OVERLAPPING_PAIR: "pairs of overlapping segments, both kept",
    OTHER_SIZE: "frames of another size than the calibration's: no people are detected in them",
}
"""The report's words for each kind of `Take.oddities`."""


@dataclass
class ImportReport:
    """Counts of what an import wrote and found; as text, one line each."""

    files: int = 0
    frames: int = 0
    invalid_frames: int = 0
    segments: int = 0
    excluded: int = 0
    actions: set[str] = field(default_factory=set)
    persons: set[str] = field(default_factory=set)
    skipped: list[str] = field(default_factory=list)
    outside: list[str] = field(default_factory=list)
    oddities: Counter[str] = field(default_factory=Counter)

    def add(self, take: Take | HandsTake) -> None:
        """Count one written take."""
        self.files += 1
        self.persons.add(take.person)
        starts = [mark for mark in take.marks if mark.kind == "start"]
        self.segments += len(starts)
        self.actions |= {mark.label for mark in starts if mark.label}
        self.skipped += take.skipped
        if isinstance(take, HandsTake):
            self.frames += len(take.postures)
            return
        self.frames += len(take.frames)
        self.invalid_frames += sum(not frame.valid or not frame.agents for frame in take.frames)
        self.excluded += "excluded" in take.metadata
        self.oddities += take.oddities

    def lines(self) -> list[str]:
        """Return the report's lines."""
        lines = [
            f"{self.files} recordings, {self.frames} frames, {self.segments} labelled segments",
            f"{_listed(self.actions, 'actions')}; {_listed(self.persons, 'persons')}",
            f"{self.invalid_frames} frames without a skeleton, kept without people",
        ]
        if self.excluded:
            lines.append(
                f"{self.excluded} recordings marked as excluded: training skips them unless it runs with --all"
            )
        if self.skipped:
            lines.append(f"{len(self.skipped)} segments without bounds skipped: {', '.join(self.skipped)}")
        if self.outside:
            lines.append(f"{len(self.outside)} segments outside of the frames skipped: {', '.join(self.outside)}")
        return lines + [f"{self.oddities[kind]} {words}" for kind, words in ODDITIES.items() if self.oddities[kind]]

    def __str__(self) -> str:
        return "\n".join(self.lines())


def _listed(names: set[str], what: str) -> str:
    first = ", ".join(sorted(names)[:MOST_NAMES])
    return f"{len(names)} {what}: {first}{', …' if len(names) > MOST_NAMES else ''}"


def import_msr_action3d(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Write one recording per sequence, `out/a01_s01_e01.mcap`.

    Raises:
        DatasetError: `src` does not hold the set, or a file of it is damaged.
    """
    files = msr_action3d.sequence_files(src)
    takes = (msr_action3d.read_sequence(file, SENSOR) for file in files)
    return import_takes("msr-action3d", takes, len(files), out, progress)


def import_utkinect(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Write one recording per continuous recording with its labelled segments, `out/s01_e01.mcap`.

    Raises:
        DatasetError: `src` does not hold the set with its corrected labels, or a file of it is damaged.
    """
    files = utkinect.recording_files(src)
    labels = utkinect.read_labels(src)
    takes = (utkinect.read_labelled(file, SENSOR, labels) for file in files)
    return import_takes("utkinect", takes, len(files), out, progress)


def import_msrc12(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Write one recording per stream with a labelled segment about each action point, `out/P1_1_10A_p01.mcap`.

    Raises:
        DatasetError: `src` does not hold the set, or a file of it is damaged.
    """
    streams = msrc12.stream_names(src)
    takes = (msrc12.read_stream(file, name, SENSOR) for file, name in streams)
    return import_takes("msrc12", takes, len(streams), out, progress)


def import_msrc12_trimmed(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Write one recording per stream, each repetition a segment from where it starts to where it ends.

    Raises:
        DatasetError: `src` does not hold the set, or a file of it is damaged.
    """
    names = msrc12.stream_names_by_file(src)
    takes = (take for file, of_file in names.items() for take in trimmed(file, of_file, SENSOR))
    return import_takes("msrc12", takes, sum(map(len, names.values())), out, progress)


def import_msrc12_composed(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Write two recordings per person in which they do all gestures in mixed order, `out/composed_p01_1.mcap`.

    Raises:
        DatasetError: `src` does not hold the set, a file of it is damaged, or its gestures cannot be mixed.
    """
    names = msrc12.stream_names_by_file(src)
    takes = (take for file, of_file in names.items() for take in composed(file, of_file, SENSOR))
    return import_takes("msrc12", takes, STREAMS * len(names), out, progress)


def import_bimacs(src: Path, out: Path, progress: Progress) -> ImportReport:
    """Write one recording per take of hands and objects, `out/subject0_take0.mcap`.

    Raises:
        DatasetError: `src` does not hold the takes with their labels, or a file is damaged.
    """
    files = bimacs.take_files(src)
    report = ImportReport()
    for file in files:
        take = bimacs.read_take(file, SENSOR)
        write_recording(out / f"{take.name}.mcap", take.messages(), person=take.person, source="bimacs")
        report.add(take)
        progress(report.files, len(files))
    return report


def import_video(
    src: Path,
    out: Path,
    progress: Progress,
    *,
    naming: Naming,
    optics: Optics,
    opened: Callable[[], AbstractContextManager[Estimator]],
) -> ImportReport:
    """Write one recording per clip, the whole of it one segment labelled by its name; no image is kept.

    Raises:
        DatasetError: there is no clip, one's name or content is not of that form, or two have the same name.
        OSError: a recording cannot be written, or lies there already.
    """
    files = clip_files(src)
    check_names(files)
    for file in files:
        naming.read(file)
        refuse_taken(out / f"{recording_name(file)}.mcap")
    takes = (read_clip(file, naming, SENSOR, optics, opened) for file in files)
    return import_takes("video", takes, len(files), out, progress)


def import_takes(source: str, takes: Iterable[Take], total: int, out: Path, progress: Progress) -> ImportReport:
    """Write one recording per take, `out/NAME.mcap`, with `source` in its metadata.

    Raises:
        OSError: one cannot be written, or lies there already.
    """
    report = ImportReport()
    for given in takes:
        stamps_ns = [frame.stamp_ns for frame in given.frames]
        first_ns, last_ns = min(stamps_ns, default=0) - MAX_SKEW_NS, max(stamps_ns, default=0) + MAX_SKEW_NS
        outside = sorted({mark.segment_id for mark in given.marks if not first_ns <= (mark.stamp_ns or 0) <= last_ns})
        take = replace(given, marks=[mark for mark in given.marks if mark.segment_id not in outside])
        report.outside += [f"{take.name} {segment_id}" for segment_id in outside]
        file = out / f"{take.name}.mcap"
        write_recording(file, (*take.frames, *take.marks), person=take.person, source=source, **take.metadata)
        report.add(take)
        progress(report.files, total)
    return report
