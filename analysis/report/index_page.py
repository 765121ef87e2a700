"""`report.html`: the summary of a study, with a link to the page of every question."""

from __future__ import annotations

import re
from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import page

_FINDING = re.compile(r'<p class="finding">(.*?)</p>', re.DOTALL)
_PARAGRAPH = re.compile(r"<p[^>]*>(.*?)</p>", re.DOTALL)


@dataclass(frozen=True)
class Card:
    """A page's entry in the index: `target` relative to the index, `says` the page's first finding."""

    target: str
    title: str
    says: str | Markup


def first_finding(text: Markup) -> Markup:
    """Returns the first finding in a page's body, or its first paragraph where nothing was found out."""
    found = _FINDING.search(text) or _PARAGRAPH.search(text)
    return Markup(found[1] if found else "")


def document(title: str, inputs: str, headline: Markup, cards: list[Card], rest: list[Markup]) -> str:
    """Returns the whole page. Its script is loaded only where the headline holds a figure."""
    body = page.filled("index.html", headline=headline, cards=cards, rest=rest)
    return page.document(title, inputs, [body], page.SCRIPT if page.PLOT in headline else "")


def navigation(title: str, pages: list[tuple[str, str]], current: str) -> Markup:
    """Links a page to the index and to the other pages, given as (file, short title)."""
    links = [page.link(file, short, current=file == current) for file, short in pages]
    return page.navigation(page.link("../report.html", f"‹ {title}"), *links)
