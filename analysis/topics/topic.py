"""A question that set-ups answer, declared once: its command, its page, its section and its card in the reports of studies follow from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.pipeline.set_up_stages import SetUpStages, SomeSetUp
from analysis.report import page
from analysis.results.store import Document, write_text
from analysis.topics.field_solver import FieldCheck
from analysis.topics.stored import Stored
from geometries.common import installation

SomeEntry = TypeVar("SomeEntry")
Comparisons = list[Any]


@dataclass(frozen=True)
class Topic(Generic[SomeSetUp, SomeEntry]):
    """What a topic says of itself.

    `stages` computes the answer of each of the `set_ups`, of which `entry` makes what is told. `sections` are those of a page, from the
    entries, the comparisons with the field solver, and the folder of the set-ups' cases as seen from the page; `finding` is what the command
    prints, `absent` what is said without answers. `title` is that of the topic's own page; `question` and its `short` form are those of the
    page in the reports of studies. `reproduce` says what the commands at the page's end do: the first solves one set-up with the stages'
    accuracy, the last are those of `truths` and, where `is_quick`, of the field `check`. `cases` writes pages of the set-ups.
    """

    stages: SetUpStages[SomeSetUp]
    set_ups: Callable[[], tuple[SomeSetUp, ...]]
    entry: Callable[[SomeSetUp, Document], SomeEntry]
    sections: Callable[[list[SomeEntry], Comparisons, str], list[Markup]]
    finding: Callable[[list[SomeEntry]], str]
    absent: str
    title: str
    question: str
    short: str
    reproduce: str = ""
    truths: Stored[SomeSetUp] | None = None
    check: FieldCheck[SomeSetUp] | None = None
    is_quick: bool = False
    cases: Callable[[Path, list[SomeEntry]], None] | None = None

    @property
    def name(self) -> str:
        """That of the command, of the folder of the answers, and of the page."""
        return self.stages.name

    @property
    def file(self) -> str:
        """That of the topic's own page."""
        return f"{self.name}.html"

    def load(self, folder: Path) -> dict[str, Document]:
        """Returns the answers in a folder that are up to date, by the set-up's id."""
        return self.stages.load(folder, self.set_ups())

    def found(self, answers: dict[str, Document]) -> list[SomeEntry]:
        """Returns the entries of the set-ups that have an answer, in their order."""
        return [self.entry(each, answers[each.id]) for each in self.set_ups() if each.id in answers]

    def checked(self) -> Document:
        """Returns the field solver's records; none if it was not asked."""
        return self.check.stored.records() if self.check else {}

    def shown(self, found: list[SomeEntry], cases: str = "cases") -> list[Markup]:
        """Returns the sections of a page; `cases` is the folder of the set-ups' cases as seen from it."""
        # The entries of a topic with a field check have a set-up and the quantities that it compares.
        entries: Any = found
        return self.sections(found, self.check.comparisons(entries) if self.check else [], cases)

    def make(self, folder: Path) -> page.Made:
        """Writes the page of the answers in a folder, and those of its set-ups, unless it is up to date."""
        answers = self.load(folder)
        found = self.found(answers)
        inputs = keys.page_inputs(answers, self.checked())
        target = folder / self.file
        if not page.is_current(target, inputs):
            page.provide_script(folder)
            if self.cases:
                self.cases(folder, found)
            body = [page.header(self.title), *self.shown(found), *self._reproduced(folder)]
            write_text(target, page.document(self.title, inputs, body, page.SCRIPT))
        return page.Made(target, self.finding(found) if found else self.absent)

    def _reproduced(self, folder: Path) -> list[Markup]:
        if not self.reproduce:
            return []
        scene = f"{installation.from_repository(folder / 'cases')}/SET_UP/scene.toml"
        analysis = installation.command("analysis")
        commands = [
            f"{installation.model_command()} capacitance {scene} --method boundary-elements --rtol {self.stages.rtol:g}",
            f"{analysis} {self.name} --output {installation.from_repository(folder)}",
        ]
        if self.truths:
            commands.append(f"{analysis} measure truths {self.name}")
        if self.is_quick:
            commands.append(f"{analysis} measure field-check {self.name}")
        return [page.section("Reproduce", page.paragraph(self.reproduce), *map(page.command, commands))]
