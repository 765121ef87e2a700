"""A machine at rest: the potentials of its readings, and how it answers a charge before it. All from boundary elements, once.

With φ and φ' the potentials of a reading's drive and of its sensed conductor at 1 V, everything else grounded, and G the part of the
machine's Green function that the machine adds to 1/r, a grounded probe with the single-layer matrix V changes the reading by
4πε·φ'ᵀ(V − G)⁻¹φ, to which a small one of capacitance C adds C·φ·φ' (model/CORRECTIONS.md, section 8). G is −vᵀM⁻¹v with v the potentials of unit charges on
the machine's panels and M their single-layer matrix. It is of low rank a little away from the machine: G(x, y) = c(x)·c(y).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from geometries.common.errors import InputError

Array = NDArray[np.float64]

FACTOR = 4 * np.pi * 8.8541878128e-12
"""4πε₀ (F/m), CODATA 2018."""
_RTOL_OF_ANSWERS, _PANELS_OF_ANSWERS = 0.15, 1500
"""Accuracy of the panels for the machine's answer to a probe, which is a correction of the probe's own capacitance; and their largest number, about."""
_RIDGE = 1e-4
"""Part of its diagonal that is added to the matrix of panels that coincide, as of bodies that touch with whole faces."""
_LEAST_ENERGY = 1e-6
"""Least energy of an answer that is kept, over that of the largest one."""
_SAMPLE = 900
"""Largest number of points at which the machine's answers are sampled."""


@dataclass(frozen=True)
class Reading:
    """A reading's name, the sign of its value, and the least change that is noticed (F), None if the scene does not say."""

    name: str
    sign: float
    threshold: float | None
    is_proven: bool
    """Whether a body that contains another one changes it more, both grounded: what is sensed is driven."""


class Machine:
    """A machine at rest, without its targets; `scene` is that of the model's Python module, `model` the module."""

    def __init__(self, scene: Any, model: Any, permittivity: float, rtol: float, most_panels: int) -> None:
        """Solves; `most_panels` bounds the time. InputError for what boundary elements refuse, and for a scene without readings."""
        try:
            found = scene.surface_charges(rtol=rtol, most_panels=most_panels)
            coarse = scene.surface_charges(rtol=_RTOL_OF_ANSWERS, most_panels=_PANELS_OF_ANSWERS)
        except ValueError as error:
            raise InputError("", "", str(error)) from error
        self._model = model
        self.panels: Array = found["panels"]
        self._coarse: Array = coarse["panels"]
        self.error: float = found["error"]
        self.factor = FACTOR * permittivity
        charges = np.asarray(found["charges"])
        conductors: list[str] = found["conductors"]
        roles = scene.roles()
        self.readings = tuple(_reading(name, told) for name, told in roles["readings"].items())
        if not self.readings:
            raise InputError("", "", "a machine without sensors or electrodes has no readings")
        floating = _floating(conductors, roles)
        weights = _capacitances(charges, found["conductor_of"], len(conductors))
        senses = np.array([_potentials(conductors, [told["sense"]]) for told in roles["readings"].values()])
        drives = np.array([_potentials(conductors, told["drive"]) for told in roles["readings"].values()])
        self._free = charges[:, floating]
        own = weights[np.ix_(floating, floating)] + np.diag(
            [_to_ground(conductors[f], roles, self.factor) for f in floating]
        )
        for potentials in (senses, drives):
            if floating:
                potentials[:, floating] = -np.linalg.solve(own, weights[floating] @ potentials.T).T
        self._charges = np.concatenate([charges @ senses.T, charges @ drives.T], axis=1)
        self._free = self._free @ np.linalg.cholesky(np.linalg.inv(own)) if floating else self._free
        self._answers: Array = np.zeros((len(self._coarse), 0))

    def prepare(self, points: Array) -> None:
        """Finds the machine's answers to charges about such places as these points (n, 3)."""
        step = max(1, -(-len(points) // _SAMPLE))
        sources = self._model.triangle_potentials(points[::step], self._coarse).astype(np.float64).T
        matrix = self._model.single_layer(self._coarse)
        ridge = 0.0
        while True:
            try:
                lower = linalg.cholesky(
                    matrix + ridge * np.diag(matrix.diagonal()), lower=True, overwrite_a=True
                )
                break
            except linalg.LinAlgError:
                ridge = max(_RIDGE, 10 * ridge)
        answers = linalg.solve_triangular(lower, sources, lower=True)
        # Equal weights for sources near and far.
        answers /= np.linalg.norm(answers, axis=0)
        energies, vectors = linalg.eigh(answers.T @ answers)
        kept = energies > _LEAST_ENERGY * energies[-1]
        basis = answers @ (vectors[:, kept] / np.sqrt(energies[kept]))
        self._answers = linalg.solve_triangular(lower, basis, lower=True, trans="T")

    @property
    def rank(self) -> int:
        """The number of functions that the machine's answers are made of."""
        return self._answers.shape[1]

    def at(self, points: Array) -> tuple[Array, Array, Array, Array]:
        """Returns at points (n, 3) the potentials (n, readings) of what is sensed and of what is driven; the machine's answer (n, rank), whose products
        are −G (1/m); and that of its floating parts, whose products are +G."""
        every = np.concatenate([self._charges, self._free], axis=1).astype(np.float32)
        values = (self._model.triangle_potentials(points, self.panels) @ every).astype(np.float64)
        answers = self._model.triangle_potentials(points, self._coarse) @ self._answers.astype(np.float32)
        count = len(self.readings)
        return (
            values[:, :count],
            values[:, count : 2 * count],
            answers.astype(np.float64),
            values[:, 2 * count :],
        )


def _reading(name: str, told: dict[str, Any]) -> Reading:
    threshold = told["threshold"] or (5 * told["noise"] if told["noise"] else None)
    is_driven = told["sense"] in told["drive"]
    return Reading(name, 1.0 if is_driven else -1.0, threshold, is_driven)


def _potentials(conductors: list[str], driven: list[str]) -> Array:
    return np.array([1.0 if name in driven else 0.0 for name in conductors])


def _floating(conductors: list[str], roles: dict[str, Any]) -> list[int]:
    """Returns the places of the floating conductors."""
    names = {
        body["conductor"] or name
        for name, body in roles["objects"].items()
        if body["potential"] == "floating"
    }
    return [k for k, name in enumerate(conductors) if name in names]


def _to_ground(name: str, roles: dict[str, Any], factor: float) -> float:
    bodies = [body for own, body in roles["objects"].items() if (body["conductor"] or own) == name]
    return float(bodies[0]["to_ground"] or 0.0) / factor


def _capacitances(charges: Array, conductor_of: NDArray[np.int64], count: int) -> Array:
    """Returns the charges on all conductors (rows) with each at unit potential (m)."""
    sums = np.zeros((count, charges.shape[1]))
    np.add.at(sums, conductor_of, charges)
    return sums
