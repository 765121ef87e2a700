"""The readings on one mesh: their values, and their background, which is solved on the same mesh without the targets.

What a mesh leaves wrong at the edges of the machine it leaves wrong in both, so that most of it cancels in the change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.bodies.conductors import Conductors, Measured
from fem_reference.solve.cell_gaps import BoundedMatrix, bounded_matrix
from fem_reference.solve.field_problem import Charges, FieldProblem, without_floating
from fem_reference.solve.flux import CondensedCells
from fem_reference.solve.two_sided import Quantities, Shares, TwoSided, two_sided, unit_voltages
from geometries.common.arrays import Array


@dataclass(frozen=True)
class LevelReadings:
    """The readings (n,) on one mesh, in the unit of the matrices, and proven bounds (n, 2) where they were asked for."""

    value: Array
    background: Array
    value_bounds: Array | None = None
    background_bounds: Array | None = None
    change_from_bounds: TwoSided | None = None
    """The changes from both bounds of the readings and of their backgrounds, where these were computed."""

    @property
    def change(self) -> Array:
        return np.asarray(self.value - self.background)

    def scaled(self, factor: float) -> LevelReadings:
        """The readings in another unit."""
        bounds, around, change = self.value_bounds, self.background_bounds, self.change_from_bounds
        return LevelReadings(
            factor * self.value,
            factor * self.background,
            None if bounds is None else factor * bounds,
            None if around is None else factor * around,
            None if change is None else change.scaled(factor),
        )


@dataclass(frozen=True)
class Background:
    """The potentials without the targets; first those of the rows that readings measure, then those of floating conductors."""

    system: FieldProblem
    rows: tuple[int, ...]
    floating: int
    parts: list[list[int]]
    """The bodies of each conductor that stays, in the order of the system's conductors."""
    potentials: list[Array]

    @property
    def maxwell(self) -> Array:
        """The Maxwell matrix of the rows."""
        energies = self.system.energies(self.potentials)
        return without_floating(energies, self.floating, self.system.to_ground)


def background(problem: Conductors, system: FieldProblem) -> Background:
    """Solve for the machine without the targets, in whose place is the medium."""
    is_target = problem.is_target
    rows = _rows(problem.readings)
    count = problem.driven + len(problem.grounded)
    floating = [k for k in range(len(problem.names), problem.driven) if not is_target[k]]
    others = [k for k in range(count) if not is_target[k] and k not in rows and k not in floating]
    order = [*rows, *floating, *others]
    to_ground = system.to_ground
    if len(to_ground):
        to_ground = to_ground[[k - len(problem.names) for k in floating]]
    stay = {
        body: value for body, value in problem.permittivities.items() if not is_target[problem.owner[body]]
    }
    machine = system.with_dielectrics(stay).with_conductors(order, to_ground)
    driven = len(rows) + len(floating)
    parts = [problem.bodies_of(k) for k in order]
    return Background(machine, rows, len(floating), parts, machine.potentials(range(len(order)), driven))


@dataclass(frozen=True)
class Bounded:
    """The bounds of a scene's matrix on one mesh (ε = 1)."""

    cells: CondensedCells
    """The cells by whose fluxes it was bounded."""
    matrix: BoundedMatrix
    alone: BoundedMatrix | None
    """The bounds of the matrix of the sensors alone; None without objects."""
    shares: Shares | None
    """Where in the cells' gaps of wide bounds the true values lie; None if the bounds are narrow, and part of the answer."""

    @property
    def rim_error(self) -> float:
        """The relative effect of the rims of discs on energies: its bound or, beside estimates, its mean."""
        tagged = self.cells.tagged
        return tagged.rim_error if self.shares is None else tagged.mean_rim_error


def level_readings(
    problem: Conductors, system: FieldProblem, found: Charges, known: Bounded | None = None
) -> LevelReadings | None:
    """The readings on one mesh (ε = 1); None if there are none. Their bounds are proven where those that are `known` are narrow.

    The background is bounded too if it is the sensors alone, whose bounds are known, or if the problem says so.
    """
    readings = problem.readings
    if not readings:
        return None
    proven = known is not None and known.shares is None
    value = _values(readings, found.maxwell)
    bounds = _bounds(readings, known.matrix, known.rim_error) if known is not None and proven else None
    if not any(problem.is_target):
        return LevelReadings(value, value, bounds, bounds)
    measured = readings
    if _is_sensors_alone(problem):
        background_value = _values(readings, found.sensors_alone)
        around = None if known is None else known.alone
    else:
        without = background(problem, system)
        measured = tuple(_renumbered(reading, without.rows) for reading in readings)
        background_value = _values(measured, without.maxwell)
        around = None
        if known is not None and problem.bounded_readings:
            around = _bounded_background(problem, without, known.cells)
    if known is None or around is None:
        return LevelReadings(value, background_value, bounds)
    change = _change_from_bounds(readings, known, measured, around)
    around_bounds = None
    if proven and problem.bounded_readings:
        around_bounds = _bounds(measured, around, known.rim_error)
    return LevelReadings(value, background_value, bounds, around_bounds, change)


