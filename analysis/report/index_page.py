"""`report.html`: the summary of a study, with a link to the page of every question."""

from __future__ import annotations

import re
from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import drawing, page
from analysis.report.thumbnail import thumbnail
from analysis.results.study_results import CaseResult, Results
from geometries.studies.machines import NONE

_FINDING = re.compile(r'<p class="finding">(.*?)</p>', re.DOTALL)
_PARAGRAPH = re.compile(r"<p[^>]*>(.*?)</p>", re.DOTALL)
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
class Kind:
    """Cases that look alike: the first one's page relative to the index, its drawing, the family in words, and how many there are."""

    target: str
    drawing: Markup
    words: str
    count: int


def first_finding(text: Markup) -> Markup:
    """Returns the first finding in a page's body, or its first paragraph where nothing was found out."""
    found = _FINDING.search(text) or _PARAGRAPH.search(text)
    return Markup(found[1] if found else "")


def first_picture(text: Markup, title: str) -> Markup:
    """Returns a thumbnail of the first figure of a page's body that has enough points, or else of the first figure; empty without any."""
    drawn = [thumbnail(data, layout, title) for data, layout in page.figures_of(text)]
    rich = [each for each in drawn if each.count("<circle") + each.count("<rect") >= _FEWEST]
    return next(iter(rich + [each for each in drawn if each]), Markup(""))


def kinds(results: Results, cases: str) -> list[Kind]:
    """Returns the families of a study, one before each machine apart. `cases` is the folder of the cases as seen from the index."""
    members: dict[str, list[CaseResult]] = {}
    for case in results.compared():
        machine = str(case.parameters.get("machine", NONE))
        members.setdefault(case.family if machine == NONE else f"{case.family}, {machine}", []).append(case)
    return [
        Kind(
            f"{cases}/{own[0].id}/{page.CASE_PAGE}",
            drawing.of_scene(own[0].scene, own[0].name),
            words,
            len(own),
        )
        for words, own in members.items()
    ]


def document(
    title: str,
    inputs: str,
    warning: Markup,
    headline: Markup,
    shown: list[Kind],
    cards: list[Card],
    rest: list[Markup],
) -> str:
    """Returns the whole page. Its script is loaded only where the headline holds a figure."""
    own, others = ([card for card in cards if card.own == mine] for mine in (True, False))
    body = page.filled(
        "index.html",
        title=title,
        warning=warning,
        headline=headline,
        kinds=shown,
        own=own,
        others=others,
        rest=rest,
    )
    return page.document(title, inputs, [body], page.SCRIPT if page.PLOT in headline else "")


def navigation(title: str, pages: list[tuple[str, str]], current: str) -> Markup:
    """Links a page to the index and to the other pages, given as (file, short title)."""
    links = [page.link(file, short, current=file == current) for file, short in pages]
    return page.navigation(page.link("../report.html", f"‹ {title}"), *links)
