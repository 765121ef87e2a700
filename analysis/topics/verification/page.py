"""The verification as sections of reports, and as a page of its own."""

from __future__ import annotations

from pathlib import Path

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import page
from analysis.results.store import Document, write_text
from analysis.topics.verification import cost_section, records, section, stage, widths, widths_section

PAGE = "verification.html"
_INTRODUCTION = "Is the field reference right, are its stated errors right, and what does it cost? One command computes every number of this page."


def beside(results: Path) -> Path:
    """Returns the folder of the verification that belongs to a study's results."""
    return results.resolve().parent / stage.FOLDER


def truths(rows: dict[str, Document]) -> Markup:
    """Returns the chapter on known capacitances; one sentence without rows."""
    if not rows:
        return section.chapter([], [], [])
    names = stage.row_names()
    ordered = _ordered(rows)
    missing = [name for name in names if name not in rows]
    return section.chapter(records.compared(ordered), records.held(ordered), missing)


def costs(rows: dict[str, Document]) -> Markup:
    """Returns the section on the reference's run times; empty without rows."""
    if not rows:
        return Markup("")
    from analysis.topics.verification.set_ups import cost_cases

    asked = [
        records.Asked(case.name, case.caption, case.targets, case.truth, case.truth_error)
        for case in cost_cases().values()
    ]
    ordered = _ordered(rows)
    found = [cost for cost in (records.cost(ordered, case) for case in asked) if cost is not None]
    return cost_section.section(found) + widths_section.section(widths.stored())


def _ordered(rows: dict[str, Document]) -> dict[str, Document]:
    return {name: rows[name] for name in stage.row_names() if name in rows}


def make(folder: Path) -> page.Made:
    """Writes the page of the rows in a folder."""
    rows = stage.load(folder)
    title = "Verification of the field reference"
    body = [
        page.header(title, page.paragraph(_INTRODUCTION)),
        truths(rows),
        costs(rows),
    ]
    page.provide_script(folder)
    write_text(folder / PAGE, page.document(title, keys.page_inputs(rows), body, page.SCRIPT))
    found = records.compared(rows)
    headline = section.finding(found) if found else section.ABSENT
    return page.Made(folder / PAGE, headline)
