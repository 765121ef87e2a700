"""The pages of a report that show set-ups which are no cases of the study: those of the corrections and of the published table."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path

from analysis import page, questions
from analysis.corrections import page as corrections_page
from analysis.published import section as published_section
from analysis.store import Document, write_text

_SCRIPT = f"../{Path(page.SCRIPT).name}"


def writers(corrected: Document | None, place: Path) -> dict[Path, Callable[[Path], None]]:
    """Where each page belongs, and what writes it there. `place` is the folder of the report's pages, `corrected` the document of the
    corrections."""
    found: dict[Path, Callable[[Path], None]] = {place / questions.PUBLISHED_SET_UPS: _write_published}
    if corrected is not None:
        found[place / questions.CORRECTIONS_SET_UPS] = functools.partial(_write_corrections, corrected)
    return found


def _write_published(target: Path) -> None:
    write_text(target, published_section.set_ups_document(*_back(questions.PUBLISHED), _SCRIPT))


def _write_corrections(document: Document, target: Path) -> None:
    corrections_page.make_set_ups(document, target, *_back(questions.CORRECTIONS), _SCRIPT)


def _back(name: str) -> tuple[str, str]:
    """The page of a question as seen from that of its set-ups, and its title."""
    (title,) = (question.title for question in questions.QUESTIONS if question.name == name)
    return f"../{name}.html", title
