"""`report.html`: the summary of a study, with a link to the page of every question."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from analysis.report import drawing, page
from analysis.report.drawing import thumbnail
from analysis.results import table
from analysis.results.study_results import CaseResult, Results
from analysis.results.table import Row
from analysis.results.units import percent, too
from geometries.studies.machines import NONE

_FINDING = re.compile(r'<p class="finding">(.*?)</p>', re.DOTALL)
_PARAGRAPH = re.compile(r"<p[^>]*>(.*?)</p>", re.DOTALL)
_ON_A_MACHINE = "On a machine"
_WHERE = {
    "parallel": "Facing a plate",
    "inclined": "Facing an inclined plate",
    "edge": "Beside an edge",
    "corner": "Off a corner",
    "straddle": "Partly over an edge",
    "sensors": "Two sensors side by side",
    "box": "Facing a box",
}
"""Where the target of a family is, as seen from the sensor."""
_FEWEST = 10
"""Points that a figure has at least for its thumbnail to be recognized."""


@dataclass(frozen=True)
class Card:
    """A page's entry in the index: `target` relative to the index, `says` the page's first finding, `picture` a thumbnail or empty. `own`
    is false for a page on other set-ups than the study's."""

    target: str
    title: str
    says: str | Markup
    picture: str | Markup = ""
    own: bool = True


@dataclass(frozen=True)
class Picture:
    """A picture that leads to a page, relative to the index; `words` stand below it."""

    target: str
    drawn: str | Markup
    words: str = ""


@dataclass(frozen=True)
class Answer:
    """What the first screen says of a question: one sentence, with pictures."""

    question: str
    says: str
    pictures: list[Picture]


def first_finding(text: Markup) -> Markup:
    """Returns the first finding in a page's body, or its first paragraph where nothing was found out."""
    found = _FINDING.search(text) or _PARAGRAPH.search(text)
    return Markup(found[1] if found else "")


def first_picture(text: Markup, title: str) -> Markup:
    """Returns a thumbnail of the first figure of a page's body that has enough points, or else of the first figure; empty without any."""
    drawn = [thumbnail(data, layout, title) for data, layout in page.figures_of(text)]
    rich = [each for each in drawn if each.count("<circle") + each.count("<rect") >= _FEWEST]
    return next(iter(rich + [each for each in drawn if each]), Markup(""))


def how_wrong(results: Results, rows: list[Row], cases: str) -> list[Answer]:
    """Returns how wrong the model is in each family of a study, and on machines, with a drawing of each, which leads to a case that
    has the potential around it, if any has. `cases` is the folder of the cases as seen from the index."""
    places: dict[str, dict[str, list[CaseResult]]] = {}
    for case in results.compared():
        machine = str(case.parameters.get("machine", NONE))
        alone = _WHERE.get(case.family, str(case.parameters.get("scene", case.family)))
        where = alone if machine == NONE else _ON_A_MACHINE
        words = "" if machine == NONE else f"{case.family}, {machine.replace('+', ' and ')}"
        places.setdefault(where, {}).setdefault(words, []).append(case)
    return [
        Answer(
            where,
            _how_wrong([case.id for own in kinds.values() for case in own], rows),
            [
                Picture(
                    f"{cases}/{shown.id}/{page.CASE_PAGE}", drawing.of_scene(shown.scene, shown.name), words
                )
                for words, own in kinds.items()
                for shown in [next((case for case in own if case.slice), own[0])]
            ],
        )
        for where, kinds in places.items()
    ]


def _how_wrong(cases: list[str], rows: list[Row]) -> str:
    """Tells the model's error in the change of a reading, or in the charge on the target where no change is known."""
    own = [row for row in table.compared(rows) if row.case.id in cases]
    changes = [row for row in own if row.is_change]
    errors = np.array([row.model_error for row in changes or own])
    if not errors.size:
        return "The model has no answer here."
    worst = too(float(errors[np.argmax(np.abs(errors))]))
    what = "The model's change of the reading is" if changes else "The model's charge on the target is"
    if len(errors) == 1:
        return f"{what} {worst}."
    alike = (errors > 0).all() or (errors < 0).all()
    usual = too(float(np.median(errors))) if alike else f"{percent(float(np.median(np.abs(errors))))} off"
    return f"{what} mostly {usual}, at worst {worst} (of {len(errors)} values)."
