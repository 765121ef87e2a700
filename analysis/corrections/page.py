"""The corrections as a page of its own."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from analysis import keys
from analysis.corrections import stage
from analysis.store import Document, write_text

PAGE, SET_UPS = "corrections.html", "set_ups.html"
_TITLE = "Corrections"


def make(folder: Path) -> Path:
    """Write the page of the document in a folder; returns where it is."""
    from analysis import page
    from analysis.corrections import section

    document = stage.load(folder)
    page.provide_script(folder)
    body = [f"<header>\n<h1>{_TITLE}</h1>\n</header>", section.section(document, SET_UPS)]
    write_text(folder / PAGE, page.document(_TITLE, inputs(document), body, page.SCRIPT))
    if document is not None:
        make_set_ups(document, folder / SET_UPS, PAGE, _TITLE, page.SCRIPT)
    return folder / PAGE


def make_set_ups(document: Document, target: Path, back: str, back_title: str, script: str) -> None:
    """Write the page that shows the document's set-ups. `back` is the page that leads to it, with its title; `script` the file of
    plotly.js, both as seen from it."""
    from analysis.corrections import cases_section

    text = cases_section.set_ups_document(document["cases"], back, back_title, inputs(document), script)
    write_text(target, text)


def inputs(document: Document | None) -> str:
    """A hash of what the section is made from."""
    answers = json.dumps(document, sort_keys=True)
    return hashlib.sha256(f"{answers} {keys.report_code()}".encode()).hexdigest()
