"""The corrections as a page of its own."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from analysis import keys
from analysis.corrections import stage
from analysis.store import Document, write_text

PAGE = "corrections.html"


def make(folder: Path) -> Path:
    """Write the page of the document in a folder; returns where it is."""
    from analysis import page
    from analysis.corrections import section

    document = stage.load(folder)
    page.provide_script(folder)
    body = ["<header>\n<h1>Corrections</h1>\n</header>", section.section(document)]
    write_text(folder / PAGE, page.document("Corrections", inputs(document), body, page.SCRIPT))
    return folder / PAGE


def inputs(document: Document | None) -> str:
    """A hash of what the section is made from."""
    answers = json.dumps(document, sort_keys=True)
    return hashlib.sha256(f"{answers} {keys.report_code()}".encode()).hexdigest()
