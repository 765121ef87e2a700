"""The Maxwell capacitance matrix of a scene, with an error for every entry, to the accuracy asked for."""

from __future__ import annotations

import math
import os
import signal
import time
from itertools import combinations
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from fem_reference.answer.best_value import best_value
from fem_reference.answer.checks import checked
from fem_reference.answer.convergence import Estimate, open_boundary_error
from fem_reference.answer.readings import (
    ReadingAnswer,
    combined_readings,
    difference_estimate,
    of_left_out,
    readings_contradict,
)
from fem_reference.answer.wrapped import GeometryError, geometry_error
from fem_reference.bodies.distances import distance, in_contact
from fem_reference.bodies.distant import LeftOut, is_negligible, without_distant
from fem_reference.solve.enclosure import Enclosure, contradict, intersection, with_left_out
from fem_reference.solve.level import Level, solve_level
from fem_reference.common.limits import Limits
from fem_reference.mesh.tagged_mesh import OUTER_RADIUS
from fem_reference.bodies.conductors import Conductors, Dielectric, conductors
from fem_reference.mesh.marks import (
    AWAY_ORDER,
    AWAY_ORDER_OF_ESTIMATES,
    FIRST_ORDER,
    FIRST_ORDER_OF_ESTIMATES,
    FRACTION_OF_GOAL,
    LATER_ORDER,
    adapted_sizes,
)
from fem_reference.mesh.size_rules import Sizing, sizing_for
from fem_reference.bodies.symmetry import Plane, exchanges, mirror_planes
from fem_reference.bodies.wrapping import Geometry, Wrap
from geometries.common.errors import InputError
from geometries.scene.scene import Scene

Array = NDArray[np.float64]
ErrorKind = Literal["enclosure", "estimate"]

LEVELS_BEFORE_CHECK = 3
"""Number of levels that the ratio of two differences takes: with fewer no estimate counts as reached."""
LARGE = 200_000
"""Number of unknowns from which on an enclosure counts whatever the errors of delta_self and of the changes of readings, which have no
interval of their own. Below it as many levels as LEVELS_BEFORE_CHECK, which take seconds, show the order in which these converge."""
MOST_LEVELS = 6
"""Largest number of levels; after it the answer is returned even if its errors are above `rtol`."""
NARROW_GAP = 0.05
"""Gap over the size of a body beside it, below which the edges in the gap take most of the cells of the first mesh."""
REFINEMENT_IN_NARROW_GAPS = 0.5
"""Divisor of the sizes at edges on the first mesh of a scene with narrow gaps, whose errors choose the sizes of the next one: it halves the
unknowns, most of which would lie along edges that may not matter."""
MOST_GROWTH_OF_CELLS = 8.0
"""Largest growth of the number of cells at which the next mesh is to reach the goal at once."""
PETSC_OUT_OF_MEMORY = "error code 55"
"""What PETSc's exceptions say where memory is wanting (PETSC_ERR_MEM)."""
GROWTH_OF_TIME = 3.2
"""Predicted ratio of the times of successive levels, somewhat above the largest measured in the default study (2.9)."""
GROWTH_OF_UNKNOWNS = 2.4
"""Predicted ratio of the unknowns, and of the memory, of successive levels: the number of cells along the edges doubles."""
ORDER_OF_TIME = 1.15
"""Predicted order of the time of a level in its cells, if these are adapted."""


