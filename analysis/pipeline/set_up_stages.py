"""Set-ups of a topic, each answered by one stage; finished set-ups are not computed again."""

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from analysis.pipeline import keys
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import Processes, Stage, outdated
from analysis.results.store import Document, read_current, write_text
from analysis.results.study_results import SCENE, Failure, case_folder
from geometries.common.installation import ROOT
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical_and_identity
from geometries.studies.study import IDENTITY_DIGITS


class Item(Protocol):
    """What has an answer of its own, under this name."""

    @property
    def id(self) -> str:
        ...


@dataclass(frozen=True)
class Whole:
    """All set-ups of a topic together, where one answer tells of them."""

    id: str = "all"


@dataclass(frozen=True)
class OfScene:
    """A set-up that is known by its scene, as its canonical text."""

    scene: Scene

    @cached_property
    def _canonical(self) -> tuple[str, str]:
        return canonical_and_identity(self.scene)

    @property
    def text(self) -> str:
        """The scene in canonical form."""
        return self._canonical[0]

    @property
    def identity(self) -> str:
        """The hash of the text."""
        return self._canonical[1]

    @property
    def id(self) -> str:
        """The first digits of the hash, by which the set-up is called."""
        return self.identity[:IDENTITY_DIGITS]

    @property
    def name(self) -> str:
        """The set-up in words."""
        return f"set-up {self.id}"


SomeItem = TypeVar("SomeItem", bound=Item)
_SomeItem = TypeVar("_SomeItem", bound=Item, contravariant=True)
SomeSetUp = TypeVar("SomeSetUp", bound=OfScene)


class Stages(Protocol[_SomeItem]):
    """What computes the answers of a topic and keeps them in a folder of this name, beside the folders of the studies' results."""

    @property
    def name(self) -> str:
        ...

    def run(self, folder: Path, items: Iterable[_SomeItem], workers: int | None = None) -> list[Failure]:
        """Computes the missing and outdated answers; returns the failures."""

    def load(self, folder: Path, items: Iterable[_SomeItem]) -> dict[str, Document]:
        """Returns the answers in a folder that are up to date, by the item's id."""


@dataclass(frozen=True)
class SetUpStages(Generic[SomeSetUp]):
    """The stages of a topic's set-ups.

    `name` is that of the topic: of the folder of its answers, beside the folders of the studies' results, of the files in it, and of the
    stage that a failure is reported under; `what` is the set-ups' in the progress bar. The answers depend on the model with its boundary
    elements, on the files `sources` of the repository, and on the relative accuracy `rtol` asked of boundary elements. `answer` computes
    the answer of a set-up, whose scene is in a file; `seconds` is how long it is expected to take."""

    name: str
    what: str
    rtol: float
    sources: tuple[str, ...]
    seconds: Callable[[SomeSetUp], float]
    answer: Callable[[SomeSetUp, Path], Document]

    def path(self, folder: Path, set_up: SomeSetUp) -> Path:
        """Returns the file of a set-up's answer."""
        return case_folder(folder, set_up.id) / f"{self.name}.json"

    def run(self, folder: Path, set_ups: Iterable[SomeSetUp], workers: int | None = None) -> list[Failure]:
        """Computes the missing and outdated answers; returns the failures."""
        current = self.code()
        distinct = {each.id: each for each in set_ups}.values()
        stages = outdated([self._stage(folder, each, current) for each in distinct])
        return run_all(stages, workers or parallel_jobs(), self.what)

    def load(self, folder: Path, set_ups: Iterable[SomeSetUp]) -> dict[str, Document]:
        """Returns the answers in a folder that are up to date, by the set-up's id."""
        if not folder.is_dir():
            return {}
        code = self.code()
        keyed = ((each, self._key(each, code)) for each in set_ups)
        stored = {each.id: read_current(self.path(folder, each), key) for each, key in keyed}
        return {name: answer for name, answer in stored.items() if answer is not None}

    def code(self, repository: Path = ROOT) -> str:
        """Returns the version of the code that makes the answers."""
        own = keys.hash_of_files([repository / source for source in self.sources], repository)
        return f"{keys.model_code(repository)} {own}"

    def _stage(self, folder: Path, set_up: SomeSetUp, code: str) -> Stage:
        answer = functools.partial(self._answer, set_up, case_folder(folder, set_up.id) / SCENE)
        target, key = self.path(folder, set_up), self._key(set_up, code)
        return Stage(self.name, set_up.id, target, key, self.seconds(set_up), answer)

    def _key(self, set_up: SomeSetUp, code: str) -> str:
        return keys.measurement_key(f"{self.name} {set_up.identity} {self.rtol}", code, {})

    def _answer(self, set_up: SomeSetUp, scene: Path, _: Processes) -> Document:
        if not scene.is_file():
            write_text(scene, set_up.text)
        return self.answer(set_up, scene)
