"""The model's error as a sum of named parts, by integrals of 1/L over a rectangle, where L is the length of the field line that an effect puts in the place of
the distance. Definitions and derivation: ERRORS.md."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.constants import epsilon_0

from analysis.results.answers import Estimate
from analysis.results.set_up import Rectangle
from analysis.results.store import Document
from analysis.results.table import DELTA_SELF, MUTUAL
from geometries.common.arrays import Array

SEMICIRCLE = math.pi / 2
"""Length of a semicircle over its diameter: the field lines to a coplanar neighbour (ERRORS.md, section 2)."""
# Nodes along half a side, of the rule and of the coarser rule that estimates its error.
_NODES, _COARSE_NODES = 28, 20
# The integrand is steep at the edges: the nodes are graded towards them with this power.
_GRADING = 3


@dataclass(frozen=True)
class Stretch:
    """L = √((normal·z)² + (lateral·l)²): z is the height above the plate's plane, l the distance beside its outline."""

    normal: float
    lateral: float


@dataclass(frozen=True)
class Integral:
    """∫dA/L (m) with its quadrature error, which is 0 for closed forms."""

    value: float
    error: float = 0.0


def arc_over_chord(surface: Rectangle, plate: Rectangle) -> float:
    """Returns θ/sin θ for the angle θ between two planes, 0 … 90 degrees."""
    sine = float(np.linalg.norm(np.cross(surface.normal, plate.normal)))
    angle = math.atan2(sine, abs(float(surface.normal @ plate.normal)))
    return angle / math.sin(angle) if angle > 0 else 1.0


def front(model: Any, surface: Rectangle, plate: Rectangle, stretch: Stretch) -> Integral:
    """Computes the length L to a plate over a surface. `model` is the model's module. Stretching space by the two factors maps a
    plate to a plate and L to a distance, so the model's closed form applies; the result is divided by the stretch of the area.
    """
    axes, factors = _frame(plate), np.array([stretch.lateral, stretch.lateral, stretch.normal])
    triangles = (surface.vertices[[[0, 1, 2], [0, 2, 3]]] - plate.corner) @ axes.T * factors
    edge_u, edge_v = axes @ plate.edge_u * factors, axes @ plate.edge_v * factors
    values = model.plate_integral(triangles, np.zeros(3), edge_u, edge_v)
    sides = triangles[:, 1:] - triangles[:, :1]
    stretched = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return Integral(float(np.sum(values / stretched) * surface.size**2))


def back(surface: Rectangle, plate: Rectangle, stretch: Stretch) -> Integral:
    """Integrates over the far side of a surface, where L leads around the nearest edge: a half circle to the mirror point outside, then
    L from there."""
    fine, coarse = (_back(surface, plate, stretch, count) for count in (_NODES, _COARSE_NODES))
    return Integral(fine, abs(fine - coarse))


def _back(surface: Rectangle, plate: Rectangle, stretch: Stretch, count: int) -> float:
    nodes, of_nodes = np.polynomial.legendre.leggauss(count)  # type: ignore[no-untyped-call]
    t = (nodes + 1) / 2
    # Nodes and weights on [0, 1], both halves graded towards their end.
    half, share = t**_GRADING / 2, _GRADING * t ** (_GRADING - 1) / 4 * of_nodes
    places, weights = np.concatenate([half, 1 - half[::-1]]), np.concatenate([share, share[::-1]])
    a, b = np.meshgrid(places, places, indexing="ij")
    width, depth = (float(np.linalg.norm(edge)) for edge in (surface.edge_u, surface.edge_v))
    around = [(a * width, -a, b), ((1 - a) * width, 2 - a, b)]
    around += [(b * depth, a, -b), ((1 - b) * depth, a, 2 - b)]
    lengths = [math.pi * inside + _length(surface, plate, stretch, u, v) for inside, u, v in around]
    return float(weights @ (1 / np.min(lengths, axis=0)) @ weights) * surface.size**2


def _length(surface: Rectangle, plate: Rectangle, stretch: Stretch, u: Array, v: Array) -> Array:
    """Computes L from the points corner + u·edge_u + v·edge_v to the plate."""
    points = surface.corner + u[..., None] * surface.edge_u + v[..., None] * surface.edge_v
    local = (points - plate.corner) @ _frame(plate).T
    ends = [float(np.linalg.norm(edge)) for edge in (plate.edge_u, plate.edge_v)]
    beside = [local[..., axis] - np.clip(local[..., axis], 0, end) for axis, end in enumerate(ends)]
    lateral = stretch.lateral * np.hypot(*beside)
    return np.asarray(np.hypot(stretch.normal * local[..., 2], lateral))


def _frame(plate: Rectangle) -> Array:
    """Returns the unit vectors along the plate's edges and its normal, as rows."""
    along = [edge / np.linalg.norm(edge) for edge in (plate.edge_u, plate.edge_v)]
    return np.array([*along, plate.normal])


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

    @staticmethod
    def read(document: Document) -> Split:
        """Reads a stored split."""
        effects = {name: Part(**part) for name, part in document["effects"].items()}
        return Split(document["model"], document["corrected"], document["error"], effects)


@dataclass(frozen=True)
class Truth:
    """The Maxwell matrix's entries of one sensor and one target, and delta_self; F."""

    mutual: Estimate
    delta_self: Estimate
    target_own: Estimate

    @staticmethod
    def read(document: Document) -> Truth:
        """Reads a stored truth."""
        return Truth(**{name: Estimate(**value) for name, value in document.items()})

    @staticmethod
    def of(solved: dict[str, Any], sensor: str) -> Truth:
        """Returns the truth in what boundary elements answer of a sensor, which comes first, and a target."""
        matrix, errors, alone = solved["maxwell"], solved["error"], solved["delta_self"][sensor]
        mutual = Estimate(-float(matrix[0][1]), float(errors[0][1]))
        own = Estimate(float(matrix[1][1]), float(errors[1][1]))
        return Truth(mutual, Estimate(float(alone["value"]), float(alone["error"])), own)


def split(model: Any, sensor: Rectangle, target: Rectangle) -> Split:
    """Computes the contributions of all effects in a set-up of two plates. `model` is the model's module."""
    arc = arc_over_chord(target, sensor)
    choices = (itertools.combinations(EFFECTS, count) for count in range(len(EFFECTS) + 1))
    corrected = [frozenset(chosen) for some in choices for chosen in some]
    values = {chosen: _value(model, sensor, target, arc, chosen) for chosen in corrected}
    return Split(
        model=values[frozenset()].value,
        corrected=values[frozenset(EFFECTS)].value,
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


def _value(model: Any, sensor: Rectangle, target: Rectangle, arc: float, chosen: Effects) -> Integral:
    """Computes `mutual` (F) by the formula, with the chosen effects corrected."""
    stretch = Stretch(arc if TILT in chosen else 1.0, SEMICIRCLE if LATERAL in chosen else 1.0)

    def one_way(surface: Rectangle, plate: Rectangle) -> Integral:
        near = front(model, surface, plate, stretch)
        behind = back(surface, plate, stretch) if BACK in chosen else Integral(0.0)
        return Integral(near.value + behind.value, behind.error)

    to_sensor = one_way(target, sensor)
    if RECIPROCITY not in chosen:
        return Integral(epsilon_0 * to_sensor.value, epsilon_0 * to_sensor.error)
    to_target = one_way(sensor, target)
    mean = math.sqrt(to_sensor.value * to_target.value)
    relative = (to_sensor.error / to_sensor.value + to_target.error / to_target.value) / 2
    return Integral(epsilon_0 * mean, epsilon_0 * mean * relative)
