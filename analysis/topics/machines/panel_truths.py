"""What grounded targets change in the readings of a machine, from charges on thousands of panels of both.

The targets' charges q solve S·q = φ: φ are the potentials on the targets of what is sensed or driven, and S is the targets' single-layer matrix less what the machine answers. φ nearly vanishes behind a
housing, and comes from fine panels of the machine alone; S is the Schur complement of one single-layer matrix of fewer panels of the machine and the targets' own (model/CORRECTIONS.md section 8).
Boundary elements of machine and targets together state errors of changes ten times as large in the same time, since there a change is the difference of two solutions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import linalg
from scipy.spatial import cKDTree

from analysis.pipeline.model_stage import model_module
from analysis.results.units import VACUUM_PERMITTIVITY
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

Array = NDArray[np.float64]

_NODES = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
"""Barycentric coordinates of a rule of equal weights on a triangle, exact for quadratic polynomials (Strang and Fix, 1973)."""
_ACCURACY, _MOST_STEPS = 1e-5, 400
"""Where the iteration for the charges ends: the residual over the potentials, in the norm of its preconditioner."""
_MOST_IN_BLOCK = 400
"""Panels whose matrix is inverted as the preconditioner, near to each other."""
_LEAST_DISTANCE = 0.03
"""Distance in m from what is sensed or driven below which panels of targets are not made smaller: a third of a sensor."""
_COARSER = 1.2
"""Factor of the panels' sizes where they would be too many."""
_PARTS = 300
"""Parts of the machine's surface, which count as points far away; its answers in them are not used."""
_CONTACT = "the charges of machine and targets were not found: they touch or overlap"


@dataclass(frozen=True)
class Resolution:
    """How finely a machine and its targets are divided: `rtol` and most panels for the potentials that the machine makes, panels from which those of its answer are refined, size of a target's panels
    over their distance from what is sensed or driven, and the most panels of machine and targets together, with which they become larger.
    """

    rtol: float
    machine_panels: int
    answer_panels: int
    relative_size: float
    most_panels: int


COARSE = Resolution(8e-3, 12_500, 300, 0.7, 10_000)
FINE = Resolution(4e-3, 25_000, 1000, 0.5, 18_000)
FINEST = Resolution(4e-3, 50_000, 1000, 0.5, 18_000)
"""For a machine that does not move, which is solved once."""

ERROR_PER_ENERGY = 0.4
"""Error of a change, relative, over the stated error of the energies of the machine's charges. Twice the panels, 50,000, altered the changes before an arm of 5,000 overlapping triangles by 1.1 % rms
and 2.4 % at most, where 5.1 % were stated."""


class Targets:
    """The targets of a scene on panels, all grounded and on the same link, or on none."""

    def __init__(self, scene: Scene, panels: int = 2000) -> None:
        """Divides the targets into about so many panels, which are divided further where they come near; ValueError where there are none, where one floats and where they are on several links."""
        bodies = [each for each in scene.objects if each.target]
        links = {each.link for each in bodies}
        if len(links) != 1 or any(each.potential != "grounded" for each in bodies):
            raise ValueError("the targets must be grounded and on one link")
        (self.link,) = links
        at_origin = tuple(replace(each, link=None) for each in bodies)
        alone = model_module().Scene.loads(canonical(Scene(medium=scene.medium, objects=at_origin)))
        self.names = tuple(each.name for each in bodies)
        self.permittivity = scene.medium.relative_permittivity
        self.panels: Array = alone.surface_charges(rtol=1e-3, most_panels=panels)["panels"]


