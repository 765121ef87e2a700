"""Capacitances of thin rectangles by an independent method: uniformly charged panels and collocation.

The method shares nothing with the field solver: no mesh of space, no weak form, no gmsh. The potential of a uniformly charged
rectangle has a closed form in the rectangle's frame (e.g. E. Durand, Électrostatique I, 1964). Panels become narrow towards the edges,
where the charge density grows like r^(−1/2), and the results of two refinements are extrapolated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.constants import epsilon_0

Array = NDArray[np.float64]

COUNTS = (12, 18, 27)
"""Numbers of panels along each side on successive refinements."""


@dataclass(frozen=True)
class Plate:
    """The rectangle corner + a·edge_u + b·edge_v with a and b in [0, 1]; lengths in metres."""

    corner: Array
    edge_u: Array
    edge_v: Array


def maxwell(plates: list[Plate]) -> tuple[Array, Array]:
    """The Maxwell matrix (n, n) in F of plates that are a conductor each, and its error, estimated from the refinements."""
    values = [_maxwell(plates, count) for count in COUNTS]
    # On quadratically graded grids the error is inversely proportional to the square of the number of panels along a side.
    ratio = (COUNTS[-1] / COUNTS[-2]) ** 2
    best = values[-1] + (values[-1] - values[-2]) / (ratio - 1)
    ratio_before = (COUNTS[-2] / COUNTS[-3]) ** 2
    before = values[-2] + (values[-2] - values[-3]) / (ratio_before - 1)
    return best, np.abs(best - before) + 1e-5 * np.abs(best)


def _maxwell(plates: list[Plate], count: int) -> Array:
    t = np.linspace(0, np.pi, count + 1)
    cuts = (1 - np.cos(t)) / 2
    centres, owners, areas = [], [], []
    for k, plate in enumerate(plates):
        middle = (cuts[1:] + cuts[:-1]) / 2
        a, b = np.meshgrid(middle, middle, indexing="ij")
        centres.append(plate.corner + a.reshape(-1, 1) * plate.edge_u + b.reshape(-1, 1) * plate.edge_v)
        size = np.outer(np.diff(cuts), np.diff(cuts)).ravel()
        areas.append(size * np.linalg.norm(np.cross(plate.edge_u, plate.edge_v)))
        owners.append(np.full(count**2, k))
    points, owner, area = np.concatenate(centres), np.concatenate(owners), np.concatenate(areas)
    potential = np.hstack([_potentials(plate, cuts, points) for plate in plates])
    charge = np.linalg.solve(potential, (owner[:, None] == np.arange(len(plates))).astype(float))
    matrix = np.array([(charge[owner == i] * area[owner == i, None]).sum(axis=0) for i in range(len(plates))])
    return 4 * np.pi * epsilon_0 * (matrix + matrix.T) / 2


def _potentials(plate: Plate, cuts: Array, points: Array) -> Array:
    """∫dA/r (points, panels) over each panel of a plate."""
    widths = np.linalg.norm(plate.edge_u), np.linalg.norm(plate.edge_v)
    u, v = plate.edge_u / widths[0], plate.edge_v / widths[1]
    offset = points - plate.corner
    x = cuts[None, :] * widths[0] - (offset @ u)[:, None]
    y = cuts[None, :] * widths[1] - (offset @ v)[:, None]
    z = offset @ np.cross(u, v)
    corner = _primitive(x[:, :, None], y[:, None, :], z[:, None, None])
    panels = corner[:, 1:, 1:] - corner[:, :-1, 1:] - corner[:, 1:, :-1] + corner[:, :-1, :-1]
    return np.asarray(panels.reshape(len(points), -1))


def _primitive(x: Array, y: Array, z: Array) -> Array:
    """F with ∂²F/∂x∂y = 1/√(x² + y² + z²)."""
    r = np.sqrt(x**2 + y**2 + z**2)
    tiny = np.finfo(float).tiny
    # ln(x + r) without cancellation where x is negative.
    along_y = np.where(
        x >= 0,
        np.log(np.maximum(x + r, tiny)),
        np.log(np.maximum(y**2 + z**2, tiny)) - np.log(r - np.minimum(x, 0) + tiny),
    )
    along_x = np.where(
        y >= 0,
        np.log(np.maximum(y + r, tiny)),
        np.log(np.maximum(x**2 + z**2, tiny)) - np.log(r - np.minimum(y, 0) + tiny),
    )
    flat = np.abs(z) < 1e-14
    corner = np.where(flat, 0.0, z * np.arctan(x * y / np.where(flat, 1.0, z * r)))
    return np.asarray(y * along_y + x * along_x - corner)
