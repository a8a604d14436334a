"""A page of results: parts that are measured one after the other, printed as they come, and kept."""

import argparse
import platform
import sys
import tempfile
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import TypeVar

Data = TypeVar("Data")


def part_asked_for(program: str, about: str | None, parts: Collection[str]) -> str | None:
    """Read from the command line which part alone is to be measured, None where it is all of them."""
    parser = argparse.ArgumentParser(prog=program, description=about)
    parser.add_argument("--only", choices=parts, help="measure this part and leave the page as it is")
    only: str | None = parser.parse_args().only
    return only


def versions_of(*libraries: str) -> str:
    """Return the versions of Python and of some libraries."""
    return ", ".join([f"Python {platform.python_version()}", *(f"{name} {version(name)}" for name in libraries)])


def printed(header: Iterable[str], parts: Iterable[str], measure: Callable[[str], str]) -> str:
    """Measure the parts, print each as it comes, and return the page."""
    began_s, written = time.perf_counter(), ["\n\n".join(header)]
    print(written[0], flush=True)
    for part in parts:
        written.append(measure(part))
        print(f"\n{written[-1]}", flush=True)
        print(f"{part}: {time.perf_counter() - began_s:.0f} s since the start", file=sys.stderr, flush=True)
    return "\n\n".join(written) + "\n"


def measure_page(
    page: Path, only: str | None, header: Iterable[str], parts: Iterable[str], measure: Callable[[str], str]
) -> None:
    """Measure all parts and write the page, or one alone and leave the page as it is."""
    if only:
        printed(header, [only], measure)
    else:
        page.write_text(printed(header, parts, measure))


def measure_sections(
    page: Path,
    about: str | None,
    header: Iterable[str],
    sections: Mapping[str, tuple[str, Callable[[Data], Iterable[str]]]],
    data_in: Callable[[Path], Data],
) -> None:
    """Measure what the command line asks for: titled sections, with data that are made in a folder for a while."""
    only = part_asked_for(f"benchmarks.{page.parent.name}", about, sections)
    with tempfile.TemporaryDirectory() as folder:
        data = data_in(Path(folder))

        def section(part: str) -> str:
            title, measure = sections[part]
            return "\n\n".join([f"## {title}", *measure(data)])

        measure_page(page, only, header, sections, section)
