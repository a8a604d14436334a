"""Pages with generated parts: what stands between `<!-- generated: NAME -->` and `<!-- end -->`."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from docs.generate import fields, reasons, rejects, roles, settings

DOCS = Path(__file__).parents[1]
PAGES = (DOCS / "messages.md", DOCS / "operating.md", DOCS.parent / "SECURITY.md")
PARTS: Mapping[str, Callable[[], str]] = {
    "fields": fields.sections,
    "rejects": rejects.rejects_table,
    "reasons": reasons.reasons_table,
    "absences": reasons.absences_table,
    "settings": settings.sections,
    "roles": roles.roles_table,
}
PART = re.compile(r"(<!-- generated: (\w+) -->\n).*?(<!-- end -->)", re.S)


def renewed(text: str) -> str:
    """Return a page with its generated parts made anew."""
    return PART.sub(lambda part: f"{part[1]}\n{PARTS[part[2]]()}\n{part[3]}", text)
