"""The rows of the table: each value with its stated error and the bounds that two methods prove."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from analysis.results.set_up import Rectangle

MUTUAL, SENSOR, TARGET, DELTA_SELF = "mutual", "self_sensor", "self_target", "delta_self"
QUANTITIES = (MUTUAL, SENSOR, TARGET, DELTA_SELF)


@dataclass(frozen=True)
class Value:
    """Picofarad: the best value with its stated error, and the bounds."""

    best: float
    error: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the width of the interval, relative to the best value."""
        return (self.high - self.low) / (2 * self.best)


@dataclass(frozen=True, eq=False)
class Row:
    """One set-up. `parameters` are those of its family, in metres and degrees; `target` is the plate in the sensor's frame."""

    case: str
    family: str
    parameters: dict[str, float]
    target: Rectangle
    values: dict[str, Value]


def worst_error(found: Iterable[Row]) -> float:
    """Returns the largest relative stated error of the best values."""
    return max(value.error / value.best for row in found for value in row.values.values())