@dataclass(frozen=True)
class Reference:
    """The answer for one scene, in farads. The rows of the matrices follow `names`: sensors first, then objects."""

    names: tuple[str, ...]
    sensors: int
    """Number of sensors among `names`."""
    maxwell: Estimate
    """Maxwell matrix (n, n): Q = maxwell · V."""
    delta_self: Estimate
    """For each sensor s (m,): maxwell[s, s] minus its value without the objects."""
    levels: tuple[Level, ...]
    rtol: float
    seconds: float
    grounded: tuple[str, ...] = ()
    """Conductors that are present, but whose columns were not asked for: they are grounded and have no row. Sensors first."""
    grounded_sensors: int = 0
    """Number of sensors among `grounded`."""
    floating: tuple[str, ...] = ()
    """Conductors without charge, which are eliminated from the matrix."""
    dielectrics: tuple[Dielectric, ...] = ()
    curved: tuple[str, ...] = ()
    """Bodies with curved surfaces, which the cells follow approximately."""
    planes: tuple[Plane, ...] = ()
    """Planes of symmetry, in metres; only one side of each was solved: a half, a quarter or an eighth of space."""
    enclosure: Enclosure | None = None
    """Proven bounds of the entries of the Maxwell matrix, when asked for."""
    in_room: bool = False
    """Whether ground is the walls of a room rather than infinity."""
    left_out: tuple[LeftOut, ...] = ()
    """Distant bodies that were left out of the mesh; the errors and the interval account for them."""
    members: tuple[tuple[str, ...], ...] = ()
    """The bodies that each conductor in `names` consists of."""
    wraps: tuple[Wrap, ...] = ()
    """The surfaces that were solved in the place of bodies that could not be meshed as they are; lengths over the scene's unit."""
    unit: float = 1.0
    """Unit of length (m) of `wraps`."""
    geometry: GeometryError | None = None
    """What the wraps cost, if there are any; the errors and the interval account for it."""
    readings: tuple[ReadingAnswer, ...] = ()
    """The readings whose conductors all have a row."""
    only_readings: bool = False
    """Whether the accuracy is asked of the readings and their changes only, not of every entry of the matrix and of `delta_self`."""
    stopped_by: str | None = None
    """The limit that ended the refinement, if one did."""
    contradicted: str | None = None
    """Description of the checks that the estimates fail by more than their errors; such an answer never counts as reached."""

    @property
    def has_objects(self) -> bool:
        """Whether the scene has objects besides its sensors, without which `delta_self` would be zero."""
        grounded_objects = len(self.grounded) - self.grounded_sensors
        others = grounded_objects or self.floating or self.dielectrics
        return len(self.names) > self.sensors or bool(others)

    @property
    def reached(self) -> bool:
        """Whether every error is at most `rtol`, rests on enough levels, and is contradicted by no check.

        An enclosure needs no further level for itself, only for delta_self and the changes of readings, if their errors are larger. An
        estimate by both bounds of one mesh needs no other mesh.
        """
        enclosed = self.enclosure is not None
        proven = enclosed and (self.levels[-1].unknowns >= LARGE or self.worst_of_changes <= self.rtol)
        enough = proven or self.levels[-1].estimated is not None or len(self.levels) >= LEVELS_BEFORE_CHECK
        return enough and self.worst <= self.rtol and self.contradicted is None

    @property
    def unproven_because(self) -> str | None:
        """Why the interval is not proven, in words; None if it is."""
        if self.contradicted is not None:
            return self.contradicted
        if self.wraps:
            return "of the wraps"
        return "of curved surfaces" if self.curved else None

    @property
    def error_kind(self) -> ErrorKind:
        return "estimate" if self.enclosure is None else "enclosure"

    @property
    def worst(self) -> float:
        """The largest relative error: of the entries of the Maxwell matrix, or only of the readings, and, if errors are estimates, of
        delta_self and changes.

        The error of an enclosed entry is half the width of its interval. The bounds of a matrix prove little about delta_self and the
        changes of readings, which are differences of two solutions.
        """
        if self.only_readings:
            own = max(reading.relative_error_of_value for reading in self.readings)
        elif self.enclosure is not None:
            own = float(np.max(self.enclosure.half_width / np.abs(self.maxwell.value)))
        else:
            own = float(np.max(self.maxwell.error / np.abs(self.maxwell.value)))
        return own if self.enclosure is not None else max(own, self.worst_of_changes)

    @property
    def worst_of_changes(self) -> float:
        """The largest relative error of delta_self and of the changes of readings; 0 if there are none."""
        errors = [reading.relative_error_of_change for reading in self.readings]
        if self.has_objects and self.sensors and not self.only_readings:
            errors.append(float(np.max(self.delta_self.error / np.abs(self.delta_self.value))))
        return float(max(errors, default=0.0))

    @property
    def charges(self) -> tuple[Array, ...]:
        """For each conductor the charges (members, n) on its bodies per volt on each conductor; their sum is the row of `maxwell`.

        The row is divided in the proportions of the finest mesh, up to what these miss of the row.
        """
        if not self.levels[-1].body_charges:
            return tuple(row[None] for row in self.maxwell.value)
        return tuple(
            own + (row - own.sum(axis=0)) * np.abs(own) / np.abs(own).sum(axis=0)
            for own, row in zip(self.levels[-1].body_charges, self.maxwell.value)
        )

    @property
    def lower(self) -> Array:
        if self.enclosure is not None:
            return self.enclosure.lower
        return np.asarray(self.maxwell.value - self.maxwell.error)

    @property
    def upper(self) -> Array:
        if self.enclosure is not None:
            return self.enclosure.upper
        return np.asarray(self.maxwell.value + self.maxwell.error)


Progress = Callable[[Reference], None]


