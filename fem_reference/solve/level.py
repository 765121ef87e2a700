"""One level of the refinement: a scene's Maxwell matrix, and its bounds, on one mesh, and the charges on the bodies of each conductor."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from mpi4py import MPI
from scipy.constants import epsilon_0
from scipy.spatial import cKDTree

from fem_reference.solve.cell_gaps import bounded_matrix
from fem_reference.solve.enclosure import Enclosure, enclosure, widened
from fem_reference.solve.flux import CondensedCells
from fem_reference.common.limits import peak_memory, stage
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.marks import Marks, marks
from fem_reference.mesh.sizing import Sizing, size_at_edges
from fem_reference.solve.field_problem import Charges, FieldProblem, charges, release_unused, with_floating
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.shapes import Body
from fem_reference.bodies.symmetry import Plane, orbits
from fem_reference.bodies.wrapping import Wrap, member_names, spread_points
from fem_reference.mesh.body_distances import surface_distance
from fem_reference.solve.two_sided import (
    TwoSided,
    entries,
    estimated,
    parts_of_errors,
    parts_of_estimates,
    shares_by_kind,
    two_sided,
)
from fem_reference.solve.readings import Bounded, LevelReadings, level_readings, quantities
from geometries.common.arrays import Array

Bounds = Literal["none", "estimate", "enclosure"]
"""Which bounds to compute on a level: none, wide ones in which the values are estimated, or narrow ones that are part of the answer."""

AS_NEAR = 1e-6
"""Difference of the distances, over the scene's unit of length, up to which a place is as near to one body as to another."""

FLUX_DEGREE = 3
"""Degree of the Raviart–Thomas fluxes. Degree 3 matches the cubic potentials: on the square plate the lower bound is then about as
far from the true value as the upper one, at four times the time of the potentials. Degree 2 is three to four times farther off at a
third of the time; degree 4 takes three times as long for two thirds of the distance."""
ESTIMATE_DEGREE = 2
"""Degree of the fluxes by which a level is estimated: the bounds are some 0.5 to 2 % wide on the coarsest level, and take half of the
time of the potentials. With degree 1 no flux is left in quarter-point cells."""


@dataclass(frozen=True)
class LevelBounds:
    """What the bounds of the energies tell on one mesh; farads."""

    interval: Enclosure
    """Proven bounds of the Maxwell matrix."""
    likely: tuple[Array, Array] | None
    """The Maxwell matrix between wide bounds, and its estimated error; None between narrow ones, which are part of the answer themselves."""
    delta_self: TwoSided | None
    """`delta_self` from both bounds of both scenes; None without objects."""
    marks: Marks
    """What the cells add to the relative errors of the entries and changes."""


