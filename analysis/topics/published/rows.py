"""Computes the rows of the table: each value with its stated error and the bounds that two methods prove."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.results.set_up import Rectangle, rectangles
from analysis.results.store import Document
from analysis.results.units import PICOFARAD
from fem_reference.solve.enclosure import enclosure
from geometries.studies import families
from geometries.studies.study import Case

Array = NDArray[np.float64]

MUTUAL, SENSOR, TARGET, DELTA_SELF = "mutual", "self_sensor", "self_target", "delta_self"
QUANTITIES = (MUTUAL, SENSOR, TARGET, DELTA_SELF)
# Decimals of a bound in pF; it is rounded away from the truth.
_DECIMALS = 6


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


@dataclass(frozen=True)
class Alone:
    """Bounds of the sensor's own capacitance without a target (F)."""

    low: float
    high: float


def lower_matrix(boundary: Document) -> Array:
    """Returns a matrix (n, n) that M exceeds by a positive semidefinite one, farads.

    Galerkin's matrix with exact integrals is one. The quadrature errors are part of the stated errors e[i, j]: the diagonal matrix of
    their row sums is subtracted, which exceeds every symmetric matrix whose entries are at most e[i, j] in size.
    """
    if not all(boundary["lower_bounds"]):
        raise ValueError("the integrals of the boundary elements are not accurate enough for a lower bound")
    error = np.array(boundary["error"])
    return np.asarray(np.array(boundary["maxwell"]) - np.diag(error.sum(axis=1)))


def alone(boundary: Document, upper: Document) -> Alone:
    """Returns the bounds of a sensor alone."""
    return Alone(float(lower_matrix(boundary)[0, 0]), float(upper["upper"][0][0]))


def row(case: Case, boundary: Document, upper: Document, sensor_alone: Alone) -> Row:
    """Returns the row of a set-up; ValueError when a best value is outside its bounds, which would prove an error in one of the two."""
    plates = rectangles(case.scene)
    assert plates is not None
    best, error = np.array(boundary["maxwell"]), np.array(boundary["error"])
    interval = enclosure(lower_matrix(boundary), np.array(upper["upper"]))
    low, high = interval.lower, interval.upper
    change = boundary["delta_self"]["sensor"]
    farads = {
        MUTUAL: (-best[0, 1], error[0, 1], -high[0, 1], -low[0, 1]),
        SENSOR: (best[0, 0], error[0, 0], low[0, 0], high[0, 0]),
        TARGET: (best[1, 1], error[1, 1], low[1, 1], high[1, 1]),
        DELTA_SELF: (change["value"], change["error"], *delta_self_bounds(low, high, sensor_alone)),
    }
    values = {name: _written(*numbers) for name, numbers in farads.items()}
    for name, value in values.items():
        if not value.low <= value.best <= value.high:
            raise ValueError(
                f"{name} of {case.id}, {value.best} pF, is outside {value.low} to {value.high} pF"
            )
    return Row(case.id, case.family, _numbers(case), plates[1], values)


def delta_self_bounds(low: Array, high: Array, sensor_alone: Alone) -> tuple[float, float]:
    """Computes bounds of M[s, s] − C, C being the sensor's capacitance alone, from the bounds of M (2, 2).

    A floating target raises the sensor's capacitance: M[s, s] − mutual²/M[t, t] is at least that of the sensor alone. A grounded
    one lowers the potential everywhere, so that no more charge than alone faces infinity: delta_self is at most mutual.
    """
    least, most = -high[0, 1], -low[0, 1]
    lower = max(low[0, 0] - sensor_alone.high, max(least, 0.0) ** 2 / high[1, 1])
    return float(lower), float(min(high[0, 0] - sensor_alone.low, most))


def half_widths(found: Iterable[Row], quantity: str) -> Array:
    """Returns the half-widths of the intervals of a quantity, relative to the best values."""
    return np.array([row.values[quantity].half_width for row in found])


def worst_error(found: Iterable[Row]) -> float:
    """Returns the largest relative stated error of the best values."""
    return max(value.error / value.best for row in found for value in row.values.values())


def _written(best: float, error: float, low: float, high: float) -> Value:
    """Rounds values to the digits of the table, in pF: bounds outwards, errors upwards."""
    unit = 10.0**-_DECIMALS
    return Value(
        round(float(best) / PICOFARAD, _DECIMALS + 1),
        _upwards(float(error) / PICOFARAD + unit / 20),
        round(math.floor(float(low) / PICOFARAD / unit) * unit, _DECIMALS),
        round(math.ceil(float(high) / PICOFARAD / unit) * unit, _DECIMALS),
    )


def _upwards(error: float) -> float:
    """Rounds up to three digits."""
    digit = 10.0 ** (math.floor(math.log10(error)) - 2)
    return float(f"{math.ceil(error / digit) * digit:.3g}")


def _numbers(case: Case) -> dict[str, float]:
    """Returns the parameters as numbers; a gap that is the same along both axes is one number."""
    numbers: dict[str, float] = {}
    for name, value in case.parameters.items():
        if name == "sensor_size" or name in families.USUAL or isinstance(value, str):
            continue
        if name == "target_size" and isinstance(value, tuple):
            numbers |= {"target_x": value[0], "target_y": value[1]}
        elif isinstance(value, tuple):
            assert value[0] == value[1]
            numbers[name] = value[0]
        else:
            numbers["gap" if name == "hinge_gap" else name] = value
    return numbers
