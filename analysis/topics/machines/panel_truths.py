"""What grounded targets change in the readings of a machine, from charges on thousands of panels of either.

The targets' charges solve (V − G)·q = φ, with V the single-layer matrix of their panels, φ the potentials there of what is sensed or driven, and G how the machine answers (analysis/coverage/machine.py,
model/CORRECTIONS.md section 8). Boundary elements of machine and targets together state errors of changes ten times as large in the same time, since a change is the difference of two solutions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from analysis.pipeline.model_stage import model_module
from analysis.results.units import VACUUM_PERMITTIVITY
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

Array = NDArray[np.float64]

_NODES = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
"""Barycentric coordinates of a rule of equal weights on a triangle, exact for quadratic polynomials (Strang and Fix, 1973)."""
_ACCURACY, _MOST_STEPS = 1e-5, 200
"""Where the iteration for the charges ends: the residual over the potentials, in the norm of the targets' own energy."""


@dataclass(frozen=True)
class Resolution:
    """How finely a machine and its targets are divided: `rtol` of the machine's charges, most panels of either, functions of the machine's answer."""

    rtol: float
    machine_panels: int
    functions: int
    target_panels: int


COARSE = Resolution(8e-3, 12_500, 600, 1500)
FINE = Resolution(4e-3, 25_000, 1000, 3000)
FINEST = Resolution(4e-3, 50_000, 1000, 3000)
"""For a machine that does not move, which is solved once."""

ERROR_PER_ENERGY = 0.4
"""Error of a change, relative, over the stated error of the energies of the machine's charges. Twice the panels, 50,000, altered the changes before an arm of 5,000 overlapping triangles by 1.1 % rms
and 2.4 % at most, where 5.1 % were stated."""


class Targets:
    """The targets of a scene on panels, all grounded and on the same link, or on none."""

    def __init__(self, scene: Scene, resolution: Resolution) -> None:
        """Solves for the targets by themselves; ValueError where there are none, where one floats and where they are on several links."""
        bodies = [each for each in scene.objects if each.target]
        links = {each.link for each in bodies}
        if len(links) != 1 or any(each.potential != "grounded" for each in bodies):
            raise ValueError("the targets must be grounded and on one link")
        (self.link,) = links
        at_origin = tuple(replace(each, link=None) for each in bodies)
        alone = model_module().Scene.loads(canonical(Scene(medium=scene.medium, objects=at_origin)))
        panels = alone.surface_charges(rtol=1e-4, most_panels=resolution.target_panels)["panels"]
        self.names = tuple(each.name for each in bodies)
        self.permittivity = scene.medium.relative_permittivity
        self.nodes: Array = np.einsum("ij,njk->nik", _NODES, panels)
        self._own: Array = model_module().single_layer(panels, 1e-5)
        self._factor = linalg.cho_factor(self._own)

    def __len__(self) -> int:
        return len(self.nodes)

    def charges(self, potentials: Array, answers: Array) -> Array:
        """Returns the charges (panels, k), over 4πε, at these potentials (panels, k), the machine answering by answers·answersᵀ (panels, rank).

        Conjugate gradients, preconditioned by the targets by themselves; ArithmeticError if the targets reach into the machine.
        """
        charges = np.zeros_like(potentials)
        rest = potentials.copy()
        steps = linalg.cho_solve(self._factor, rest)
        products = np.einsum("nk,nk->k", rest, steps)
        enough = _ACCURACY**2 * products
        for _ in range(_MOST_STEPS):
            felt = self._own @ steps - answers @ (answers.T @ steps)
            energies = np.einsum("nk,nk->k", steps, felt)
            if not (energies > 0).all():
                break
            lengths = products / energies
            charges += lengths * steps
            rest -= lengths * felt
            following = linalg.cho_solve(self._factor, rest)
            before, products = products, np.einsum("nk,nk->k", rest, following)
            if (products <= enough).all():
                return charges
            steps = following + products / before * steps
        raise ArithmeticError("the charges of the targets were not found: they reach into the machine")


class Machine:
    """The machine of a scene in one pose, without its targets; `live` is the scene of the model's Python module."""

    def __init__(self, live: Any, targets: Targets, resolution: Resolution) -> None:
        alone = live.copy()
        for name in targets.names:
            alone.hide(name)
        self._potentials = alone.machine_potentials(
            rtol=resolution.rtol, most_panels=resolution.machine_panels, functions=resolution.functions
        )
        self._factor = 4 * np.pi * VACUUM_PERMITTIVITY * targets.permittivity
        self.error: float = self._potentials.error
        """Largest stated error of the energies of what is sensed or driven, relative."""
        self._names = tuple(alone.roles()["readings"])
        self._modes: Array = linalg.cholesky(self._potentials.answers, lower=True)

    def changes(self, targets: Targets, pose: Array) -> dict[str, float]:
        """Returns the change of every reading in F by the targets, whose link is in this pose (4, 4) in the world."""
        points = targets.nodes.reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]
        loads, parts = (
            values.reshape(len(targets), len(_NODES), -1).mean(axis=1, dtype=np.float64)
            for values in self._potentials.at(points)
        )
        charges = targets.charges(loads, parts @ self._modes)
        return {
            name: float(self._factor * sign * (loads[:, sense] @ charges[:, drive]))
            for name, (sense, drive, sign) in zip(self._names, self._potentials.readings, strict=True)
        }
