"""The list of everything that was made, and the pages of scenes that reports lead to."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from html import unescape
from pathlib import Path

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import page


@dataclass(frozen=True)
class ScenePage:
    """A page that ./run makes of a scene; `scene` is a name in geometries/scenes, `folder` one in the results."""

    folder: str
    scene: str
    title: str
    says: str

    def beside(self, results: Path) -> str | None:
        """Returns the page's file as seen from the folder of a study's results; None where it was not made."""
        file = Path(self.folder) / f"{self.scene}.html"
        return f"../{file.as_posix()}" if (results.resolve().parent / file).is_file() else None


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
    found = [(page, page.beside(results)) for page in (LIVE, MOTION)]
    return [(page, file) for page, file in found if file is not None]


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
    listed = {
        name: [(file.relative_to(folder).as_posix(), _title(file)) for file in files]
        for name, files in made.items()
    }
    inputs = keys.page_inputs(listed)
    if not page.is_current(target, inputs):
        sections = [
            page.section(name.replace("_", " "), *map(_line, entries)) for name, entries in listed.items()
        ]
        page.write(target, page.document(_TITLE, inputs, [page.header(_TITLE), *sections], ""))
    return target


def _files(folder: Path) -> list[Path]:
    """Returns what a person opens of what is in a folder, pages first."""
    found = [path for path in folder.iterdir() if path.suffix in _LISTED and path.name not in _NOT_LISTED]
    ordered = sorted(
        found, key=lambda path: (_LISTED.index(path.suffix), path.name != page.REPORT, path.name)
    )
    return ordered or [site for site in [folder / _SITE] if site.is_file()]


def _title(file: Path) -> str:
    """Returns the title of a page, or the name of another file."""
    if file.suffix != ".html":
        return file.name
    with file.open(encoding="utf-8", errors="replace") as opened:
        found = _PAGE_TITLE.search(opened.read(_TITLE_WITHIN))
    return unescape(found[1]) if found else file.name


def _line(entry: tuple[str, str]) -> Markup:
    return page.paragraph(page.link(*entry))
