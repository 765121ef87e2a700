"""A machine at rest: the potentials of its readings, and how it answers a charge before it. All from boundary elements, once.

With φ and φ' the potentials of a reading's drive and of its sensed conductor at 1 V, everything else grounded, and G the part of the
machine's Green function that the machine adds to 1/r, a grounded probe with the single-layer matrix V changes the reading by
4πε·φ'ᵀ(V − G)⁻¹φ, to which a small one of capacitance C adds C·φ·φ' (model/CORRECTIONS.md, section 8). G is of low rank a little away from the
machine: G(x, y) = c(x)·c(y), c the potentials of charges on its surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometries.common.errors import InputError

Array = NDArray[np.float64]

FACTOR = 4 * np.pi * 8.8541878128e-12
"""4πε₀ (F/m), CODATA 2018."""


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

    def __init__(self, scene: Any, permittivity: float, rtol: float, most_panels: int, parts: int) -> None:
        """Solves; `most_panels` and `parts` bound the time. InputError for what boundary elements refuse, and for a scene without readings."""
        try:
            self._potentials = scene.machine_potentials(rtol=rtol, most_panels=most_panels, functions=parts)
        except ValueError as error:
            raise InputError("", "", str(error)) from error
        self.panels: int = self._potentials.panels
        self.error: float = self._potentials.error
        self.factor = FACTOR * permittivity
        known = scene.roles()["readings"].items()
        self.readings = tuple(
            _reading(name, told, sign)
            for (name, told), (_, _, sign) in zip(known, self._potentials.readings, strict=True)
        )
        self._senses = [sense for sense, _, _ in self._potentials.readings]
        self._drives = [drive for _, drive, _ in self._potentials.readings]
        self._answers = np.zeros((0, 0), np.float32)

    def prepare(self, points: Array) -> None:
        """Finds the machine's answers to charges about such places as these points (n, 3)."""
        self._answers = self._potentials.answers(points)

    def changes(
        self,
        points: Array,
        potentials: Array,
        rotations: Array,
        translations: Array,
        to_ground: float | None,
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Returns the changes of all readings (n, readings) in F by a body in so many poses, and whether it clears the machine (n,).

        The body is points (p, 3) that stand for it with the matrix of their `potentials` by charges (1/m), grounded or connected to ground through a
        capacitance (F); `rotations` (n, 3, 3) and `translations` (n, 3) map its frame to the world.
        """
        share = None if to_ground is None else to_ground / self.factor
        found, clears = self._potentials.changes(
            points, potentials, rotations, translations, self._answers, share
        )
        return self.factor * found, clears

    def potentials(self, points: Array) -> tuple[Array, Array]:
        """Returns at points (n, 3) the potentials (n, readings) of what is sensed and of what is driven."""
        loads = self._potentials.at(points)
        return loads[:, self._senses].astype(np.float64), loads[:, self._drives].astype(np.float64)


def _reading(name: str, told: dict[str, Any], sign: float) -> Reading:
    threshold = told["threshold"] or (5 * told["noise"] if told["noise"] else None)
    return Reading(name, sign, threshold, told["sense"] in told["drive"])
