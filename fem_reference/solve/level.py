"""One level of the refinement: a scene's Maxwell matrix, and its bounds, on one mesh."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from fem_reference.solve.body_charges import body_charges
from fem_reference.solve.cell_gaps import BoundedMatrix, bounded_matrix
from fem_reference.solve.enclosure import Enclosure, enclosure, widened
from fem_reference.solve.flux import CondensedCells
from fem_reference.common.limits import peak_memory
from fem_reference.mesh.tagged_mesh import TaggedMesh, tagged_mesh
from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.marks import Marks, marks
from fem_reference.mesh.sizing import Sizing
from fem_reference.solve.field_problem import Charges, FieldProblem, charges, release_unused
from fem_reference.common.stages import stage
from fem_reference.bodies.symmetry import Plane
from fem_reference.solve.parts_of_errors import parts_of_errors, parts_of_estimates
from fem_reference.solve.readings import LevelReadings, level_readings, quantities
from fem_reference.solve.shares import estimated, shares_by_kind
from fem_reference.solve.two_sided import TwoSided, two_sided

Array = NDArray[np.float64]

Bounds = Literal["none", "estimate", "enclosure"]
"""Which bounds to compute on a level: none, wide ones in which the values are estimated, or narrow ones that are part of the answer."""

FLUX_DEGREE = 3
"""Degree of the Raviart–Thomas fluxes. Degree 3 matches the cubic potentials: on the square plate the lower bound is then about as
far from the true value as the upper one, at four times the time of the potentials. Degree 2 is three to four times farther off at a
third of the time; degree 4 takes three times as long for two thirds of the distance."""
ESTIMATE_DEGREE = 2
"""Degree of the fluxes by which a level is estimated: the bounds are some 0.5 to 2 % wide on the coarsest level, and take half of the
time of the potentials. With degree 1 no flux is left in quarter-point cells."""


@dataclass(frozen=True)
class Level:
    """The solution on one mesh; matrices in farads, `edge_size` in metres: that at the edges of the smallest body, or the smallest adapted one."""

    edge_size: float
    unknowns: int
    cells: int
    seconds: float
    maxwell: Array
    sensors_alone: Array
    delta_self: Array
    memory: int = 0
    """The most memory (bytes) the process had held when the level was done."""
    flux_seconds: float = 0.0
    """The share of `seconds` that the bounds took."""
    enclosure: Enclosure | None = None
    """Proven bounds of the Maxwell matrix, when asked for."""
    check: Enclosure | None = None
    """Wider proven bounds, by fluxes of lower degree, against which an estimated answer is checked."""
    estimated: tuple[Array, Array] | None = None
    """The Maxwell matrix between these bounds, and its estimated error."""
    body_charges: tuple[Array, ...] = ()
    """For each conductor with a row the charges (members, n) on its bodies; empty if each conductor is one body."""
    readings: LevelReadings | None = None
    """The readings, if there are any."""
    delta_self_from_bounds: TwoSided | None = None
    """`delta_self` from both bounds of both scenes, where there are narrow ones."""
    marks: Marks | None = None
    """What the cells add to the relative errors of the entries and changes, where there are narrow bounds."""


def solve_level(
    problem: Conductors,
    relative_permittivity: float,
    sizing: Sizing,
    bounds: Bounds,
    planes: Sequence[Plane] = (),
    only_readings: bool = False,
) -> Level:
    """Mesh and solve once, on one side of the planes of symmetry. With `only_readings` the marks are those of readings and their changes.

    Raises RuntimeError when the mesher or the solver fails, or when bounds are asked for and contradict each other.
    """
    start = time.monotonic()
    mesh = tagged_mesh(
        problem.bodies,
        problem.owner,
        sizing,
        dielectrics=problem.permittivities,
        planes=planes,
        room=problem.room,
        grounded=[
            k for number in range(len(problem.grounded)) for k in problem.bodies_of(problem.driven + number)
        ],
    )
    farads = epsilon_0 * relative_permittivity * problem.unit * mesh.copies
    solved = _solved(problem, mesh, farads, bounds, planes, only_readings)
    found = solved.charges
    release_unused(mesh.mesh.comm)
    smallest = min(body.size for body in problem.bodies)
    edge_size = sizing.edge * smallest / sizing.refinement
    if sizing.adapted is not None and len(sizing.adapted.sizes):
        edge_size = float(sizing.adapted.sizes.min())
    end = time.monotonic()
    level = Level(
        edge_size * problem.unit,
        found.unknowns,
        mesh.cell_count,
        end - start,
        farads * found.maxwell,
        farads * found.sensors_alone,
        farads * np.diag(found.maxwell[: problem.sensors, : problem.sensors] - found.sensors_alone),
        peak_memory(),
        end - solved.done,
        solved.interval if bounds == "enclosure" else None,
        solved.interval if bounds == "estimate" else None,
        None if solved.between is None else (farads * solved.between[0], farads * solved.between[1]),
        tuple(farads * own for own in solved.on_bodies),
        None if solved.readings is None else solved.readings.scaled(farads),
        None if solved.delta_self is None else solved.delta_self.scaled(farads),
        solved.marks,
    )
    # All processes go on with the numbers of the first, to the last digit: these decide what all of them do next.
    if mesh.mesh.comm.size > 1:
        level = mesh.mesh.comm.bcast(level)
    return level


@dataclass(frozen=True)
class _Solved:
    """What one mesh yields (ε = 1, but for the interval); without bounds only the first three and the readings."""

    charges: Charges
    on_bodies: tuple[Array, ...]
    """The charges on the bodies of each conductor."""
    done: float
    """When all charges were known (s), on the monotonic clock."""
    readings: LevelReadings | None
    interval: Enclosure | None = None
    """Bounds of the Maxwell matrix (F)."""
    delta_self: TwoSided | None = None
    """`delta_self` from the bounds."""
    marks: Marks | None = None
    between: tuple[Array, Array] | None = None
    """The Maxwell matrix between wide bounds, and its estimated error."""


def _solved(
    problem: Conductors,
    mesh: TaggedMesh,
    farads: float,
    bounds: Bounds,
    planes: Sequence[Plane],
    only_readings: bool,
) -> _Solved:
    """Solve for the charges and, if asked for, their bounds, and for the readings.

    The matrices are local to this function, so that `release_unused` can free them afterwards.
    """
    system = FieldProblem(mesh, problem.parts, problem.permittivities, problem.to_ground)
    found = charges(
        system, problem.sensors, len(problem.floating), len(problem.grounded), problem.grounded_sensors
    )
    on_bodies = body_charges(problem, system, found.potentials, planes)
    done = time.monotonic()
    if bounds == "none":
        return _Solved(found, on_bodies, done, level_readings(problem, system, found))
    with stage("bounding the energies"):
        cells = CondensedCells(mesh, ESTIMATE_DEGREE if bounds == "estimate" else FLUX_DEGREE)
        matrix = _bounded(problem, system, found.potentials, cells)
        whole = matrix.with_shift
        interval = widened(enclosure(farads * whole.lower, farads * whole.upper), mesh.rim_error)
        shares = shares_by_kind(mesh, problem.bodies) if bounds == "estimate" else None
        rim_error = mesh.rim_error if shares is None else mesh.mean_rim_error
        alone = _bounded_alone(problem, system, found.potentials_alone, cells)
        readings = level_readings(problem, system, found, cells, matrix, alone, shares)
        from_bounds = None
        if alone is not None:
            of_sensors, sensors = matrix.of(range(problem.sensors)), np.eye(problem.sensors)
            from_bounds = two_sided(sensors, sensors, of_sensors, alone, 1.0, rim_error, shares)
        changes = [
            None if only_readings else from_bounds,
            None if readings is None else readings.change_from_bounds,
        ]
        asked = quantities(problem.readings, len(problem.names), only_readings)
        known = [each for each in changes if each is not None]
        between = None
        if shares is None:
            parts = parts_of_errors(whole, asked, rim_error, known)
        else:
            likely = estimated(matrix, shares)
            parts = parts_of_estimates(likely, asked, rim_error, known)
            own = np.diag(likely.value)
            between = likely.value, likely.error + rim_error * np.sqrt(np.outer(own, own))
            readings = (
                None if readings is None else replace(readings, value_bounds=None, background_bounds=None)
            )
        marked = marks(problem.bodies, problem.owner, *mesh.corners(), parts.of_cells, parts.whole)
    return _Solved(found, on_bodies, done, readings, interval, from_bounds, marked, between)


def _bounded(
    problem: Conductors, system: FieldProblem, potentials: list[Array], cells: CondensedCells
) -> BoundedMatrix:
    """Bound the matrix of the scene, without floating conductors."""
    return bounded_matrix(
        system, cells, potentials, problem.parts, problem.permittivities, len(problem.floating)
    )


def _bounded_alone(
    problem: Conductors, system: FieldProblem, potentials: list[Array] | None, cells: CondensedCells
) -> BoundedMatrix | None:
    """The same for the sensors that are asked for, without any objects; None if there are none."""
    if potentials is None:
        return None
    others = range(problem.driven, problem.driven + problem.grounded_sensors)
    parts = [problem.bodies_of(k) for k in (*range(problem.sensors), *others)]
    present = {body for part in parts for body in part}
    # There is a field inside of the objects, which are the medium here.
    medium = {k: 1.0 for k, body in enumerate(problem.bodies) if body.is_solid and k not in present}
    return bounded_matrix(system.with_dielectrics({}), cells, potentials, parts, medium)
