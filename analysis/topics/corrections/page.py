"""The corrections as a page of its own."""

from __future__ import annotations

from pathlib import Path

from analysis.pipeline import keys
from analysis.report import page
from analysis.results.store import write_text
from analysis.topics.corrections import cases_section, section, stage

PAGE, SET_UPS = "corrections.html", "set_ups.html"
_TITLE = "Corrections"


def make(folder: Path) -> Path:
    """Writes the page of the document in a folder; returns where it is."""
    document = stage.load(folder)
    page.provide_script(folder)
    body = [page.header(_TITLE), section.section(document, SET_UPS)]
    write_text(folder / PAGE, page.document(_TITLE, keys.page_inputs(document), body, page.SCRIPT))
    if document is not None:
        text = cases_section.set_ups_document(
            document["cases"], PAGE, _TITLE, keys.page_inputs(document), page.SCRIPT
        )
        write_text(folder / SET_UPS, text)
    return folder / PAGE
