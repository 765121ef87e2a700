"""Summary statistics of the model's error."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from analysis.results.table import CHANGE, QUANTITIES, Row, compared
from analysis.results.units import percent

ALL_FAMILIES = "all"
_Item = TypeVar("_Item")


def front(items: Iterable[_Item], place: Callable[[_Item], tuple[float, float]]) -> list[_Item]:
    """Returns the Pareto front: the items that no other one beats in both time and error, which `place` gives, from fast to accurate."""
    best: list[_Item] = []
    for each in sorted(items, key=place):
        if not best or place(each)[1] < place(best[-1])[1]:
            best.append(each)
    return best


@dataclass(frozen=True)
class Summary:
    """The model errors of one family in one quantity, relative to the reference; for changes, of one machine instead.

    `median` is of the absolute errors, `worst` the error of the largest absolute value with its sign, `sure_to` the largest
    relative error of the reference among them.
    """

    family: str
    quantity: str
    count: int
    rms: float
    median: float
    worst: float
    worst_case: str
    sure_to: float


def summaries(rows: list[Row]) -> list[Summary]:
    """Returns a summary for each quantity, over all families and then for each of them; for changes, for each machine instead.

    Rows that the model has no value of are left out.
    """
    found = []
    for quantity in QUANTITIES:
        members: dict[str, list[Row]] = {}
        for row in compared(rows):
            if row.quantity == quantity:
                group = row.machine if quantity == CHANGE else row.case.family
                for name in (ALL_FAMILIES, group):
                    members.setdefault(name, []).append(row)
        found += [summary(name, quantity, own) for name, own in members.items()]
    return found


def summary(family: str, quantity: str, rows: list[Row]) -> Summary:
    """Returns the summary of at least one row."""
    errors = np.array([row.model_error for row in rows])
    worst = int(np.argmax(np.abs(errors)))
    return Summary(
        family=family,
        quantity=quantity,
        count=len(rows),
        rms=float(np.sqrt(np.mean(errors**2))),
        median=float(np.median(np.abs(errors))),
        worst=float(errors[worst]),
        worst_case=rows[worst].case.id,
        sure_to=max(row.reference_error for row in rows),
    )


def headline(found: list[Summary]) -> str:
    """Returns the summaries over all families as lines for a terminal."""
    return "\n".join(
        f"{s.quantity:<11} model error over {s.count} cases: rms {s.rms:.1%}, median {s.median:.1%}, worst {s.worst:+.1%}"
        f" (the reference is sure to {percent(s.sure_to) if s.sure_to < 1 else 'no digit in one of them'})"
        for s in found
        if s.family == ALL_FAMILIES
    )
