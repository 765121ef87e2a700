"""A question that set-ups answer, declared once: its command, its page, its section and its card in the reports of studies follow from it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.pipeline.set_up_stages import SetUpStages, SomeItem, Stages
from analysis.report import page
from analysis.results.store import Document, write_text
from analysis.topics import stored
from geometries.common import installation

SomeEntry = TypeVar("SomeEntry")
_CASES, _SET_UPS = "cases", "set_ups.html"


@dataclass(frozen=True)
class Topic(Generic[SomeItem, SomeEntry]):
    """What a topic says of itself.

    `stages` computes the answer of each of the `set_ups`, of which `entry` makes what is told. `sections` are those of a page, from the
    entries, what it shows of the field `check`, and what the points of figures open as seen from the page: the folder of the set-ups'
    cases, or the page that shows all set-ups. `finding` is what the command prints. Both get at least one entry; `absent` is what is said
    without any. `title` is that of the topic's own page; `question` and its `short` form are those of the page in
    the reports of studies, empty for a topic that other pages show. `reproduce` says what the commands at the page's end do: the first
    solves one set-up with the stages' accuracy, the last are those of `truths` and, where `is_quick`, of the field `check`. `cases`
    writes pages of the set-ups, `set_ups_page` returns one that shows all: from the entries, file and title of the page that leads to it,
    the hash of what it is made from, and the file of plotly.js, both files as seen from it. `command` is the topic's name unless given.
    """

    stages: Stages[SomeItem]
    set_ups: Callable[[], Iterable[SomeItem]]
    entry: Callable[[SomeItem, Document], SomeEntry]
    sections: Callable[[list[SomeEntry], list[Markup], str], list[Markup]]
    finding: Callable[[list[SomeEntry]], str]
    absent: str
    title: str
    question: str = ""
    short: str = ""
    reproduce: str = ""
    truths: stored.Stored[Any] | None = None
    check: stored.FieldCheck[Any] | None = None
    is_quick: bool = False
    cases: Callable[[Path, list[SomeEntry]], None] | None = None
    set_ups_page: Callable[[list[SomeEntry], str, str, str, str], str] | None = None
    command: str = ""

    @property
    def name(self) -> str:
        """That of the folder of the answers, of the page, and mostly of the command."""
        return self.stages.name

    @property
    def verb(self) -> str:
        """The command that computes the answers."""
        return self.command or self.name

    @property
    def file(self) -> str:
        """That of the topic's own page."""
        return f"{self.name}.html"

    def beside(self, results: Path) -> Path:
        """Returns the topic's folder that belongs to a study's results."""
        return results.resolve().parent / self.name

    def load(self, folder: Path) -> dict[str, Document]:
        """Returns the answers in a folder that are up to date, by the set-up's id."""
        return self.stages.load(folder, self.set_ups())

    def found(self, answers: dict[str, Document]) -> list[SomeEntry]:
        """Returns the entries of the set-ups that have an answer, in their order."""
        known = self.set_ups() if answers else ()
        return [self.entry(each, answers[each.id]) for each in known if each.id in answers]

    def checked(self) -> Document:
        """Returns the field solver's records; none if it was not asked."""
        return self.check.records() if self.check else {}

    def shown(self, found: list[SomeEntry], opened: str = _CASES) -> list[Markup]:
        """Returns the sections of a page; `opened` is what the points of figures open, as seen from it. Without entries it says so."""
        if not found:
            return [page.section(self.title, page.paragraph(self.absent))]
        checked = stored.parts(self.check, self.check.comparisons(found)) if self.check else []
        return self.sections(found, checked, opened)

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
            if self.set_ups_page and found:
                shown = self.set_ups_page(found, self.file, self.title, inputs, page.SCRIPT)
                write_text(folder / _SET_UPS, shown)
            sections = self.shown(found, _SET_UPS if self.set_ups_page else _CASES)
            body = [page.header(self.title), *sections, *self._reproduced(folder)]
            page.write(target, page.document(self.title, inputs, body, page.SCRIPT))
        return page.Made(target, self.finding(found) if found else self.absent)

    def _reproduced(self, folder: Path) -> list[Markup]:
        if not self.reproduce:
            return []
        assert isinstance(self.stages, SetUpStages)
        scene = f"{installation.from_repository(folder / 'cases')}/SET_UP/scene.toml"
        solve = f"{installation.model_command()} capacitance {scene} --method boundary-elements --rtol {self.stages.rtol:g}"
        own = [f"{self.name} --output {installation.from_repository(folder)}"]
        own += [f"measure truths {self.name}"] if self.truths else []
        own += [f"measure field-check {self.name}"] if self.is_quick else []
        commands = [solve, *(f"{installation.command('analysis')} {words}" for words in own)]
        return [page.section("Reproduce", page.paragraph(self.reproduce), *map(page.command, commands))]