def maxwell(
    scene: Scene,
    rtol: float = 1e-3,
    max_seconds: float = math.inf,
    max_unknowns: float = math.inf,
    max_memory: float = math.inf,
    source: str = "scene",
    progress: Progress | None = None,
    error: ErrorKind = "enclosure",
    columns: Sequence[str] = (),
    symmetry: bool = True,
    geometry: Geometry = Geometry(),
    only_readings: bool = False,
    prepared: Callable[[], None] = lambda: None,
) -> Reference:
    """Solve the scene on finer and finer meshes until every entry's relative error is at most `rtol`.

    `error` selects the kind of error: half the width of an interval that is proven to contain the true value, or an estimate from
    successive levels, which is several times faster. The refinement stops early (`reached` is False, the errors are those
    reached) when the next level would end `max_seconds` after the start, wraps included, have more than `max_unknowns` or take more than `max_memory` bytes.
    `prepared` is called when the bodies, perhaps wrapped, are ready to be meshed, `progress` after each level with the answer so far; `source` names the scene in error messages. With `columns`, names of conductors, only their rows and columns are solved and returned, and the other conductors are
    grounded. Without `symmetry` the whole of space is meshed even if the scene is its own mirror image. `geometry` says which bodies
    are wrapped, and how closely. With `only_readings` the accuracy is asked of the readings and their changes, and not of every entry. Raises InputError for scenes that cannot be solved, RuntimeError when the mesher or the solver fails.
    """
    start = time.monotonic()
    limits = Limits(max_seconds, max_unknowns, max_memory)
    geometry = replace(geometry, rtol=rtol)
    problem = conductors(scene, source, columns, geometry)
    if only_readings and not problem.readings:
        raise InputError(
            source, "--only-readings", "the scene has no readings of conductors that are solved for"
        )
    coarser, opened = None, None
    if problem.wraps:
        coarser = conductors(scene, source, columns, replace(geometry, coarseness=2 * geometry.coarseness))
    if any(wrap.closes for wrap in problem.wraps):
        opened = conductors(scene, source, columns, replace(geometry, opens=True))
    prepared()
    return solve_conductors(
        problem,
        scene.medium.relative_permittivity,
        rtol,
        limits,
        progress,
        error,
        symmetry,
        coarser,
        opened,
        only_readings,
        start,
    )


def solve_conductors(
    problem: Conductors,
    relative_permittivity: float = 1.0,
    rtol: float = 1e-3,
    limits: Limits = Limits(),
    progress: Progress | None = None,
    error: ErrorKind = "enclosure",
    symmetry: bool = True,
    coarser: Conductors | None = None,
    opened: Conductors | None = None,
    only_readings: bool = False,
    start: float | None = None,
) -> Reference:
    """Solve as `maxwell` does, for conductors given as bodies; `coarser` are the same with wraps of twice the offset, and `opened` with wraps
    that close no wide hollows, if the others do. The time counts from `start`
    on the monotonic clock, or from now."""
    start = time.monotonic() if start is None else start
    whole = problem
    problem, left_out = without_distant(whole, epsilon_0 * relative_permittivity, rtol)
    planes = _planes(problem, symmetry)
    levels: list[Level] = []
    answer: Reference
    shape: GeometryError | None = None
    sizing = sizing_for(rtol, first_refinement(problem), True)
    while True:
        try:
            level = solve_level(problem, relative_permittivity, sizing, error, planes, only_readings)
        except (MemoryError, RuntimeError) as failure:
            if not levels or not _is_want_of_memory(failure):
                raise
            if MPI.COMM_WORLD.size > 1:
                # The others wait for this process. It ends as if the system had ended it, whereupon mpirun ends the others, and the parent
                # of the first one prints the answer.
                os.kill(os.getpid(), signal.SIGKILL)
            return replace(answer, stopped_by="the next level took more memory than there is")
        bound = sum((body.bound for body in left_out), np.zeros(len(problem.names)))
        changes, of_changes = level.delta_self, bound[: problem.sensors]
        if level.readings is not None:
            changes = np.append(changes, level.readings.change)
            of_changes = np.append(of_changes, of_left_out(problem, bound))
        if left_out and not is_negligible(bound, level.maxwell, of_changes, changes, rtol):
            # The first level shows that some entries are too small for the bound: solve the whole scene after all.
            problem, left_out, planes = whole, (), _planes(whole, symmetry)
            continue
        levels.append(level)
        if coarser is not None and shape is None:
            others = [
                solve_level(other, relative_permittivity, sizing, "none", _planes(other, symmetry))
                for other in (coarser, opened)
                if other is not None
            ]
            shape = geometry_error(whole, level, *others)
        answer = _combined(
            problem,
            relative_permittivity,
            levels,
            rtol,
            time.monotonic() - start,
            planes,
            bound,
            left_out,
            shape,
            only_readings,
        )
        if progress is not None:
            progress(answer)
        following = _next_sizing(sizing, level, answer, rtol)
        # Clocks differ between processes, so that all of them follow the decision of the first.
        stopped_by = MPI.COMM_WORLD.bcast(_stopped_by(level, following, limits, answer.seconds))
        if shape is not None and stopped_by is None:
            changes = np.array([reading.change.value for reading in answer.readings])
            least = shape.least_error(
                answer.maxwell.value, answer.delta_self.value, problem.readings, changes, only_readings
            )
            if least > rtol:
                stopped_by = (
                    f"the wraps alone cost {least:.2g}, on any mesh; a smaller --wrap-offset costs less"
                )
        if answer.reached or len(levels) == MOST_LEVELS or stopped_by is not None:
            most = f"the refinement ends after {MOST_LEVELS} levels"
            return answer if answer.reached else replace(answer, stopped_by=stopped_by or most)
        sizing = following


