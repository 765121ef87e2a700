"""Right angles of plates. The operations are those of the C++ reader, one by one, so that both give the same bits."""

from __future__ import annotations

import math

from geometries.scene.poses import Vector3
from geometries.scene.scene import Plate

# Largest |cos| of the angle between a plate's edges that is rounding: coordinates with ten digits leave less.
LARGEST_COSINE_OF_ROUNDING = 1e-9
# Largest |cos| of edges that are squared: drawings state coordinates with six digits, which leave some 1e-5.
LARGEST_COSINE_SQUARED = 1e-4


def cosine_between_edges(plate: Plate) -> float:
    """Returns the cosine of the angle between a plate's edges, which must not have length zero."""
    return _dot(_polar(plate.edge_u)[0], _polar(plate.edge_v)[0])


def squared(plate: Plate) -> Plate:
    """Returns the plate with its edges at right angles: each is turned by half of what is missing, and keeps its length."""
    (u, length_u), (v, length_v) = _polar(plate.edge_u), _polar(plate.edge_v)
    # The diagonals of a rhombus are at right angles, and halve the angles between its sides.
    along, across = _polar(_sum(u, v))[0], _polar(_sum(u, _times(-1.0, v)))[0]
    half = math.sqrt(0.5)
    return Plate(
        plate.corner,
        _times(length_u, _times(half, _sum(along, across))),
        _times(length_v, _times(half, _sum(along, _times(-1.0, across)))),
    )


def _polar(vector: Vector3) -> tuple[Vector3, float]:
    """Returns direction and length. Divides by the largest coordinate first, so that nothing under- or overflows."""
    x, y, z = vector
    largest = max(abs(x), abs(y), abs(z))
    scaled = (x / largest, y / largest, z / largest)
    length = math.sqrt(_dot(scaled, scaled))
    return (scaled[0] / length, scaled[1] / length, scaled[2] / length), largest * length


def _dot(a: Vector3, b: Vector3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _sum(a: Vector3, b: Vector3) -> Vector3:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _times(factor: float, vector: Vector3) -> Vector3:
    return factor * vector[0], factor * vector[1], factor * vector[2]
