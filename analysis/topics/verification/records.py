"""The rows of the verification as numbers: true and stated errors, orders of convergence."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from analysis.results.store import Document

ROUNDING = 2.0**-52
CLEAR_OF_TRUTH = 3.0
"""A level's error is used for the order of convergence if it is this many times the error of the truth."""


@dataclass(frozen=True)
class Compared:
    """One quantity whose truth is known; all errors are relative to it. `level_errors` have their sign."""

    case: str
    quantity: str
    source: str
    truth_error: float
    off: float
    stated: float
    half_width: float | None
    enclosed: bool | None
    edge_sizes: tuple[float, ...]
    level_errors: tuple[float, ...]
    seconds: float

    @property
    def within(self) -> bool:
        """Whether the truth is within the stated error, as far as it is known."""
        return self.off <= self.stated + self.truth_error

    @property
    def known_off(self) -> float:
        """The true error, or the error of the truth if that is larger."""
        return max(self.off, self.truth_error, ROUNDING)

    @property
    def effectivity(self) -> float:
        """The stated error over the true one: below 1 it is wrong, far above 1 it wastes time."""
        return self.stated / self.known_off

    @property
    def enclosure_effectivity(self) -> float | None:
        """Half the width of the enclosure over the best value's true error."""
        return None if self.half_width is None else self.half_width / self.known_off

    @property
    def clear_levels(self) -> list[tuple[float, float]]:
        """Element size and error of the levels whose error is well above that of the truth."""
        pairs = zip(self.edge_sizes, self.level_errors)
        return [(size, abs(error)) for size, error in pairs if abs(error) > CLEAR_OF_TRUTH * self.truth_error]

    @property
    def order(self) -> float | None:
        """The order of convergence: the power of the element size by which the errors fall; None with fewer than three levels."""
        if len(self.clear_levels) < 3:
            return None
        sizes, errors = zip(*self.clear_levels)
        return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def compared(rows: Mapping[str, Document]) -> list[Compared]:
    """Returns every quantity of the rows, in their order."""
    return [_compared(name, row, quantity) for name, row in rows.items() for quantity in row["quantities"]]


def _compared(case: str, row: Document, quantity: Document) -> Compared:
    truth, slack = quantity["truth"], quantity["truth_error"]
    size = abs(truth)
    half = enclosed = None
    if "lower" in quantity:
        half = (quantity["upper"] - quantity["lower"]) / 2 / size
        enclosed = quantity["lower"] <= truth + slack * size and truth - slack * size <= quantity["upper"]
    return Compared(
        case,
        quantity["name"],
        row["source"],
        slack,
        abs(quantity["value"] - truth) / size,
        quantity["error"] / size,
        half,
        enclosed,
        tuple(row["edge_sizes"]),
        tuple((value - truth) / size for value in quantity["levels"]),
        row["seconds"],
    )


def worst_of_each_case(found: Iterable[Compared]) -> list[Compared]:
    """Returns, for each case, the quantity whose true error is the largest fraction of the stated one."""
    worst: dict[str, Compared] = {}
    for row in found:
        known = worst.setdefault(row.case, row)
        worst[row.case] = max(known, row, key=lambda r: r.off / r.stated)
    return list(worst.values())