def _is_want_of_memory(failure: BaseException) -> bool:
    """Whether an exception is a MemoryError, or PETSc's of its kind, perhaps inside of the message of a stage."""
    return isinstance(failure, MemoryError) or PETSC_OUT_OF_MEMORY in str(failure)


def _planes(problem: Conductors, symmetry: bool) -> tuple[Plane, ...]:
    """The planes of symmetry to use: none unless `symmetry`."""
    return mirror_planes(problem.bodies, problem.owner, problem.room) if symmetry else ()


def first_refinement(problem: Conductors) -> float:
    """The divisor of the sizes at edges on the first mesh, if the next ones are adapted."""
    bodies, owner = problem.bodies, problem.owner
    narrow = any(
        owner[i] != owner[j]
        and min(owner[i], owner[j]) < problem.driven
        and not in_contact(bodies[i], bodies[j])
        and distance(bodies[i], bodies[j]) < NARROW_GAP * min(bodies[i].size, bodies[j].size)
        for i, j in combinations(range(len(bodies)), 2)
    )
    return REFINEMENT_IN_NARROW_GAPS if narrow else 1.0


def _next_sizing(sizing: Sizing, level: Level, answer: Reference, rtol: float) -> Sizing:
    """The sizes of the next mesh: half of the present ones at edges or, where the level has marks, those that reach the goal.

    If this takes many more cells, the next mesh is to reach the geometric mean of the present errors and the goal, so that it shows
    more reliably where errors arise.
    """
    if level.marks is None:
        return replace(sizing, refinement=2 * sizing.refinement)
    present = max(answer.worst, answer.worst_of_changes) / rtol
    order, away_order = FIRST_ORDER, AWAY_ORDER
    if level.estimated is not None:
        order, away_order = FIRST_ORDER_OF_ESTIMATES, AWAY_ORDER_OF_ESTIMATES
    orders = level.marks.orders(order)
    if sizing.adapted is not None:
        orders = np.full_like(orders, LATER_ORDER)
    for ratio in (1.0, np.sqrt(max(present, 1.0))):
        # Errors that a check contradicts are smaller than the true ones.
        goal = FRACTION_OF_GOAL * rtol * ratio * min(present, 1.0)
        adapted = adapted_sizes(level.marks, goal, orders, away_order)
        if adapted.growth_of_cells <= MOST_GROWTH_OF_CELLS:
            break
    return replace(sizing, refinement=sizing.refinement * max(present / ratio, 1.0), adapted=adapted)


def _stopped_by(last: Level, following: Sizing, limits: Limits, seconds: float) -> str | None:
    """The limit that the next level is predicted to exceed, in words; None when it would keep all of them."""
    growth_of_time, growth = GROWTH_OF_TIME, GROWTH_OF_UNKNOWNS
    if following.adapted is not None:
        growth = following.adapted.growth_of_cells
        growth_of_time = growth**ORDER_OF_TIME
    predicted = seconds + growth_of_time * last.seconds
    return limits.exceeded_by(predicted, growth * last.unknowns, growth * last.memory)


