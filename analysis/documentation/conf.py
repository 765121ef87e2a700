"""Sphinx: the repository's own notes, the pages in this folder and the Python modules' docstrings as one site."""

import sys
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(_ROOT), str(_ROOT / "build" / "python")]

project = "fringe"
extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "analysis/documentation/index"
# Relative to the root of the repository, which is Sphinx' source folder: links between the notes stay as they are.
include_patterns = [
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "README.md",
    "analysis/*.md",
    "analysis/**/*.md",
    "fem_reference/*.md",
    "geometries/*.md",
    "geometries/schemas/*.md",
    "model/*.md",
    "model/examples/*.md",
]
html_theme = "furo"
html_title = "fringe: documentation"
html_show_copyright = False
autodoc_default_options = {"members": True}
autodoc_typehints = "description"
myst_enable_extensions = ["dollarmath"]
# Links to headings, as GitHub makes them.
myst_heading_anchors = 3
# Links to folders, studies and source files work on the disk; the site has no pages of them.
suppress_warnings = ["myst.xref_missing", "myst.header"]
