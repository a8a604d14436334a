"""A page of results: parts that are measured one after the other, printed as they come, and kept."""

import argparse
import sys
import time
from collections.abc import Callable, Collection, Iterable
from pathlib import Path


def part_asked_for(program: str, about: str | None, parts: Collection[str]) -> str | None:
    """Read from the command line which part alone is to be measured, None where it is all of them."""
    parser = argparse.ArgumentParser(prog=program, description=about)
    parser.add_argument("--only", choices=parts, help="measure this part and leave the page as it is")
    only: str | None = parser.parse_args().only
    return only


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
