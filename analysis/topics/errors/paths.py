"""Integrals of 1/L over a rectangle, where L is the length of the field line that an effect puts in the place of the distance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.results.set_up import Rectangle

Array = NDArray[np.float64]

# Length of a semicircle over its diameter: the field lines to a coplanar neighbour (ERRORS.md, section 2).
LATERAL = math.pi / 2
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
    """Computes the length L to a plate over a surface. `model` is the model's module.

    Stretching space by the two factors maps a plate to a plate and L to a distance, so the model's closed form applies; the result
    is divided by the stretch of the area.
    """
    axes, factors = _frame(plate), np.array([stretch.lateral, stretch.lateral, stretch.normal])
    triangles = (surface.vertices[[[0, 1, 2], [0, 2, 3]]] - plate.corner) @ axes.T * factors
    edge_u, edge_v = axes @ plate.edge_u * factors, axes @ plate.edge_v * factors
    values = model.plate_integral(triangles, np.zeros(3), edge_u, edge_v)
    stretched = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    return Integral(float(np.sum(values / stretched) * surface.size**2))


def back(surface: Rectangle, plate: Rectangle, stretch: Stretch) -> Integral:
    """Integrates over the far side of a surface, where L leads around the nearest edge: a half circle to the mirror point outside, then
    L from there."""
    fine, coarse = (_back(surface, plate, stretch, count) for count in (_NODES, _COARSE_NODES))
    return Integral(fine, abs(fine - coarse))


def _back(surface: Rectangle, plate: Rectangle, stretch: Stretch, count: int) -> float:
    places, weights = _graded(count)
    a, b = np.meshgrid(places, places, indexing="ij")
    width, depth = (float(np.linalg.norm(edge)) for edge in (surface.edge_u, surface.edge_v))
    around = [
        (a * width, -a, b),
        ((1 - a) * width, 2 - a, b),
        (b * depth, a, -b),
        ((1 - b) * depth, a, 2 - b),
    ]
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
    return np.array(
        [
            plate.edge_u / np.linalg.norm(plate.edge_u),
            plate.edge_v / np.linalg.norm(plate.edge_v),
            plate.normal,
        ]
    )


def _graded(count: int) -> tuple[Array, Array]:
    """Returns nodes and weights on [0, 1], both halves graded towards their end."""
    nodes, weights = np.polynomial.legendre.leggauss(count)  # type: ignore[no-untyped-call]
    t = (nodes + 1) / 2
    half, slope = t**_GRADING / 2, _GRADING * t ** (_GRADING - 1) / 4
    places = np.concatenate([half, 1 - half[::-1]])
    share = slope * weights
    return places, np.concatenate([share, share[::-1]])
