"""The published table as a topic: its page and its set-ups, of the table as it is kept with the project."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from analysis.pipeline.set_up_stages import Whole
from analysis.results.store import Document
from analysis.results.study_results import Failure
from analysis.topics.published import files, section
from analysis.topics.published.section import Published
from analysis.topics.topic import Topic


@dataclass(frozen=True)
class Kept:
    """The table that is kept with the project, whatever answers there are."""

    name: str = files.STUDY

    def run(self, folder: Path, _: Iterable[Whole], workers: int | None = None) -> list[Failure]:
        """Returns no failures: there is nothing to compute."""
        return []

    def load(self, _: Path, __: Iterable[Whole]) -> dict[str, Document]:
        """Returns the hash of the table."""
        return {Whole().id: {"digest": files.digest()}}


PUBLISHED = Topic[Whole, Published](
    stages=Kept(),
    set_ups=lambda: (Whole(),),
    entry=lambda _, __: files.load(),
    sections=lambda found, _, set_ups: [section.section(found[0], set_ups)],
    finding=lambda found: section.headline(found[0][0]),
    absent="",
    title=section.TITLE,
    question="Which values can others be held against?",
    short="published table",
    set_ups_page=lambda found, *around: section.set_ups_document(found[0], *around),
)
