"""Candidates of a formula that knows company: what a grounded target changes, from the potential φ of the readings' drives on it.

The machine is prepared once, at rest: its charges per volt on each driven conductor, all else grounded, by collocation on a few
hundred rectangles, and the factors of its matrix. With b the potential that the machine alone has on the target and S the target's
matrix with the machine grounded, the change of a reading is b_sense·S⁻¹·b_drive exactly (Green's second identity). The candidates differ in what they take for S and
for the space of the target's charges. All of them are symmetric in sense and drive, none has a fitted constant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from analysis.results.units import VACUUM_PERMITTIVITY
from analysis.topics.company.rectangles import Array, Cells, box, energies, joined, potentials, rectangle
from geometries.scene.scene import Object, Reading, Scene
from geometries.scene.shapes import Cuboid, PlateShape

MACHINE_CELLS, TARGET_CELLS = 10, 4
"""Cells per side of a face, of the machine's bodies and of the target: 96 cells on a box. With 3, the condenser is lost at gaps below a cell."""
_COULOMB = 4 * pi * VACUUM_PERMITTIVITY
_ROUNDING = 1e-12
"""Part of a charge's energy that rounding may leave."""


class MachineAtRest:
    """The machine of a scene, without its targets: its cells, conductors and the factors of its matrix.

    Raises ValueError for a machine that has bodies other than plates and boxes, floating bodies or links, or whose matrix is not
    positive definite (numpy.linalg.LinAlgError): then nothing is known of its potentials.
    """

    def __init__(self, scene: Scene, per_side: int = MACHINE_CELLS) -> None:
        if scene.links:
            raise ValueError("the machine has links: its potentials are known only at rest")
        names: list[str] = []
        parts: list[Cells] = []
        for sensor in scene.sensors:
            for plate in sensor.plates:
                u, v = np.asarray(plate.edge_u) / 2, np.asarray(plate.edge_v) / 2
                parts.append(rectangle(np.asarray(plate.corner) + u + v, u, v, per_side))
                names += [sensor.name] * parts[-1].count
        for body in scene.objects:
            if not body.target:
                if body.potential == "floating":
                    raise ValueError(f'"{body.name}" floats')
                parts.append(cells_of(body, per_side))
                names += [body.conductor or body.name] * parts[-1].count
        self.cells = joined(parts)
        self.conductors = np.array(names)
        self._factors = cho_factor(energies(self.cells))

    def charges(self, driven: tuple[str, ...]) -> Array:
        """Returns the charges on the cells with these conductors at 1 V and all others grounded, over 4πε (m)."""
        return self.answer(np.isin(self.conductors, driven).astype(float))

    def answer(self, values: Array) -> Array:
        """Returns the charges that make these potentials on the cells (rows)."""
        result: Array = cho_solve(self._factors, values)
        return result


@dataclass(frozen=True, eq=False)
class Company:
    """A target before a machine at rest, and one reading. `to_machine` (target's cells, machine's cells) are the potentials at
    the target's cells of unit charges on the machine's."""

    machine: MachineAtRest
    target: Cells
    reading: Reading
    to_machine: Array

    @cached_property
    def own(self) -> Array:
        """The inverse of the target's own matrix: it depends on the target alone, hence is prepared once."""
        result: Array = np.linalg.inv(energies(self.target))
        return result

    @cached_property
    def potentials(self) -> Array:
        """The potentials (target's cells, 2) with the sensed conductor at 1 V, and with the driven ones."""
        charges = np.column_stack(
            [self.machine.charges((self.reading.sense,)), self.machine.charges(self.reading.drive)]
        )
        result: Array = self.to_machine @ charges
        return result

    def answered(self, charges: Array) -> Array:
        """Returns minus the potentials on the target that the grounded machine's charges answer with to the target's."""
        result: Array = self.to_machine @ self.machine.answer(self.to_machine.T @ charges)
        return result


def company(
    scene: Scene, machine: MachineAtRest, target: str, reading: Reading, per_side: int = TARGET_CELLS
) -> Company:
    """Returns the target of that name before the machine. Raises ValueError unless the target is a grounded plate or box."""
    body = next(each for each in scene.objects if each.name == target)
    if body.potential != "grounded":
        raise ValueError(f'"{target}" is not grounded')
    cells = cells_of(body, per_side)
    return Company(machine, cells, reading, potentials(cells.centres, machine.cells))


def cells_of(body: Object, per_side: int) -> Cells:
    """Divides the surface of a plate or box that stands on the world. Raises ValueError for other bodies."""
    if body.link is not None:
        raise ValueError(f'"{body.name}" is on a link: the potentials are known only at rest')
    rotation, centre = body.pose.rotation.matrix(), np.asarray(body.pose.translation)
    if isinstance(body.shape, Cuboid):
        return box(body.pose.translation, body.shape.size, rotation, per_side)
    if isinstance(body.shape, PlateShape):
        x, y = body.shape.size
        return rectangle(centre, rotation[:, 0] * x / 2, rotation[:, 1] * y / 2, per_side)
    raise ValueError(f'"{body.name}" is neither a plate nor a box')


def far(given: Company) -> float:
    """C·φ_sense·φ_drive: the target's own charge keeps its distribution, and φ is its mean by that charge."""
    own = given.own.sum(axis=1)
    sense, drive = own @ given.potentials / own.sum()
    return float(_COULOMB * own.sum() * sense * drive)


def isolated(given: Company) -> float:
    """b_sense·P⁻¹·b_drive, P the target's matrix alone: its charge is displaced, the machine's answer to it is left out."""
    sense, drive = given.potentials.T
    return float(_COULOMB * (sense @ given.own @ drive))


def answered(given: Company, steps: int = 1) -> float:
    """The energy in the space of the first charges, P⁻¹·b of sense and drive, and of `steps` − 1 answers of target and machine to each other.

    These are conjugate gradients for S, preconditioned by the target's own matrix, for both readings at a time.
    """
    own = np.linalg.inv(given.own)
    last = given.own @ given.potentials
    space = np.zeros((len(last), 0))
    for _ in range(steps):
        # The parts of a charge that earlier ones span already, and rounding, are left out.
        last = last - space @ (space.T @ own @ last)
        values, vectors = np.linalg.eigh(last.T @ own @ last)
        kept = values > _ROUNDING * np.trace(last.T @ own @ last)
        space = np.column_stack([space, last @ vectors[:, kept] / np.sqrt(values[kept])])
        last = given.own @ given.answered(space)
    form = np.eye(space.shape[1]) - space.T @ given.answered(space)
    sense, drive = (space.T @ given.potentials).T
    return float(_COULOMB * (sense @ np.linalg.solve((form + form.T) / 2, drive)))


CANDIDATES: dict[str, Callable[[Company], float]] = {
    "far": far,
    "isolated": isolated,
    "answered once": answered,
    "answered twice": lambda given: answered(given, 2),
    "answered four times": lambda given: answered(given, 4),
}
"""The candidates by name, from the cheapest to the one that leaves out only what is smaller than a cell."""
