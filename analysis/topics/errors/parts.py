"""The model's error as a sum of named parts. Definitions and derivation: ERRORS.md."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from scipy.constants import epsilon_0

from analysis.results.answers import Estimate
from analysis.results.set_up import Rectangle
from analysis.results.table import DELTA_SELF, MUTUAL
from analysis.topics.errors import paths

TILT, LATERAL, BACK, RECIPROCITY = "tilt", "lateral path", "missing back side", "size and reciprocity"
EFFECTS = (TILT, LATERAL, BACK, RECIPROCITY)
QUANTITY, REST = "another quantity", "rest"
PARTS = {MUTUAL: (*EFFECTS, REST), DELTA_SELF: (*EFFECTS, QUANTITY, REST)}
"""The parts of each quantity, in the order in which they are shown."""

Effects = frozenset[str]


@dataclass(frozen=True)
class Part:
    """The contribution of one effect to the model's value (F): its mean over all orders in which the effects can be corrected, and the
    least and the greatest."""

    value: float
    least: float
    greatest: float


@dataclass(frozen=True)
class Split:
    """`model` is the formula as it stands, `corrected` with every effect corrected, both for `mutual` (F);
    `error` is the quadrature error of `corrected` and the parts."""

    model: float
    corrected: float
    error: float
    effects: dict[str, Part]


@dataclass(frozen=True)
class Truth:
    """The Maxwell matrix's entries of one sensor and one target, and delta_self; F."""

    mutual: Estimate
    delta_self: Estimate
    target_own: Estimate

    @staticmethod
    def of(solved: dict[str, Any], sensor: str) -> Truth:
        """Returns the truth in what boundary elements answer of a sensor, which comes first, and a target."""
        matrix, errors, alone = solved["maxwell"], solved["error"], solved["delta_self"][sensor]
        return Truth(
            mutual=Estimate(-float(matrix[0][1]), float(errors[0][1])),
            delta_self=Estimate(float(alone["value"]), float(alone["error"])),
            target_own=Estimate(float(matrix[1][1]), float(errors[1][1])),
        )


def split(model: Any, sensor: Rectangle, target: Rectangle) -> Split:
    """Computes the contributions of all effects in a set-up of two plates. `model` is the model's module."""
    values = _values(model, sensor, target)
    everything = values[frozenset(EFFECTS)]
    return Split(
        model=values[frozenset()].value,
        corrected=everything.value,
        error=max(value.error for value in values.values()),
        effects=shares(EFFECTS, lambda effects: values[effects].value),
    )


def shares(names: Iterable[str], value: Callable[[Effects], float]) -> dict[str, Part]:
    """Computes Shapley values: by how much each name lowers `value` when it joins, over all orders of joining. The means add up to
    value(none) − value(all)."""
    known = tuple(names)
    changes: dict[str, list[float]] = {name: [] for name in known}
    for order in itertools.permutations(known):
        joined: Effects = frozenset()
        for name in order:
            changes[name].append(value(joined) - value(joined | {name}))
            joined |= {name}
    return {name: Part(math.fsum(all_) / len(all_), min(all_), max(all_)) for name, all_ in changes.items()}


def parts(found: Split, truth: Truth, quantity: str) -> dict[str, float]:
    """Returns the parts (F) of model − truth, which add up to it except for rounding."""
    named = {name: part.value for name, part in found.effects.items()}
    if quantity == DELTA_SELF:
        named[QUANTITY] = truth.mutual.value - truth.delta_self.value
    return named | {REST: found.corrected - truth.mutual.value}


def uncertainty(found: Split, truth: Truth, name: str) -> float:
    """Returns the error of a part (F), from the truth's error and the quadrature's."""
    if name == QUANTITY:
        return truth.mutual.error + truth.delta_self.error
    return found.error + (truth.mutual.error if name == REST else 0.0)


def drawn_from_infinity(truth: Truth) -> float:
    """Returns the part (F) of `another quantity` due to the charge that a grounded target draws from infinity."""
    return truth.mutual.value * (1 - truth.mutual.value / truth.target_own.value)


def polarisation(truth: Truth) -> float:
    """Returns the part (F, negative) of `another quantity` due to polarisation: a floating target raises the sensor's capacitance too."""
    return truth.mutual.value**2 / truth.target_own.value - truth.delta_self.value


def _values(model: Any, sensor: Rectangle, target: Rectangle) -> dict[Effects, paths.Integral]:
    """Computes `mutual` (F) by the formula, for each choice of effects that are corrected."""
    arc = paths.arc_over_chord(target, sensor)
    found = {}
    for count in range(len(EFFECTS) + 1):
        for chosen in itertools.combinations(EFFECTS, count):
            found[frozenset(chosen)] = _value(model, sensor, target, arc, frozenset(chosen))
    return found


def _value(model: Any, sensor: Rectangle, target: Rectangle, arc: float, chosen: Effects) -> paths.Integral:
    stretch = paths.Stretch(arc if TILT in chosen else 1.0, paths.LATERAL if LATERAL in chosen else 1.0)
    to_sensor = _one_way(model, target, sensor, stretch, BACK in chosen)
    if RECIPROCITY not in chosen:
        return paths.Integral(epsilon_0 * to_sensor.value, epsilon_0 * to_sensor.error)
    to_target = _one_way(model, sensor, target, stretch, BACK in chosen)
    mean = math.sqrt(to_sensor.value * to_target.value)
    relative = (to_sensor.error / to_sensor.value + to_target.error / to_target.value) / 2
    return paths.Integral(epsilon_0 * mean, epsilon_0 * mean * relative)


def _one_way(
    model: Any, surface: Rectangle, plate: Rectangle, stretch: paths.Stretch, both_sides: bool
) -> paths.Integral:
    near = paths.front(model, surface, plate, stretch)
    if not both_sides:
        return near
    behind = paths.back(surface, plate, stretch)
    return paths.Integral(near.value + behind.value, behind.error)
