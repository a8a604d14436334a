"""The site, built from the Markdown that GitHub shows: `make docs` writes it to `site/`.

Sphinx with Furo and MyST: strict about links, anchors and docstrings alike, without a network, and released this year.
MkDocs 1 is no longer; Material for MkDocs gives way to Zensical, which is at 0.1 and still changes its checks.
"""

from pathlib import Path

from sphinx.application import Sphinx

import actum

ROOT = Path(__file__).parents[1]

project = "actum"
copyright = "the actum authors"
version = release = actum.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]

# The source is the repository's root, so that a relative link is the same on GitHub and on the site.
root_doc = "README"
PAGES = [
    f"docs/{page}"
    for page in (
        *("start", "cameras", "objects", "teaching", "spotting", "page", "messages", "words"),
        *("operating", "settings", "commands", "two-machines", "containers", "restarts"),
        *("ros2", "ros4hri", "viewers", "som", "measured", "paper", "architecture"),
    )
]
RESULTS = {
    "Recognition": "benchmarks/recognition/results",
    "Recognition: what was tried": "benchmarks/recognition/README",
    "Recognition: what was tried on the second opinion": "benchmarks/recognition/opinion",
    "Recognition: what was tried on MSR": "benchmarks/recognition/msr",
    "Without marks": "benchmarks/continuous/results",
    "Without marks: what was tried": "benchmarks/continuous/README",
    "How postures go on": "benchmarks/continuation/results",
    "Objects": "benchmarks/objects/results",
    "Hands and objects": "benchmarks/bimacs",
    "Contacts foreseen": "benchmarks/intent/results",
    "Contacts foreseen: what was tried": "benchmarks/intent/README",
    "Cuts": "benchmarks/cutting",
    "Webcam": "benchmarks/camera/results",
    "Webcam, found live": "benchmarks/camera/continuous",
    "Webcam, corrected": "benchmarks/camera/correcting",
    "Webcam: what was tried": "benchmarks/camera/README",
    "The paper": "benchmarks/paper/results",
    "The paper: what was tried": "benchmarks/paper/README",
    "Marker tracker": "benchmarks/tracker/results",
    "Latency": "benchmarks/latency/results",
    "Many sensors": "benchmarks/many/results",
    "Latency and speed: what was tried": "benchmarks/latency/README",
    "Training: what was tried": "benchmarks/latency/training",
    "Maps": "benchmarks/som",
    "ROS4HRI: what was tried": "benchmarks/ros4hri/README",
}
PROJECT = ["deploy/README", "CONTRIBUTING", "CHANGELOG", "SECURITY"]
SECTIONS = {
    "Pages": PAGES,
    "Results": [f"{title} <{page}>" for title, page in RESULTS.items()],
    "Project": PROJECT,
}
include_patterns = [f"{page}.md" for page in (root_doc, *PAGES, *RESULTS.values(), *PROJECT)]
exclude_patterns = [".*", "site", "build", "dist", "shared", "services", "tests", "examples"]

default_role = "literal"  # docstrings write `name`
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings say shapes; spelt out, array-likes are long
autodoc_preserve_defaults = True
napoleon_use_ivar = True
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]
suppress_warnings = ["myst.header"]  # pages of results print theirs as they come

smartquotes_action = "De"  # dashes, no quotes: settings quote JSON

html_theme = "furo"
html_title = "actum"
html_baseurl = ""
html_show_sphinx = False
html_copy_source = False
html_static_path = ["style"]
html_css_files = ["wide.css"]
html_extra_path = ["front"]
templates_path: list[str] = []


def with_contents(_app: Sphinx, page: str, source: list[str]) -> None:
    """Add the list of pages, which GitHub's README has in its own words, to the first page; give all pages a title."""
    titles = {of: title for title, of in RESULTS.items()}
    if not source[0].startswith("# "):
        source[0] = f"# {titles[page]}\n\n{source[0]}"
    if page == root_doc:
        for caption, pages in SECTIONS.items():
            listed = "\n".join(pages)
            source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{listed}\n```\n"


def without_substitutions(
    _app: Sphinx, _what: str, _name: str, _of: object, _options: object, lines: list[str]
) -> None:
    """Let bars in a docstring's formulas be bars."""
    lines[:] = [
        line if "`" in line or line.lstrip().startswith((">>>", "...")) else line.replace("|", r"\|") for line in lines
    ]


def setup(app: Sphinx) -> None:
    """Register both."""
    app.connect("source-read", with_contents)
    app.connect("autodoc-process-docstring", without_substitutions)
