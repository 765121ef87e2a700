"""Pages that lead to others: `report.html`, the summary of a study, with a link to the page of every question, and the list of everything that
was made, with the pages of scenes that reports lead to."""

import os
import re
from dataclasses import dataclass
from html import unescape
from pathlib import Path

import numpy as np
from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import drawing, page
from analysis.results import table
from analysis.results.study_results import CaseResult, Results
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
    drawn = [drawing.thumbnail(data, layout, title) for data, layout in page.figures_of(text)]
    rich = [each for each in drawn if each.count("<circle") + each.count("<rect") >= _FEWEST]
    return next(iter(rich + [each for each in drawn if each]), Markup(""))


def how_wrong(results: Results, rows: list[table.Row], cases: str) -> list[Answer]:
    """Returns how wrong the model is in each family of a study, and on machines, with a drawing of each, which leads to a case that
    has the potential around it, if any has. `cases` is the folder of the cases as seen from the index."""
    places: dict[str, dict[str, list[CaseResult]]] = {}
    for case in results.compared():
        machine = str(case.parameters.get("machine", NONE))
        alone = _WHERE.get(case.family, str(case.parameters.get("scene", case.family)))
        where = alone if machine == NONE else _ON_A_MACHINE
        words = "" if machine == NONE else f"{case.family}, {machine.replace('+', ' and ')}"
        places.setdefault(where, {}).setdefault(words, []).append(case)
    found = []
    for where, kinds in places.items():
        pictures = []
        for words, own in kinds.items():
            shown = next((case for case in own if case.slice), own[0])
            drawn = drawing.of_scene(shown.scene, shown.name)
            pictures.append(Picture(f"{cases}/{shown.id}/{page.CASE_PAGE}", drawn, words))
        says = _how_wrong([case.id for own in kinds.values() for case in own], rows)
        found.append(Answer(where, says, pictures))
    return found


def _how_wrong(cases: list[str], rows: list[table.Row]) -> str:
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


@dataclass(frozen=True)
class ScenePage:
    """A page that ./run makes of a scene; `scene` is a name in geometries/scenes, `folder` one in the results."""

    folder: str
    scene: str
    title: str
    says: str


LIVE = ScenePage(
    "live",
    "sensor_head",
    "What do the sensors read while a hand is dragged?",
    "A machine in 3-D on which the hand can be moved: in every frame the model, the formula and the reduced method with its error, "
    "computed in the page.",
)
MOTION = ScenePage(
    "show",
    "position_sensor",
    "What do the sensors read along a motion?",
    "A block slides over five electrodes, as a film: the model, the formula and the reduced method in every frame, boundary elements "
    "in some, over time.",
)


def all_beside(results: Path) -> list[tuple[ScenePage, str]]:
    """Returns the pages that were made, with their files as seen from the folder of a study's results."""
    found = [(page, f"{page.folder}/{page.scene}.html") for page in (LIVE, MOTION)]
    return [(page, f"../{file}") for page, file in found if (results.resolve().parent / file).is_file()]


FILE = "index.html"
_TITLE = "Everything that was made"
_NOT_LISTED = {"set_ups.html"}
_LISTED = (".html", ".csv", ".vtu", ".md", ".txt")
_SITE = Path("analysis", "documentation", "index.html")
"""The first page of the site of the notes, in its folder."""
_PAGE_TITLE = re.compile(r"<title>(.*?)</title>")
# The title is near the beginning of a page, whose scripts may take megabytes.
_TITLE_WITHIN = 2000


def make(folder: Path) -> Path | None:
    """Writes the list of a folder of results, unless it is up to date; returns it, None where nothing was made or the folder is not to be
    written to."""
    made = {each.name: files for each in sorted(folder.glob("*/")) if (files := _files(each))}
    if not made or not os.access(folder, os.W_OK):
        return None
    target = folder / FILE
    listed = {}
    for name, files in made.items():
        listed[name] = [(file.relative_to(folder).as_posix(), _title(file)) for file in files]
    inputs = keys.page_inputs(listed)
    if not page.is_current(target, inputs):
        sections = []
        for name, entries in listed.items():
            links = (page.paragraph(page.link(*entry)) for entry in entries)
            sections.append(page.section(name.replace("_", " "), *links))
        page.write(target, page.document(_TITLE, inputs, [page.header(_TITLE), *sections], ""))
    return target


def _files(folder: Path) -> list[Path]:
    """Returns what a person opens of what is in a folder, pages first."""
    found = [path for path in folder.iterdir() if path.suffix in _LISTED and path.name not in _NOT_LISTED]
    found.sort(key=lambda path: (_LISTED.index(path.suffix), path.name != page.REPORT, path.name))
    return found or [site for site in [folder / _SITE] if site.is_file()]


def _title(file: Path) -> str:
    """Returns the title of a page, or the name of another file."""
    if file.suffix != ".html":
        return file.name
    with file.open(encoding="utf-8", errors="replace") as opened:
        found = _PAGE_TITLE.search(opened.read(_TITLE_WITHIN))
    return unescape(found[1]) if found else file.name
