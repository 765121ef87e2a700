"""Summary statistics of the model's error, and how numbers are spread, as topics tell and tabulate it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from analysis.results.table import CHANGE, QUANTITIES, Row, compared
from analysis.results.units import percent


@dataclass(frozen=True)
class Spread:
    """Median, least and greatest of some numbers; of what they are away from a true one the root mean square, and the one that is farthest."""

    count: int
    median: float
    least: float
    greatest: float
    rms: float
    worst: float

    @property
    def range(self) -> str:
        """The median, and from least to greatest."""
        return f"{ratio(self.median)} ({ratio(self.least)} to {ratio(self.greatest)})"


def spread(values: Iterable[float], true: float = 0.0) -> Spread | None:
    """Returns the spread of those numbers that are finite; None without any."""
    found = np.array([value for value in values if np.isfinite(value)])
    if not len(found):
        return None
    away = found - true
    rms, worst = np.sqrt((away**2).mean()), away[np.abs(away).argmax()]
    return Spread(len(found), *map(float, (np.median(found), found.min(), found.max(), rms, worst)))


def range_of(found: Spread | None) -> str:
    """Returns the range of a spread; empty without one."""
    return found.range if found else ""


def ratio(value: float) -> str:
    """Writes a ratio with three digits, or with all before the point."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


ALL_FAMILIES = "all"
_Item = TypeVar("_Item")
_Key = TypeVar("_Key")


def grouped(items: Iterable[_Item], key: Callable[[_Item], _Key]) -> dict[_Key, list[_Item]]:
    """Returns the items of each key, in the order in which the keys first come."""
    found: dict[_Key, list[_Item]] = {}
    for each in items:
        found.setdefault(key(each), []).append(each)
    return found


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
    relative error of the reference among them."""

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
    Rows that the model has no value of are left out."""
    found, by_quantity = [], grouped(compared(rows), lambda row: row.quantity)
    for quantity in (quantity for quantity in QUANTITIES if quantity in by_quantity):
        own = by_quantity[quantity]
        groups = grouped(own, lambda row: row.machine if row.quantity == CHANGE else row.case.family)
        found += [summary(name, quantity, some) for name, some in ({ALL_FAMILIES: own} | groups).items()]
    return found


def summary(family: str, quantity: str, rows: list[Row]) -> Summary:
    """Returns the summary of at least one row."""
    errors = np.array([row.model_error for row in rows])
    worst = rows[int(np.argmax(np.abs(errors)))]
    return Summary(
        family,
        quantity,
        count=len(rows),
        rms=float(np.sqrt(np.mean(errors**2))),
        median=float(np.median(np.abs(errors))),
        worst=worst.model_error,
        worst_case=worst.case.id,
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
