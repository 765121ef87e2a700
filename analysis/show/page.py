"""The page of a scene: its frame, its style and its script; the script draws what the data say."""

from __future__ import annotations

from analysis.report import page
from analysis.results.store import Document

_SCRIPTS = ("show_readings.js", "show.js")


def document(title: str, digest: str, text: str, data: Document, readings: str | None) -> str:
    """Returns the whole page. `text` is the data as JSON, `readings` those along the motion, and `digest` the hash of what the page is
    made from."""
    body = page.filled(
        "show.html",
        style=page.static("show.css"),
        scripts=[page.static(name) for name in _SCRIPTS],
        readings=None if readings is None else page.json_in_page(readings),
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
    counts = {key: len(data[key]) for key in nouns} | {"frames": len(data["frames"][:: data["every"]])}
    parts = [_count(counts[key], noun) for key, noun in nouns.items() if counts[key]]
    return ", ".join(parts) + ". Drag to turn, scroll to come closer, hover for names."


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
