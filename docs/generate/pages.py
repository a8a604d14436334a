"""Pages with generated parts: what stands between `<!-- generated: NAME -->` and `<!-- end -->`."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from docs.generate import fields, reasons, rejects, roles, settings

from actum.installing import pip_install

DOCS = Path(__file__).parents[1]
PAGES = (*sorted(DOCS.glob("*.md")), *(DOCS.parent / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")))
PARTS: Mapping[str, Callable[[], str]] = {
    "fields": fields.sections,
    "event": fields.shown_event,
    "rejects": rejects.rejects_table,
    "reasons": reasons.reasons_table,
    "absences": reasons.absences_table,
    "settings": settings.sections,
    "roles": roles.roles_table,
}
INSTALLING = re.compile(r"pip install (-e )?(['\"])[\w./-]+\[([\w,-]+)\]\2")
"""How this package is installed, as a page says it: the flag, and the extras."""
PART = re.compile(r"(<!-- generated: (\w+) -->\n).*?(<!-- end -->)", re.S)


def renewed(text: str) -> str:
    """Return a page with its generated parts made anew, and how this package is installed."""
    text = INSTALLING.sub(lambda found: pip_install(found[3], flag=found[1] or ""), text)
    return PART.sub(lambda part: f"{part[1]}\n{PARTS[part[2]]()}\n{part[3]}", text)