@dataclass(frozen=True)
class Level:
    """The solution on one mesh; matrices in farads, `edge_size` in metres: that at the edges of the smallest body, or the smallest adapted one."""

    edge_size: float
    unknowns: int
    cells: int
    maxwell: Array
    sensors_alone: Array
    delta_self: Array
    body_charges: tuple[Array, ...] = ()
    """For each conductor with a row the charges (members, n) on its bodies; empty if each conductor is one body."""
    readings: LevelReadings | None = None
    """The readings, if there are any."""
    bounds: LevelBounds | None = None
    """What the bounds tell, if any were asked for."""
    seconds: float = 0.0
    flux_seconds: float = 0.0
    """The share of `seconds` that the bounds took."""
    memory: int = 0
    """The most memory (bytes) the process had held when the level was done."""

    @property
    def enclosure(self) -> Enclosure | None:
        """Proven bounds of the Maxwell matrix that are part of the answer."""
        return None if self.bounds is None or self.bounds.likely is not None else self.bounds.interval

    @property
    def estimated(self) -> tuple[Array, Array] | None:
        """The Maxwell matrix between wide bounds, and its estimated error."""
        return None if self.bounds is None else self.bounds.likely


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
    mesh = tagged_mesh(problem, sizing, planes)
    farads = epsilon_0 * relative_permittivity * problem.unit * mesh.copies

    def solved() -> Level:
        system = FieldProblem(mesh, problem)
        found = charges(
            system, problem.sensors, len(problem.floating), len(problem.grounded), problem.grounded_sensors
        )
        on_bodies: tuple[Array, ...] = ()
        of_bounds = None
        done = time.monotonic()
        if bounds == "none":
            # Only what wraps change is asked of such a level.
            readings = level_readings(problem, system, found)
        else:
            on_bodies = body_charges(problem, system, found.potentials, planes)
            done = time.monotonic()
            with stage("bounding the energies"):
                known = _bounded(problem, system, found, bounds == "enclosure")
                readings = level_readings(problem, system, found, known)
                of_bounds = _level_bounds(problem, known, readings, farads, only_readings)
        end, sensors = time.monotonic(), problem.sensors
        return Level(
            edge_size=_edge_size(problem, sizing) * problem.unit,
            unknowns=found.unknowns,
            cells=mesh.cell_count,
            maxwell=farads * found.maxwell,
            sensors_alone=farads * found.sensors_alone,
            delta_self=farads * np.diag(found.maxwell[:sensors, :sensors] - found.sensors_alone),
            body_charges=tuple(farads * own for own in on_bodies),
            readings=None if readings is None else readings.scaled(farads),
            bounds=of_bounds,
            seconds=end - start,
            flux_seconds=end - done,
            memory=peak_memory(),
        )

    level = solved()
    # All matrices were local to that function, so that they can be freed now.
    release_unused(mesh.mesh.comm)
    # All processes go on with the numbers of the first, to the last digit: these decide what all of them do next.
    if mesh.mesh.comm.size > 1:
        level = mesh.mesh.comm.bcast(level)
    return level


def _edge_size(problem: Conductors, sizing: Sizing) -> float:
    """The size of the cells, in the scene's unit, at the edges of the smallest body, or the smallest adapted one."""
    if sizing.adapted is not None and len(sizing.adapted.sizes):
        return float(sizing.adapted.sizes.min())
    return min(size_at_edges(body, sizing) for body in problem.bodies) / sizing.refinement


def _bounded(problem: Conductors, system: FieldProblem, found: Charges, narrow: bool) -> Bounded:
    """Bound the matrix of the scene, without floating conductors, and that of the sensors that are asked for, without any objects."""
    cells = CondensedCells(system.tagged, FLUX_DEGREE if narrow else ESTIMATE_DEGREE)
    matrix = bounded_matrix(
        system, cells, found.potentials, problem.parts, problem.permittivities, len(problem.floating)
    )
    alone = None
    if found.potentials_alone is not None:
        others = range(problem.driven, problem.driven + problem.grounded_sensors)
        parts = [problem.bodies_of(k) for k in (*range(problem.sensors), *others)]
        present = {body for part in parts for body in part}
        # There is a field inside of the objects, which are the medium here.
        medium = {k: 1.0 for k, body in enumerate(problem.bodies) if body.is_solid and k not in present}
        alone = bounded_matrix(system.with_dielectrics({}), cells, found.potentials_alone, parts, medium)
    return Bounded(cells, matrix, alone, None if narrow else shares_by_kind(system.tagged, problem.bodies))


def _level_bounds(
    problem: Conductors, known: Bounded, readings: LevelReadings | None, farads: float, only_readings: bool
) -> LevelBounds:
    """What the bounds tell of the matrix and of `delta_self`, and what the cells add to the errors."""
    mesh, whole = known.cells.tagged, known.matrix.with_shift
    interval = widened(enclosure(farads * whole.lower, farads * whole.upper), mesh.rim_error)
    delta_self = None
    if known.alone is not None:
        of_sensors, sensors = known.matrix.of(range(problem.sensors)), np.eye(problem.sensors)
        delta_self = two_sided(sensors, sensors, of_sensors, known.alone, 1.0, known.rim_error, known.shares)
    changes = [
        None if only_readings else delta_self,
        None if readings is None else readings.change_from_bounds,
    ]
    count = len(problem.names)
    asked = quantities(problem.readings, count) if only_readings else entries(count)
    stated = [each for each in changes if each is not None]
    likely = None
    if known.shares is None:
        parts = parts_of_errors(whole, asked, known.rim_error, stated)
    else:
        between = estimated(known.matrix, known.shares)
        parts = parts_of_estimates(between, asked, known.rim_error, stated)
        own = np.diag(between.value)
        error = between.error + known.rim_error * np.sqrt(np.outer(own, own))
        likely = farads * between.value, farads * error
    return LevelBounds(
        interval,
        likely,
        None if delta_self is None else delta_self.scaled(farads),
        marks(problem, *mesh.corners(), parts.of_cells, parts.whole),
    )


