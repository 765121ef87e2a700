"""Pages of set-ups that are not cases of the study: those of the corrections and of the published table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from analysis.pipeline import keys
from analysis.report import page
from analysis.report.page import is_current
from analysis.results.store import Document, write_text
from analysis.study import questions
from analysis.topics.corrections import cases_section
from analysis.topics.published import section as published_section, table as published

_SCRIPT = f"../{Path(page.SCRIPT).name}"


@dataclass(frozen=True)
class SetUpsPage:
    """`file` is in the folder of the report's pages, `inputs` a hash of what the page is made from, `text` makes it."""

    file: str
    inputs: str
    text: Callable[[str], str]


def pages(corrected: Document | None) -> list[SetUpsPage]:
    """Returns the pages that can be made; `corrected` is the document of the corrections."""

    def of_published(inputs: str) -> str:
        return published_section.set_ups_document(*_back(questions.PUBLISHED), inputs, _SCRIPT)

    table = keys.page_inputs(published.digest())
    found = [SetUpsPage(questions.PUBLISHED_SET_UPS, table, of_published)]
    if corrected is not None:
        cases, back = corrected["cases"], _back(questions.CORRECTIONS)

        def of_corrections(inputs: str) -> str:
            return cases_section.set_ups_document(cases, *back, inputs, _SCRIPT)

        inputs = keys.page_inputs(corrected)
        found.append(SetUpsPage(questions.CORRECTIONS_SET_UPS, inputs, of_corrections))
    return found


def write(corrected: Document | None, place: Path) -> None:
    """Writes those that are not up to date into the folder of the report's pages."""
    for each in pages(corrected):
        if not is_current(place / each.file, each.inputs):
            write_text(place / each.file, each.text(each.inputs))


def _back(name: str) -> tuple[str, str]:
    """Returns the page of a question as seen from that of its set-ups, and its title."""
    (title,) = (question.title for question in questions.QUESTIONS if question.name == name)
    return f"../{name}.html", title