def _bounded_background(problem: Conductors, without: Background, cells: CondensedCells) -> BoundedMatrix:
    """Bound the matrix without the targets."""
    system = without.system
    # There is a field inside of the targets, which are the medium now.
    bodies = range(len(problem.bodies))
    medium = {k: 1.0 for k in bodies if problem.is_target[problem.owner[k]] and problem.bodies[k].is_solid}
    inside = medium | system.permittivities
    return bounded_matrix(system, cells, without.potentials, without.parts, inside, without.floating)


def _change_from_bounds(
    readings: Sequence[Measured], known: Bounded, measured: Sequence[Measured], around: BoundedMatrix
) -> TwoSided:
    """The changes of readings from the bounds with the targets and from those without, in which the readings are `measured`."""
    rows = _rows(readings)
    chosen = quantities([_renumbered(reading, rows) for reading in readings], len(rows))
    signs = np.array([float(reading.sign) for reading in readings])
    present, absent = known.matrix.of(rows), around.of(_rows(measured))
    return two_sided(chosen.sensed, chosen.driven, present, absent, signs, known.rim_error, known.shares)


def quantities(readings: Sequence[Measured], count: int) -> Quantities:
    """The readings as quantities of a matrix of `count` conductors."""
    return Quantities(
        unit_voltages(count, [[reading.sense] for reading in readings]),
        unit_voltages(count, [reading.drive for reading in readings]),
    )


def _rows(readings: Sequence[Measured]) -> tuple[int, ...]:
    """The rows of the Maxwell matrix that readings measure."""
    return tuple(sorted({k for reading in readings for k in (reading.sense, *reading.drive)}))


def _is_sensors_alone(problem: Conductors) -> bool:
    """Whether what stays are sensors only, so that the background is that of `delta_self`."""
    objects = [*range(problem.sensors, problem.driven)]
    objects += range(problem.driven + problem.grounded_sensors, len(problem.is_target))
    return all(problem.is_target[k] for k in objects)


def _renumbered(reading: Measured, rows: Sequence[int]) -> Measured:
    """The reading of a matrix that has only some of the rows."""
    return Measured(reading.name, rows.index(reading.sense), tuple(rows.index(k) for k in reading.drive))


def _values(readings: Sequence[Measured], maxwell: Array) -> Array:
    """The readings (n,) in a Maxwell matrix."""
    return np.array([r.sign * maxwell[r.sense, list(r.drive)].sum() for r in readings])


def _bounds(readings: Sequence[Measured], matrix: BoundedMatrix, rim_error: float) -> Array:
    """Bounds (n, 2) of the readings, with what curved surfaces change."""
    whole = matrix.with_shift
    return reading_bounds(readings, whole.lower, whole.upper, rim_error)


def reading_bounds(readings: Sequence[Measured], below: Array, above: Array, rim_error: float) -> Array:
    """Bounds (n, 2) of the readings from VᵀLV ≤ VᵀMV ≤ VᵀUV for all voltages V, with L = `below` and U = `above`.

    A reading is aᵀMb with the voltages a, 1 V on what is sensed, and b, 1 V on what is driven. With D = U − L it differs from the mean of
    aᵀLb and aᵀUb by at most ½√(aᵀDa·bᵀDb). `rim_error` is the relative effect of the rims of discs on both energies.
    """
    bounds = []
    for reading in readings:
        voltages = np.zeros((2, len(above)))
        voltages[0, reading.sense] = 1
        voltages[1, list(reading.drive)] = 1
        low, high = (voltages @ form @ voltages.T for form in (below, above))
        gap = np.maximum(np.diag(high) - np.diag(low), 0)
        half = np.sqrt(gap.prod()) / 2 + rim_error * np.sqrt(np.diag(high).prod())
        middle = reading.sign * (low + high)[0, 1] / 2
        bounds.append([middle - half, middle + half])
    return np.array(bounds)
