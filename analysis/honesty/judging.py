"""Records of scenes with all answers, one line of JSON each, and how stated errors are held against independent references."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from analysis.honesty.methods import FIELD_SOLVER, FINER, Answer, Stated
from analysis.results.answers import Estimate

FILE = "answers.jsonl"


@dataclass
class Record:
    """A scene by its seed and kind, what is known of it in closed form, and its answers by their methods."""

    seed: int
    kind: str
    truths: dict[str, Estimate]
    answers: dict[str, Answer] = field(default_factory=dict)


def load(folder: Path) -> dict[int, Record]:
    """Returns the records of a folder by their seeds: of several of one scene all answers, the last one of each method. A line that was
    not finished is left out."""
    found: dict[int, Record] = {}
    file = folder / FILE
    for line in file.read_text(encoding="utf-8").splitlines() if file.is_file() else []:
        try:
            record = _record(json.loads(line))
        except (ValueError, KeyError, TypeError):
            continue
        before = found.setdefault(record.seed, record)
        before.answers |= record.answers
    return found


def append(folder: Path, record: Record) -> None:
    """Adds a record to those of a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / FILE).open("a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(record)) + "\n")


def _record(document: dict[str, Any]) -> Record:
    truths = {name: Estimate(**known) for name, known in document["truths"].items()}
    answers = {name: answer(each) for name, each in document["answers"].items()}
    return Record(document["seed"], document["kind"], truths, answers)


def answer(document: dict[str, Any]) -> Answer:
    """Reads a stored answer."""
    values = {name: Stated(**stated) for name, stated in document["values"].items()}
    return replace(Answer(**document), values=values)


CLOSED_FORM, ITSELF = "closed form", "itself, finer"
_ENOUGH = 0.5
"""Largest error of a reference, relative to the error stated, by which this may be judged."""
_SMALL = 0.1
"""The same for how much too wide it is."""
_ROUNDING = 1e-12
"""Relative error of any number."""
_SAME = "boundary-elements"
"""What the finer answer has in common with the methods that it is not independent of."""


@dataclass(frozen=True)
class Judged:
    """An answer beside its reference (F)."""

    seed: int
    kind: str
    method: str
    quantity: str
    value: float
    stated: float
    answered_by: str
    reference: Estimate
    by: str

    @property
    def difference(self) -> float:
        return abs(self.value - self.reference.value)

    @property
    def ratio(self) -> float:
        """By how much the error is larger than stated, after what the reference itself may be off; at most 1 where it held."""
        error = max(0.0, self.difference - self.reference.error)
        if self.stated > 0:
            return error / self.stated
        return math.inf if error > 0 else 0.0

    @property
    def is_held(self) -> bool:
        return self.ratio <= 1

    @property
    def width(self) -> float | None:
        """How many times as large the stated error is as the true one, at least; None where the reference cannot tell."""
        least = max(self.difference, self.reference.error)
        if self.reference.error > _SMALL * self.stated or least == 0:
            return None
        return self.stated / least


@dataclass(frozen=True)
class Unjudged:
    """An answer that no reference is accurate enough to judge, or, with `is_unknown`, that states no error."""

    kind: str
    method: str
    is_unknown: bool


def judged(record: Record, method: str) -> Iterator[Judged | Unjudged]:
    """Returns what becomes of each quantity of a method's answer. One that the method does not know by its nature, as the formula knows
    only changes, is left out."""
    for quantity, stated in record.answers[method].values.items():
        if stated.value is None and not quantity.endswith(("change", "]")):
            continue
        if stated.value is None or stated.error is None:
            yield Unjudged(record.kind, method, True)
            continue
        yield _judged(record, method, quantity, stated, stated.value, stated.error)


def _judged(
    record: Record, method: str, quantity: str, answer: Stated, value: float, stated: float
) -> Judged | Unjudged:
    beside = [
        Judged(record.seed, record.kind, method, quantity, value, stated, answer.by, known, by)
        for by, known in _references(record, method, quantity, answer.by)
    ]
    for each in beside:
        if each.reference.error <= _ENOUGH * stated:
            return each
    # An answer that contradicts a reference by more than both errors is wrong, however wide the reference is.
    wrong = [each for each in beside if not each.is_held]
    return wrong[0] if wrong else Unjudged(record.kind, method, False)


def _references(record: Record, method: str, quantity: str, by: str) -> Iterator[tuple[str, Estimate]]:
    """Returns what is known of a quantity, the most independent first."""
    if quantity in record.truths:
        yield CLOSED_FORM, _rounded(record.truths[quantity])
    if method != FIELD_SOLVER and (known := _estimate(record.answers.get(FIELD_SOLVER), quantity)):
        yield FIELD_SOLVER, known
    if known := _estimate(record.answers.get(FINER), quantity):
        yield ITSELF if _SAME in f"{method} {by}" else FINER, known


def _estimate(answer: Answer | None, quantity: str) -> Estimate | None:
    stated = answer.values.get(quantity) if answer is not None else None
    if stated is None or stated.value is None or stated.error is None:
        return None
    return _rounded(Estimate(stated.value, stated.error))


def _rounded(known: Estimate) -> Estimate:
    return Estimate(known.value, known.error + _ROUNDING * abs(known.value))
