"""One stage of one case: what computes an answer, and the file and the key under which the answer is stored."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from glob import escape
from pathlib import Path

from analysis.pipeline.processes import Processes
from analysis.results.store import Document, is_current, write_json
from analysis.results.study_results import Failure


class NoAnswer(Exception):
    """Says why a stage has no answer."""


class Refused(NoAnswer):
    """Says why a method cannot answer such a case; the reason is the same for all cases like it."""


@dataclass(frozen=True)
class Stage:
    """Computes an answer and stores it in the file `target` under `key`.

    A failure is reported under `name` and `case`; the case is empty for what belongs to no case. `seconds` is the expected time on one
    core. `answer` returns the document to store; NoAnswer, ValueError and RuntimeError say why there is none.
    """

    name: str
    case: str
    target: Path
    key: str
    seconds: float
    answer: Callable[[Processes], Document]

    @property
    def is_current(self) -> bool:
        """Whether the answer is stored already, under this very key."""
        return is_current(self.target, self.key)

    def forget(self) -> None:
        """Removes an outdated answer, and the unfinished files that killed writers left beside it."""
        for outdated in (self.target, *self.target.parent.glob(f".{escape(self.target.stem)}.*")):
            outdated.unlink(missing_ok=True)

    def run(self, processes: Processes) -> Failure | None:
        """Computes and stores the answer; returns why there is none."""
        try:
            document = self.answer(processes)
        except (NoAnswer, ValueError, RuntimeError) as error:
            return Failure(self.case, self.name, str(error), isinstance(error, Refused))
        write_json(self.target, {"key": self.key, **document})
        return None


def outdated(stages: Iterable[Stage]) -> list[Stage]:
    """Returns the stages whose answers are missing or stored under another key; such answers are removed."""
    found = [stage for stage in stages if not stage.is_current]
    for stage in found:
        stage.forget()
    return found


def parsed(text: str) -> Document:
    """Parses the JSON document that a program wrote; NoAnswer if it is none."""
    try:
        document = json.loads(text)
    except ValueError as error:
        raise NoAnswer(f"wrote no JSON document: {error}") from error
    if not isinstance(document, dict):
        raise NoAnswer("wrote no JSON document")
    return document


@contextmanager
def unfinished_file(target: Path) -> Iterator[Path]:
    """Gives a hidden file beside `target` for a program to write its answer to, and removes it afterwards."""
    target.parent.mkdir(parents=True, exist_ok=True)
    unfinished = target.with_name(f".{target.name}.unfinished").resolve()
    try:
        yield unfinished
    finally:
        unfinished.unlink(missing_ok=True)