class Machine:
    """The machine of a scene in one pose, without its targets; `live` is the scene of the model's Python module."""

    def __init__(self, live: Any, targets: Targets, resolution: Resolution) -> None:
        alone = live.copy()
        for name in targets.names:
            alone.hide(name)
        self._resolution = resolution
        self._potentials = alone.machine_potentials(
            rtol=resolution.rtol, most_panels=resolution.machine_panels, functions=_PARTS
        )
        self._factor = 4 * np.pi * VACUUM_PERMITTIVITY * targets.permittivity
        self.error: float = self._potentials.error
        """Largest stated error of the energies of what is sensed or driven, relative."""
        readings = alone.roles()["readings"]
        self._names = tuple(readings)
        charges = alone.surface_charges(rtol=1e-3, most_panels=resolution.answer_panels)
        self._panels: Array = charges["panels"]
        used = {reading["sense"] for reading in readings.values()}.union(
            *(reading["drive"] for reading in readings.values())
        )
        places = [place for place, name in enumerate(charges["conductors"]) if name in used]
        self._used: Array = self._panels[np.isin(charges["conductor_of"], places)].reshape(-1, 3)

    def changes(self, targets: Targets, pose: Array) -> dict[str, float]:
        """Returns the change of every reading in F by the targets, whose link is in this pose (4, 4) in the world; ArithmeticError where they reach into the machine."""
        panels = self._divided(targets.panels @ pose[:3, :3].T + pose[:3, 3])
        nodes = np.einsum("ij,njk->nik", _NODES, panels)
        loads, _ = self._potentials.at(nodes.reshape(-1, 3))
        loads = loads.reshape(len(panels), len(_NODES), -1).mean(axis=1, dtype=np.float64)
        both = np.concatenate([panels, self._panels])
        right = np.zeros((len(both), loads.shape[1]))
        right[: len(panels)] = loads
        charges = _solved(both, right)[: len(panels)]
        return {
            name: float(self._factor * sign * (loads[:, sense] @ charges[:, drive]))
            for name, (sense, drive, sign) in zip(self._names, self._potentials.readings, strict=True)
        }

    def _divided(self, panels: Array) -> Array:
        """Returns panels of targets in the world, divided until they are small beside their distance from what is sensed or driven, or larger ones if these were too many."""
        tree, relative_size = cKDTree(self._used), self._resolution.relative_size
        while True:
            parts = panels
            while len(parts) + len(self._panels) <= self._resolution.most_panels:
                sizes = np.linalg.norm(parts - np.roll(parts, 1, axis=1), axis=2).max(axis=1)
                distances = tree.query(parts.mean(axis=1))[0] - sizes / 2
                large = sizes > relative_size * (distances.clip(0) + _LEAST_DISTANCE)
                if not large.any():
                    return parts
                parts = np.concatenate([parts[~large], _quarters(parts[large])])
            if relative_size > 1e3:
                raise ValueError(
                    f"most_panels {self._resolution.most_panels} are fewer than the {len(panels) + len(self._panels)} of machine and targets"
                )
            relative_size *= _COARSER


def _quarters(panels: Array) -> Array:
    """Returns the four parts of each triangle (n, 3, 3) between its corners and the middles of its sides, (4n, 3, 3)."""
    a, b, c = panels[:, 0], panels[:, 1], panels[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    four = [np.stack(corners, axis=1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (bc, ca, ab))]
    return np.asarray(np.stack(four, axis=1).reshape(-1, 3, 3))


def _blocks(centres: Array, members: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Returns groups of at most `_MOST_IN_BLOCK` panels, halved at the median along their longest extent."""
    if len(members) <= _MOST_IN_BLOCK:
        return [members]
    axis = np.ptp(centres[members], axis=0).argmax()
    halves = np.array_split(members[centres[members, axis].argsort()], 2)
    return [block for half in halves for block in _blocks(centres, half)]


def _solved(panels: Array, potentials: Array) -> Array:
    """Returns the charges (n, k) of panels, over 4πε, at potentials (n, k), by conjugate gradients for all columns at once, preconditioned by the inverses of nearby panels' blocks."""
    matrix = model_module().single_layer(panels, 1e-4)
    scales = 1 / np.sqrt(np.diagonal(matrix))
    matrix *= scales[:, None]
    matrix *= scales
    # Single precision halves the time; what it leaves is far below what the panels do.
    scaled = matrix.astype(np.float32)
    del matrix
    try:
        factors = [
            (block, linalg.cho_factor(scaled[np.ix_(block, block)]))
            for block in _blocks(panels.mean(axis=1), np.arange(len(panels)))
        ]
    except linalg.LinAlgError as error:
        raise ArithmeticError(_CONTACT) from error

    def preconditioned(residual: Array) -> Array:
        result = np.empty_like(residual)
        for block, factor in factors:
            result[block] = linalg.cho_solve(factor, residual[block])
        return result

    rest = (scales[:, None] * potentials).astype(np.float32)
    charges = np.zeros_like(rest)
    steps = preconditioned(rest)
    products = np.einsum("nk,nk->k", rest, steps)
    enough = _ACCURACY**2 * products
    for _ in range(_MOST_STEPS):
        felt = scaled @ steps
        energies = np.einsum("nk,nk->k", steps, felt)
        if not (energies > 0).all():
            break
        lengths = products / energies
        charges += lengths * steps
        rest -= lengths * felt
        following = preconditioned(rest)
        before, products = products, np.einsum("nk,nk->k", rest, following)
        if (products <= enough).all():
            return np.asarray(scales[:, None] * charges, np.float64)
        steps = following + products / before * steps
    raise ArithmeticError(_CONTACT)
