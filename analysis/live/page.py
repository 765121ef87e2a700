"""The page of a live scene: its frame, its style and its scripts."""

from __future__ import annotations

from analysis.report import page
from analysis.results.store import Document

_PARTS = (
    "_view",
    "_model",
    "_charts",
    "_motion",
    "_picture",
    "_readings",
    "_controls",
    "_paths",
    "_input",
    "",
)
"""The scripts of the page, in the order in which they are read: `live_view.js` and so on, `live.js` at last."""


def document(title: str, digest: str, text: str, library: str, data: Document, notes: str) -> str:
    """Returns the whole page. `text` is the data as JSON, `digest` the hash of what it is made from, `library` the JavaScript with the
    library in WebAssembly, `notes` the folder of the repository as seen from the page, with a slash at its end.
    """
    body = page.filled(
        "live.html",
        style=page.static("live.css"),
        library=page.script(library),
        scripts=[page.static(f"live{part}.js") for part in _PARTS],
        title=title,
        summary=_summary(data),
        notes=notes,
        data=page.json_in_page(text),
    )
    return page.document(title, digest, [body], script="")


def _summary(data: Document) -> str:
    way = "Choose a path, drag a body" if data["paths"] else "Drag a body"
    return (
        f"{way}, or use the sliders: every frame, the library in this page computes the readings anew. Drag the empty ground to turn the "
        "view, scroll or pinch to come closer; with shift, dragging turns the body. On the picture, the arrow keys, page up and page down "
        "move it by 5 mm, with shift they turn it by 3 degrees."
    )
