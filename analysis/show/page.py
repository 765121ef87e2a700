"""The page of a scene: its frame, its style and its script; the script draws what the data say."""

from __future__ import annotations

from analysis.report import page
from analysis.results.store import Document


def document(title: str, digest: str, text: str, data: Document) -> str:
    """Returns the whole page. `text` is the data as JSON, `digest` its hash."""
    body = page.filled(
        "show.html",
        style=page.static("show.css"),
        script=page.static("show.js"),
        title=title,
        summary=_summary(data),
        data=page.json_in_page(text),
    )
    return page.document(title, digest, [body])


def _summary(data: Document) -> str:
    nouns = {
        "objects": "object",
        "links": "link",
        "sensors": "capacitive sensor",
        "eyes": "distance sensor",
        "frames": "frame",
    }
    parts = [_count(len(data[key]), noun) for key, noun in nouns.items() if data[key]]
    return ", ".join(parts) + ". Drag to turn, scroll to come closer, hover for names."


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