def _combined(
    problem: Conductors,
    relative_permittivity: float,
    levels: Sequence[Level],
    rtol: float,
    seconds: float,
    planes: Sequence[Plane],
    bound: Array,
    left_out: tuple[LeftOut, ...],
    shape: GeometryError | None,
    only_readings: bool,
) -> Reference:
    """Extrapolate the levels, and add the errors that all levels share.

    These are the errors of the open boundary, of the bodies `left_out`, and of wraps: `bound` (n,) limits what these bodies may add to the
    diagonal, and `shape` is what wraps cost.
    """
    boundary = _boundary_error(problem, relative_permittivity, levels[-1])
    answer, interval, contradicted = _matrix(problem, levels, boundary, bound, shape)
    relative = np.diag(boundary) / np.diag(levels[-1].maxwell)
    proven = shape is None and not problem.curved and contradicted is None
    return Reference(
        names=problem.names,
        sensors=problem.sensors,
        maxwell=answer,
        delta_self=_delta_self(levels, relative[: problem.sensors], bound[: problem.sensors], shape),
        readings=combined_readings(problem, levels, answer, float(relative.max()), bound, shape, proven),
        levels=tuple(levels),
        rtol=rtol,
        seconds=seconds,
        grounded=problem.grounded,
        grounded_sensors=problem.grounded_sensors,
        floating=problem.floating,
        in_room=problem.room is not None,
        dielectrics=problem.dielectrics,
        curved=problem.curved,
        planes=tuple(problem.in_metres(plane) for plane in planes),
        enclosure=interval,
        contradicted=contradicted,
        members=problem.members[: len(problem.names)],
        wraps=problem.wraps,
        unit=problem.unit,
        geometry=shape,
        left_out=left_out,
        only_readings=only_readings,
    )


def _boundary_error(problem: Conductors, relative_permittivity: float, finest: Level) -> Array:
    """The error (n, n) of the open boundary; 0 in a room."""
    if problem.room is not None:
        return np.zeros_like(finest.maxwell)
    farads = epsilon_0 * relative_permittivity * problem.unit
    error = farads * open_boundary_error(finest.maxwell / farads, 1.0, OUTER_RADIUS)
    return np.asarray(problem.most_charge**2 * error)


def _matrix(
    problem: Conductors, levels: Sequence[Level], boundary: Array, bound: Array, shape: GeometryError | None
) -> tuple[Estimate, Enclosure | None, str | None]:
    """The Maxwell matrix, its interval if it is enclosed, and what contradicts its errors, in words."""
    found = best_value(levels)
    value, error = found.value, found.error + boundary + np.sqrt(np.outer(bound, bound))
    proven = [level.enclosure for level in levels if level.enclosure is not None]
    checks = [level.check for level in levels if level.check is not None]
    contradicted = None
    if any(contradict(known) for known in (proven, checks) if known) or readings_contradict(levels):
        contradicted = "the bounds of two meshes exclude each other"
    interval = with_left_out(intersection(proven or checks), bound) if proven or checks else None
    if shape is not None:
        interval = None if interval is None else shape.widened(interval)
        value, error = shape.corrected(value, error)
    if proven and interval is not None:
        value = np.clip(value, interval.lower, interval.upper)
        reach = np.maximum(value - interval.lower, interval.upper - value)
        # Where meshes contradict each other, no estimate of theirs is better than the interval that holds both.
        error = np.minimum(error, reach) if contradicted is None else reach
        return Estimate(value, error, found.extrapolated), interval, contradicted
    answer, deviation = checked(Estimate(value, error, found.extrapolated), _exchanges(problem), interval)
    return answer, None, "; ".join(filter(None, (contradicted, deviation))) or None


def _delta_self(
    levels: Sequence[Level], relative: Array, bound: Array, shape: GeometryError | None
) -> Estimate:
    """The sensors' `delta_self`; `relative` (m,) are the errors of the open boundary, and `bound` (m,) is what bodies left out may add."""
    first = levels[0].enclosure
    width = None if first is None else 2 * np.diag(first.half_width)[: len(relative)]
    two_sided = [level.delta_self_from_bounds for level in levels if level.delta_self_from_bounds is not None]
    change = difference_estimate(
        [level.delta_self for level in levels], width, two_sided[-1] if two_sided else None
    )
    error = change.error + relative * np.abs(change.value) + bound
    change = Estimate(change.value, error, change.extrapolated)
    return change if shape is None else shape.corrected_change(change)


def _exchanges(problem: Conductors) -> list[tuple[int, ...]]:
    """The permutations of the rows and columns that leave the matrix unchanged, because a mirror image of the scene is the scene."""
    kinds: list[tuple[str, float]] = [("row", 0.0)] * len(problem.names)
    kinds += [("floating", value) for value in problem.to_ground] or [("floating", 0.0)] * len(
        problem.floating
    )
    kinds += [("grounded", 0.0)] * len(problem.grounded)
    kinds += [("dielectric", body.contrast) for body in problem.dielectrics]
    orders = exchanges(problem.bodies, problem.owner, kinds, problem.room)
    return [order[: len(problem.names)] for order in orders]