def body_charges(
    problem: Conductors, system: FieldProblem, potentials: Sequence[Array], planes: Sequence[Plane] = ()
) -> tuple[Array, ...]:
    """For each conductor with a row the charges (members, n) on its bodies, per volt on each of these conductors (ε = 1).

    The charge on a place of the surface is the reaction K·u of the unknown there. It belongs to the body nearest to it, in equal parts
    if several are: along the seams of bodies, charges are uncertain by those in a cell. `planes` are the planes of symmetry of which
    one side is meshed. The sum over the members is the conductor's row, except for the error of the linear solver.
    """
    rows, members = len(problem.names), problem.members
    if all(len(names) == 1 for names in members[:rows]):
        return ()
    floating = len(potentials) - rows
    maxwell = system.energies(potentials) if floating else np.empty((0, 0))
    driven = with_floating(np.array(potentials), maxwell, floating, system.to_ground)
    reactions = system.reactions(driven)
    coordinates = system.space.tabulate_dof_coordinates()
    images = orbits(problem.bodies, problem.owner, planes)
    found = []
    for row in range(rows):
        dofs, names = system.dofs[row], members[row]
        shares = np.ones((1, len(dofs)))
        if len(names) > 1:
            bodies = [problem.bodies[k] for k in problem.parts[row]]
            shares = _shares(coordinates[dofs], bodies, names)
        own = MPI.COMM_WORLD.allreduce(shares @ reactions[:, dofs].T)
        found.append(_mean_over_images(np.asarray(own), problem, row, images))
    return tuple(found)


def _shares(points: Array, bodies: Sequence[Body], names: Sequence[str]) -> Array:
    """The share (members, n) of each member in the places (n, 3) on the surface of a conductor."""
    distances = np.full((len(names), len(points)), np.inf)
    for body in bodies:
        for name, distance in zip(member_names(body), _distances(points, body)):
            k = names.index(name)
            distances[k] = np.minimum(distances[k], distance)
    nearest = distances <= distances.min(axis=0, initial=np.inf) + AS_NEAR
    return np.asarray(nearest / np.maximum(nearest.sum(axis=0), 1))


def _distances(points: Array, body: Body) -> list[Array]:
    """The distances (n,) of points from the surface of each body that a body stands for; those from triangles are sampled."""
    if isinstance(body, Wrap):
        groups = [body.samples[body.labels == k] for k in range(len(body.members))]
    elif isinstance(body, Polyhedron):
        groups = [spread_points([body.vertices[body.triangles]])[0]]
    else:
        return [np.asarray(surface_distance(body, points.T))]
    return [np.asarray(cKDTree(group).query(points)[0]) for group in groups]


def _mean_over_images(
    charges: Array, problem: Conductors, row: int, images: Sequence[frozenset[int]]
) -> Array:
    """The charges (members, n) of bodies that the planes of symmetry map to each other, made equal: only a part of them is meshed."""
    names = problem.members[row]
    mean = charges.copy()
    for orbit in images:
        own = [problem.bodies[k].name for k in orbit if problem.owner[k] == row]
        numbers = sorted({names.index(name) for name in own if name in names})
        if len(numbers) > 1:
            mean[numbers] = charges[numbers].mean(axis=0)
    return mean
