"""Comparison of what a package gives for a broad input with values that somebody approved.

Long results are summed up: of each series of numbers its length, mean, root mean square, and a sum with weights that
change from number to number, so that the order counts too. `pytest tests/approvals --approve` writes the files anew.
"""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from pydantic import BaseModel

FOLDER = Path(__file__).parent / "approvals"
MOST_TEXTS = 12
"""Different texts of a series that are counted one by one."""
MOST_SHOWN = 12
"""Differences that a failure prints."""
SMALLEST = 1e-9
"""Numbers below are 0: processors round them differently."""
NO_FIELDS: Mapping[str, float] = MappingProxyType({})
Leaves = dict[str, Any]
Approve = Callable[..., None]


def leaves(value: object, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the numbers and texts of a value with their paths; elements of a list share their list's path."""
    match value:
        case np.ndarray() | np.generic() | str() | None | bool() | int() | float():
            yield path, value
        case bytes():  # compressed pictures, whose length depends on the library
            yield path, bool(value)
        case [float(), *_] if all(isinstance(each, float) for each in value):
            yield path, np.array(value)
        case _ if (named := fields_of(value)) is not None:
            for name, each in named.items():
                yield from leaves(each, f"{path}.{name}")
        case Iterable():
            for each in value:
                yield from leaves(each, path)
        case _:
            yield path, type(value).__name__


def fields_of(value: object) -> Mapping[str, object] | None:
    """Return the fields of a message, a mapping, or an object that names its fields; None for all else."""
    match value:
        case Mapping():
            return value
        case BaseModel():
            return {name: getattr(value, name) for name in type(value).model_fields}
        case _ if is_dataclass(value):
            return {field.name: getattr(value, field.name) for field in fields(value)}
        case tuple(_asdict=as_dict):
            return as_dict()
        case object(__slots__=names):
            return {name: getattr(value, name) for name in names}
    return None


def summary(value: object) -> Leaves:
    """Sum up each series of a value, by its path."""
    numbers: dict[str, list[Any]] = {}
    texts: dict[str, Counter[str]] = {}
    for path, leaf in leaves(value):
        if leaf is None or isinstance(leaf, str | bool | np.bool_):
            texts.setdefault(path, Counter())[str(leaf)] += 1
        else:
            numbers.setdefault(path, []).append(np.ravel(leaf).astype(float))
    summed: Leaves = {path.lstrip("."): _moments(np.concatenate(parts)) for path, parts in numbers.items()}
    for path, counts in texts.items():
        few = len(counts) <= MOST_TEXTS
        shown = next(iter(counts)) if counts.total() == 1 else dict(sorted(counts.items()))
        summed[f"{path} texts".strip(" .")] = shown if few else {"different": len(counts)}
    return dict(sorted(summed.items()))


def _moments(series: np.ndarray) -> list[float]:
    finite = np.nan_to_num(series, posinf=0.0, neginf=0.0)
    weighted = float(finite @ np.cos(np.arange(len(finite)))) / max(len(finite), 1)
    known = int(np.isfinite(series).sum())
    return [
        len(series),
        known,
        *(_short(each) for each in (finite.mean(), np.sqrt(np.square(finite).mean()), weighted)),
    ]


def _short(number: float) -> float:
    return float(f"{number:.9g}") if abs(number) > SMALLEST else 0.0


def check(
    name: str, value: object, tolerance: float = 1e-6, besides: Mapping[str, float] = NO_FIELDS, *, renew: bool
) -> None:
    """Compare with the file of that name, or write it.

    Numbers may differ by a share of their series' root mean square: `besides` gives that of fields with another.
    """
    file, found = FOLDER / f"{name}.json", summary(value)
    if renew:
        lines = (f"  {json.dumps(path)}: {json.dumps(each, ensure_ascii=False)}" for path, each in found.items())
        file.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    approved = json.loads(file.read_text(encoding="utf-8"))
    wrong = [
        f"{path}: {json.dumps(found.get(path))}, approved was {json.dumps(approved.get(path))}"
        for path in sorted({*found, *approved})
        if not _alike(found.get(path), approved.get(path), besides.get(path.rpartition(".")[2], tolerance))
    ]
    more = [f"and {len(wrong) - MOST_SHOWN} more"] if len(wrong) > MOST_SHOWN else []
    told = "\n".join(["(length, known, mean, root mean square, weighted mean)", *wrong[:MOST_SHOWN], *more])
    assert not wrong, f"{file.name} approved other values: `pytest tests/approvals --approve` approves these.\n{told}"


def _alike(one: Any, other: Any, tolerance: float) -> bool:
    if not (isinstance(one, list) and isinstance(other, list)):
        return bool(one == other)
    return one[:2] == other[:2] and np.allclose(one[2:], other[2:], rtol=0, atol=tolerance * other[3] + SMALLEST)
