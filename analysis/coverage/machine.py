"""A machine at rest and a probe before it: how the probe changes the readings, all from boundary elements solved once for each.

With φ and φ' the potentials of a reading's drive and of its sensed conductor at 1 V, everything else grounded, and G the part of the
machine's Green function that the machine adds to 1/r, a grounded probe with the single-layer matrix V changes the reading by
4πε·φ'ᵀ(V − G)⁻¹φ, to which a small one of capacitance C adds C·φ·φ' (model/CORRECTIONS.md, section 8). G is of low rank a little away from the
machine: G(x, y) = c(x)·c(y), c the potentials of charges on its surface.

Potentials of charges that are not too near are harmonic within the probe, and hence given on all its panels by their values at a few of
them, T: V − G on the panels becomes W⁻¹ − G on these points, W = Tᵀ V⁻¹ T (interpolative decomposition)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import linalg

from analysis.coverage.places import Probe
from analysis.results.units import VACUUM_PERMITTIVITY
from geometries.common.arrays import Array, Flags, Indices
from geometries.common.errors import InputError
from geometries.scene.scene import Object, Scene
from geometries.scene.writer import canonical

_RTOL, _PANELS, _FUNCTIONS = 0.004, 12000, 600
"""Accuracy of the machine's own charges, its most panels, and the most functions that stand for its answers."""
_PROBE_RTOL, _PROBE_PANELS = 3e-3, 2000
"""Accuracy of the probe's own charge, and its most panels, about."""
_CLEARANCES = (0.06, 0.25, 0.8, 2.5, 8.0)
"""Distances of the nearest charges for which the points of a level suffice, over half the size of the probe."""
_TOLERANCE = 1e-3
"""Error of the interpolated potentials, over the largest ones."""
_MOST_POINTS = 64


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


@dataclass(frozen=True)
class Reading:
    """A reading's name, the sign of its value, and the least change that is noticed (F), None if the scene does not say."""

    name: str
    sign: float
    threshold: float | None
    is_proven: bool
    """Whether a body that contains another one changes it more, both grounded: what is sensed is driven."""


class Machine:
    """A machine at rest, without its targets; `scene` is that of the model's Python module."""

    def __init__(self, scene: Any, permittivity: float) -> None:
        """Solves. InputError for what boundary elements refuse, and for a scene without readings."""
        try:
            self._potentials = scene.machine_potentials(rtol=_RTOL, most_panels=_PANELS, functions=_FUNCTIONS)
        except ValueError as error:
            raise InputError("", "", str(error)) from error
        self.panels: int = self._potentials.panels
        self.error: float = self._potentials.error
        self._factor = 4 * np.pi * VACUUM_PERMITTIVITY * permittivity
        known = zip(scene.roles()["readings"].items(), self._potentials.readings, strict=True)
        self.readings = tuple(_reading(name, told, sign) for (name, told), (_, _, sign) in known)
        self._answers = np.zeros((0, 0), np.float32)

    def prepare(self, points: Array) -> None:
        """Finds the machine's answers to charges about such places as these points (n, 3)."""
        self._answers = self._potentials.answers(points)

    def changes(
        self, level: Level, rotations: Array, translations: Array, to_ground: float | None
    ) -> tuple[Array, Flags]:
        """Returns the changes of all readings (n, readings) in F by a probe in so many poses, and whether it clears the machine (n,).
        `rotations` (n, 3, 3) and `translations` (n, 3) map the probe's frame to the world; the probe is grounded, or else connected to ground
        through a capacitance (F), 0 if insulated."""
        share = None if to_ground is None else to_ground / self._factor
        posed = level.points, level.inverse, rotations, translations
        found, clears = self._potentials.changes(*posed, self._answers, share)
        return self._factor * found, clears

    def small_changes(
        self, level: Level, rotations: Array, translations: Array, to_ground: float | None
    ) -> Array:
        """Returns the changes as if the probe were small: its own capacitance times the potentials at the middle of its charge."""
        own = level.charges.sum()
        middle = level.charges @ level.points / own
        middles = np.einsum("nij,j->ni", rotations, middle) + translations
        loads = self._potentials.at(middles).astype(np.float64)
        senses, drives, signs = zip(*self._potentials.readings)
        if to_ground is not None:
            share = to_ground / self._factor
            own = own * share / (own + share)
        return np.asarray(self._factor * own * loads[:, senses] * loads[:, drives] * signs)


def _reading(name: str, told: dict[str, Any], sign: float) -> Reading:
    threshold = told["threshold"] or (5 * told["noise"] if told["noise"] else None)
    return Reading(name, sign, threshold, told["sense"] in told["drive"])


def respond(probe: Probe, model: Any) -> Response:
    """Solves the probe by itself."""
    alone = canonical(Scene(objects=(Object("probe", probe.shape),)))
    panels = model.Scene.loads(alone).surface_charges(rtol=_PROBE_RTOL, most_panels=_PROBE_PANELS)["panels"]
    centres = panels.mean(axis=1)
    middle = (centres.min(axis=0) + centres.max(axis=0)) / 2
    size = float(np.linalg.norm(centres - middle, axis=1).max())
    found = [_interpolated(centres, _outside(share * size, centres, middle, size)) for share in _CLEARANCES]
    spreads = np.hstack([spread for _, spread in found])
    charges = linalg.solve(model.single_layer(panels), spreads, assume_a="pos")
    levels = []
    for share, (chosen, spread) in zip(_CLEARANCES, found):
        own, charges = spread.T @ charges[:, : len(chosen)], charges[:, len(chosen) :]
        own = (own + own.T) / 2
        levels.append(Level(share * size, centres[chosen], np.linalg.inv(own), own.sum(axis=1)))
    return Response(probe, tuple(levels))


def _interpolated(centres: Array, outside: Array) -> tuple[Indices, Array]:
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
