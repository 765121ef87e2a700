"""How some numbers are spread, as topics tell and tabulate it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


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
    return Spread(
        count=len(found),
        median=float(np.median(found)),
        least=float(found.min()),
        greatest=float(found.max()),
        rms=float(np.sqrt((away**2).mean())),
        worst=float(away[np.abs(away).argmax()]),
    )


def range_of(found: Spread | None) -> str:
    """Returns the range of a spread; empty without one."""
    return found.range if found else ""


def ratio(value: float) -> str:
    """Writes a ratio with three digits, or with all before the point."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
