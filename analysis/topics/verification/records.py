"""The rows of the verification as numbers: true and stated errors, orders of convergence, run times against errors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.results.store import Document

Array = NDArray[np.float64]

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


@dataclass(frozen=True)
class Point:
    """Seconds from the start to an answer, and the largest relative error of an entry; `unknowns` of its mesh."""

    seconds: float
    error: float
    unknowns: int


@dataclass(frozen=True)
class Target:
    """A target: an error asked for within some seconds, with the stated error, the time and the true error at the end."""

    rtol: float
    allowed_seconds: float
    stated: float
    seconds: float
    error: float

    @property
    def met(self) -> bool:
        return self.stated <= self.rtol and self.seconds <= self.allowed_seconds


@dataclass(frozen=True)
class Cost:
    """One set-up with the answers of every method, each mesh a point; `best_to` is the relative error of the best known matrix.

    `answers` are the extrapolated values at the end, `widths` half the widths of the enclosures so far.
    """

    name: str
    caption: str
    best_to: float
    best_from: str
    meshes: tuple[Point, ...]
    answers: tuple[Point, ...]
    widths: tuple[Point, ...]
    targets: tuple[Target, ...]


@dataclass(frozen=True)
class Asked:
    """A set-up of the cost rows: its name, its truth and its targets."""

    name: str
    caption: str
    targets: tuple[tuple[float, float], ...]
    truth: Array | None
    truth_error: float


def compared(rows: Mapping[str, Document]) -> list[Compared]:
    """Returns every quantity of the rows truth/…, in their order."""
    found = []
    for name, row in rows.items():
        kind, _, case = name.partition("/")
        if kind == "truth":
            found += [_compared(case, row, quantity) for quantity in row["quantities"]]
    return found


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


def cost(rows: Mapping[str, Document], asked: Asked) -> Cost | None:
    """Returns time against error of one set-up; None without an answer of the reference."""
    of = {
        method: rows[f"cost/{asked.name}/{method}"]
        for method in ("estimate", "tight", "enclosure")
        if f"cost/{asked.name}/{method}" in rows
    }
    answered = [of[method] for method in ("estimate", "tight") if method in of]
    if not answered:
        return None
    best, best_to, best_from = _best(asked, of)

    meshes = of.get("estimate", {"points": []})["points"]
    ends = tuple(_end(row, best) for row in answered)
    targets = tuple(
        Target(rtol, seconds, row["stated"], row["seconds"], end.error)
        for (rtol, seconds), row, end in zip(asked.targets, answered, ends)
    )
    widths = of.get("enclosure", {"points": []})["points"]
    return Cost(
        asked.name,
        asked.caption,
        best_to,
        best_from,
        tuple(Point(p["seconds"], relative(p["maxwell"], best), p["unknowns"]) for p in meshes),
        ends,
        tuple(Point(p["seconds"], _width(p), p["unknowns"]) for p in widths if "lower" in p),
        targets,
    )


def relative(maxwell: Array | list[list[float]], best: Array) -> float:
    """Returns the largest relative difference of any entry."""
    return float(np.max(np.abs(np.asarray(maxwell) - best) / np.abs(best)))


def _best(asked: Asked, of: Mapping[str, Document]) -> tuple[Array, float, str]:
    """Returns the best known matrix, its relative error and its source: the truth, or the answer with the smallest stated error."""
    found: list[tuple[float, str, Array]] = []
    if asked.truth is not None:
        found.append((asked.truth_error, "the truth", asked.truth))
    for method in ("tight", "estimate", "enclosure"):
        if method in of:
            value, error = (np.array(of[method][key]) for key in ("value", "error"))
            found.append((float(np.max(error / np.abs(value))), f"the reference's own {method}", value))
    best_to, source, matrix = min(found, key=lambda entry: entry[0])
    return matrix, best_to, source


def _end(row: Document, best: Array) -> Point:
    return Point(row["seconds"], relative(row["value"], best), row["points"][-1]["unknowns"])


def _width(point: Document) -> float:
    lower, upper = np.array(point["lower"]), np.array(point["upper"])
    return float(np.max((upper - lower) / np.abs(upper + lower)))
