"""`report.html`: what a study found in few numbers, and the way to the page of every question."""

from __future__ import annotations

import re
from dataclasses import dataclass
from html import escape

from analysis.report import page

_FINDING = re.compile(r'<p class="finding">(.*?)</p>', re.DOTALL)
_PARAGRAPH = re.compile(r"<p[^>]*>(.*?)</p>", re.DOTALL)


@dataclass(frozen=True)
class Card:
    """A page as the index shows it: `target` relative to the index, `says` its first finding as HTML."""

    target: str
    title: str
    says: str


def first_finding(text: str) -> str:
    """The first finding in a page's body, or its first paragraph where nothing was found out; HTML."""
    found = _FINDING.search(text) or _PARAGRAPH.search(text)
    return found[1] if found else ""


def document(title: str, inputs: str, headline: str, cards: list[Card], rest: list[str]) -> str:
    """The whole page. Its script is loaded only where the headline holds a figure."""
    entries = "\n".join(f"<li>{page.link(card.target, card.title)}<p>{card.says}</p></li>" for card in cards)
    body = [headline, f'<ul class="cards">\n{entries}\n</ul>', *rest]
    script = page.SCRIPT if page.PLOT in headline else ""
    return page.document(title, inputs, body, script)


def navigation(title: str, pages: list[tuple[str, str]], current: str) -> str:
    """The way from a page to the index and to the others: (file, short title) of each."""
    links = [page.link("../report.html", f"‹ {title}")]
    for file, short in pages:
        mark = ' aria-current="page"' if file == current else ""
        links.append(f'<a href="{escape(file)}"{mark}>{escape(short)}</a>')
    return f"<nav>{' '.join(links)}</nav>"
