"""An adaptive quadrature over triangles for functions with kinks, such as the length of the shortest of several paths."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from analysis.report.plot_of_parts import areas

Array = NDArray[np.float64]

# Error of each triangle's integral, relative to its value at a distance of the triangle's own size.
_TOLERANCE = 1e-3
# Halvings of a side: those that are always made, and the limit, which is reached near contact: 4^7 parts.
_FIRST_LEVEL, _MOST_LEVELS = 2, 7


def adaptive_integral(triangles: Array, function: Callable[[Array], Array]) -> float:
    """Computes ∫f dA over triangles (n, 3, 3) by a rule of degree 2. f maps points (m, 3) to values (m,).

    Divides a triangle by halving its sides until this changes its integral by no more than 1e-3 of the root of its area.
    """
    parts = triangles
    allowed = _TOLERANCE * np.sqrt(areas(parts))
    for _ in range(_FIRST_LEVEL):
        parts, allowed = quarters(parts), np.repeat(allowed / 2, 4)
    values = _rule(parts, function)
    total = 0.0
    for level in range(_FIRST_LEVEL, _MOST_LEVELS + 1):
        divided = quarters(parts)
        of_quarters = _rule(divided, function).reshape(-1, 4)
        sums = of_quarters.sum(axis=1)
        done = np.abs(sums - values) <= allowed
        if level == _MOST_LEVELS:
            done[:] = True
        total += float(sums[done].sum())
        if done.all():
            break
        parts = divided.reshape(-1, 4, 3, 3)[~done].reshape(-1, 3, 3)
        values = of_quarters[~done].ravel()
        allowed = np.repeat(allowed[~done] / 2, 4)
    return total


def _rule(parts: Array, function: Callable[[Array], Array]) -> Array:
    """Returns each triangle's integral by the three points halfway from its centroid to its corners."""
    points = (parts.sum(axis=1, keepdims=True) + 3 * parts) / 6
    return np.asarray(areas(parts) / 3 * function(points.reshape(-1, 3)).reshape(-1, 3).sum(axis=1))


def quarters(parts: Array) -> Array:
    """Returns the four parts of each triangle (n, 3, 3) between its corners and the middles of its sides, (4n, 3, 3)."""
    a, b, c = parts[:, 0], parts[:, 1], parts[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    four = [np.stack(corners, axis=1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (bc, ca, ab))]
    return np.asarray(np.stack(four, axis=1).reshape(-1, 3, 3))
