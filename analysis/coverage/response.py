"""How a probe changes the readings of a machine at rest: its own charge problem on a few points, in the field of the machine.

The probe's panels have the single-layer matrix V. Potentials of charges that are not too near are harmonic within the probe, and hence given on
all panels by their values at a few of them, T: V − G on the panels becomes W⁻¹ − G on these points, W = Tᵀ V⁻¹ T (interpolative decomposition).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from analysis.coverage.machine import Machine
from analysis.coverage.probes import Probe

Array = NDArray[np.float64]

_CLEARANCES = (0.06, 0.25, 0.8, 2.5, 8.0)
"""Distances of the nearest charges for which the points of a level suffice, over half the size of the probe."""
_TOLERANCE = 1e-3
"""Error of the interpolated potentials, over the largest ones."""
_MOST_POINTS = 64
_RTOL, _PROBE_PANELS = 3e-3, 2000
"""Accuracy of the probe's own charge, and its most panels, about."""


@dataclass(frozen=True)
class Level:
    """The points (p, 3) that stand for a probe where the machine is at least `clearance` away, the inverse of W (1/m), and the `charges` on
    the points of the probe alone at a potential of 1 (p,), in m."""

    clearance: float
    points: Array
    inverse: Array
    charges: Array


@dataclass(frozen=True)
class Response:
    """A probe's levels, the nearest first."""

    probe: Probe
    levels: tuple[Level, ...]

    def level(self, distance: float) -> Level:
        """Returns the level for a distance from the machine (m): the one of the fewest points that suffices."""
        fitting = [level for level in self.levels if level.clearance <= distance]
        return fitting[-1] if fitting else self.levels[0]


def respond(probe: Probe, model: Any) -> Response:
    """Solves the probe by itself."""
    scene = model.Scene.loads(f'[[object]]\nname = "probe"\nshape = {{ {probe.text} }}\n')
    panels = scene.surface_charges(rtol=_RTOL, most_panels=_PROBE_PANELS)["panels"]
    return respond_on(panels, probe, model, _CLEARANCES)


def respond_on(panels: Array, probe: Probe, model: Any, clearances: tuple[float, ...]) -> Response:
    """Solves the probe by itself on panels (n, 3, 3), for levels at these clearances over half its size."""
    centres = panels.mean(axis=1)
    middle = (centres.min(axis=0) + centres.max(axis=0)) / 2
    size = float(np.linalg.norm(centres - middle, axis=1).max())
    found = [_interpolated(centres, _outside(share * size, centres, middle, size)) for share in clearances]
    spreads = np.hstack([spread for _, spread in found])
    charges = linalg.solve(model.single_layer(panels), spreads, assume_a="pos")
    levels = []
    for share, (chosen, spread) in zip(clearances, found):
        own, charges = spread.T @ charges[:, : len(chosen)], charges[:, len(chosen) :]
        own = (own + own.T) / 2
        levels.append(Level(share * size, centres[chosen], np.linalg.inv(own), own.sum(axis=1)))
    return Response(probe, tuple(levels))


def _interpolated(centres: Array, outside: Array) -> tuple[NDArray[np.int64], Array]:
    """Returns the numbers (p,) of the panels whose potentials by charges `outside` give those of all (n,), and the matrix T (n, p) that does it."""
    potentials = 1 / np.linalg.norm(centres[:, None] - outside, axis=2)
    potentials = np.column_stack([potentials / np.abs(potentials).max(axis=0), np.ones(len(centres))])
    triangular, order = linalg.qr(potentials.T, mode="r", pivoting=True)
    diagonal = np.abs(triangular.diagonal())
    count = int(min(_MOST_POINTS, max(1, np.sum(diagonal > _TOLERANCE * diagonal[0]))))
    spread = np.empty((len(centres), count))
    spread[order] = linalg.solve_triangular(triangular[:count, :count], triangular[:count]).T
    return order[:count], spread


def _outside(clearance: float, centres: Array, middle: Array, size: float) -> Array:
    """Returns points in all directions at some distances from the probe, this one the nearest."""
    chance = np.random.default_rng(1)
    found = []
    for factor in (1.0, 2.0, 4.0, 8.0):
        start = centres[chance.integers(len(centres), size=120)]
        direction = chance.normal(size=(120, 3))
        points = start + factor * clearance * direction / np.linalg.norm(direction, axis=1, keepdims=True)
        nearest = np.linalg.norm(points[:, None] - centres, axis=2).min(axis=1)
        found.append(points[nearest > 0.9 * factor * clearance])
    far = chance.normal(size=(40, 3))
    found.append(middle + 4 * (size + clearance) * far / np.linalg.norm(far, axis=1, keepdims=True))
    return np.concatenate(found)


def changes(
    machine: Machine, level: Level, rotations: Array, translations: Array, to_ground: float | None
) -> tuple[Array, NDArray[np.bool_]]:
    """Returns the changes of all readings (n, readings) in F in so many poses, and whether the probe clears the machine (n,).

    `rotations` (n, 3, 3) and `translations` (n, 3) map the probe's frame to the world; the probe is grounded, or else connected to ground through a capacitance (F), 0
    if insulated.
    """
    return machine.changes(level.points, level.inverse, rotations, translations, to_ground)
