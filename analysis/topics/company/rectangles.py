"""Charges on plates and boxes by collocation on graded rectangles: what the candidates of a formula in company prepare once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from geometries.scene.poses import Vector3

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Cells:
    """Rectangles, as `centres` (n, 3), unit vectors (n, 3, 3) along their sides and the normal, and half sides (n, 2), in metres."""

    centres: Array
    axes: Array
    halves: Array

    @property
    def count(self) -> int:
        return len(self.centres)


def joined(parts: Iterable[Cells]) -> Cells:
    """Returns the cells of all parts, in their order."""
    found = list(parts)
    return Cells(
        np.concatenate([each.centres for each in found]),
        np.concatenate([each.axes for each in found]),
        np.concatenate([each.halves for each in found]),
    )


def rectangle(centre: Array, u: Array, v: Array, per_side: int) -> Cells:
    """Divides a rectangle with half sides u and v into `per_side`² cells, finer at its borders as the charge of an edge asks."""
    ends = -np.cos(np.linspace(0.0, pi, per_side + 1))
    middles, widths = (ends[1:] + ends[:-1]) / 2, (ends[1:] - ends[:-1]) / 2
    x, y = (each.ravel() for each in np.meshgrid(middles, middles, indexing="ij"))
    a, b = (each.ravel() for each in np.meshgrid(widths, widths, indexing="ij"))
    lengths = np.linalg.norm(u), np.linalg.norm(v)
    first, second = u / lengths[0], v / lengths[1]
    axes = np.array([first, second, np.cross(first, second)])
    return Cells(
        centre + x[:, None] * u + y[:, None] * v,
        np.broadcast_to(axes, (len(x), 3, 3)),
        np.column_stack([a * lengths[0], b * lengths[1]]),
    )


def box(centre: Vector3, size: Vector3, rotation: Array, per_side: int) -> Cells:
    """Divides the six faces of a box, turned by `rotation` (3, 3), into `per_side`² cells each."""
    halves = rotation * (np.asarray(size) / 2)
    faces = []
    for axis in range(3):
        u, v = halves[:, (axis + 1) % 3], halves[:, (axis + 2) % 3]
        faces += [rectangle(np.asarray(centre) + sign * halves[:, axis], u, v, per_side) for sign in (-1, 1)]
    return joined(faces)


def potentials(points: Array, cells: Cells) -> Array:
    """Returns 4πε times the potential at points (rows) of a unit charge spread evenly over each cell (columns), in 1/m.

    The integral of 1/r over a rectangle is, corner by corner, u ln(v + r) + v ln(u + r) − w atan(uv/(wr)).
    """
    local = np.einsum("nij,pnj->pni", cells.axes, points[:, None] - cells.centres)
    height = np.abs(local[..., 2])
    total = np.zeros(local.shape[:2])
    for i in (-1, 1):
        for j in (-1, 1):
            u, v = local[..., 0] + i * cells.halves[:, 0], local[..., 1] + j * cells.halves[:, 1]
            r = np.sqrt(u * u + v * v + height * height)
            total += i * j * (_logarithm(u, v, height, r) + _logarithm(v, u, height, r))
            total -= i * j * height * np.arctan2(u * v, height * r)
    result: Array = total / (4 * cells.halves[:, 0] * cells.halves[:, 1])
    return result


def energies(cells: Cells) -> Array:
    """Returns the symmetric matrix of potentials at the cells' centres of charges on the cells (1/m)."""
    matrix = potentials(cells.centres, cells)
    symmetric: Array = (matrix + matrix.T) / 2
    return symmetric


def _logarithm(factor: Array, v: Array, height: Array, r: Array) -> Array:
    """Returns factor·ln(v + r), without the cancellation for negative v."""
    others = factor * factor + height * height
    safe = np.where(v < 0, others / np.maximum(r - v, np.finfo(float).tiny), v + r)
    result: Array = factor * np.log(np.maximum(safe, np.finfo(float).tiny))
    return result
