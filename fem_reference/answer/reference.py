"""The Maxwell capacitance matrix of a scene, with an error for every entry, to the accuracy asked for."""

from __future__ import annotations

import math
import os
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

import numpy as np
from mpi4py import MPI
from scipy.constants import epsilon_0

from fem_reference.answer.convergence import Estimate
from fem_reference.answer.matrix import combined_matrix
from fem_reference.answer.readings import ReadingAnswer, combined_readings, delta_self
from fem_reference.answer.shared_errors import GeometryError, SharedErrors, geometry_error, shared_errors
from fem_reference.bodies.conductors import Conductors, assembly, wrapped
from fem_reference.bodies.distances import distance, in_contact
from fem_reference.bodies.distant import LeftOut, is_negligible, without_distant
from fem_reference.bodies.symmetry import Plane
from fem_reference.bodies.wrapping import Geometry
from fem_reference.common.limits import Limits
from fem_reference.mesh.marks import (
    AWAY_ORDER,
    AWAY_ORDER_OF_ESTIMATES,
    FIRST_ORDER,
    FIRST_ORDER_OF_ESTIMATES,
    FRACTION_OF_GOAL,
    LATER_ORDER,
    adapted_sizes,
)
from fem_reference.mesh.sizing import Sizing, sizing_for
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import Level, solve_level
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene.scene import Scene

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
ORDER_OF_TIME = 1.15
"""Predicted order of the time of a level in its cells."""


@dataclass(frozen=True)
class Reference:
    """The answer for one scene, in farads. The rows of the matrices follow `names`: sensors first, then objects."""

    problem: Conductors
    """What was solved, with lengths over its unit; distant bodies are left out of it."""
    maxwell: Estimate
    """Maxwell matrix (n, n): Q = maxwell · V."""
    delta_self: Estimate
    """For each sensor s (m,): maxwell[s, s] minus its value without the objects."""
    levels: tuple[Level, ...]
    rtol: float
    seconds: float
    readings: tuple[ReadingAnswer, ...] = ()
    """The readings whose conductors all have a row."""
    only_readings: bool = False
    """Whether the accuracy is asked of the readings and their changes only, not of every entry of the matrix and of `delta_self`."""
    enclosure: Enclosure | None = None
    """Proven bounds of the entries of the Maxwell matrix, when asked for."""
    contradicted: str | None = None
    """Description of the checks that the estimates fail by more than their errors; such an answer never counts as reached."""
    planes: tuple[Plane, ...] = ()
    """Planes of symmetry, in metres; only one side of each was solved: a half, a quarter or an eighth of space."""
    left_out: tuple[LeftOut, ...] = ()
    """Distant bodies that were left out of the mesh; the errors and the interval account for them."""
    geometry: GeometryError | None = None
    """What the wraps cost, if there are any; the errors and the interval account for it."""
    stopped_by: str | None = None
    """The limit that ended the refinement, if one did."""

    def stopped(self, why: str | None) -> Reference:
        """The same answer after which the refinement ended, for this reason."""
        return replace(self, stopped_by=why)

    @property
    def names(self) -> tuple[str, ...]:
        """The conductors that have rows."""
        return self.problem.names

    @property
    def has_objects(self) -> bool:
        """Whether the scene has objects besides its sensors, without which `delta_self` would be zero."""
        problem = self.problem
        grounded_objects = len(problem.grounded) - problem.grounded_sensors
        others = grounded_objects or problem.floating or problem.dielectrics
        return len(problem.names) > problem.sensors or bool(others)

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
        if self.problem.wraps:
            return "of the wraps"
        return "of curved surfaces" if self.problem.curved else None

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
            own = float(max(reading.relative_error_of_value for reading in self.readings))
        elif self.enclosure is not None:
            own = float(np.max(self.enclosure.half_width / np.abs(self.maxwell.value)))
        else:
            own = float(np.max(self.maxwell.error / np.abs(self.maxwell.value)))
        return own if self.enclosure is not None else max(own, self.worst_of_changes)

    @property
    def worst_of_changes(self) -> float:
        """The largest relative error of delta_self and of the changes of readings; 0 if there are none."""
        errors = [reading.relative_error_of_change for reading in self.readings]
        if self.has_objects and self.problem.sensors and not self.only_readings:
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

    `error` selects the kind of error: half the width of an interval that is proven to contain the true value, or an estimate from wider
    bounds, which is several times faster. The refinement stops early (`reached` is False, the errors are those reached) when the next
    level would end `max_seconds` after the start, wraps included, have more than `max_unknowns` or take more than `max_memory` bytes.
    `prepared` is called when the bodies, perhaps wrapped, are ready to be meshed, `progress` after each level with the answer so far;
    `source` names the scene in error messages. With `columns`, names of conductors, only their rows and columns are solved and returned,
    and the other conductors are grounded. Without `symmetry` the whole of space is meshed even if the scene is its own mirror image.
    `geometry` says which bodies are wrapped, and how closely. With `only_readings` the accuracy is asked of the readings and their
    changes, and not of every entry. Raises InputError for scenes that cannot be solved, RuntimeError when the mesher or the solver fails.
    """
    start = time.monotonic()
    limits = Limits(max_seconds, max_unknowns, max_memory)
    geometry = replace(geometry, rtol=rtol)
    parts = assembly(scene, source, columns, geometry)
    problem = wrapped(parts, geometry)
    if only_readings and not problem.readings:
        raise InputError(
            source, "--only-readings", "the scene has no readings of conductors that are solved for"
        )
    others = [replace(geometry, coarseness=2 * geometry.coarseness)] if problem.wraps else []
    others += [geometry.opened(problem.wraps)] if any(wrap.closes for wrap in problem.wraps) else []
    compared = [wrapped(parts, other) for other in others]
    prepared()
    permittivity = scene.medium.relative_permittivity
    return solve_conductors(
        problem, permittivity, rtol, limits, progress, error, symmetry, compared, only_readings, start
    )


@dataclass(frozen=True)
class _SetUp:
    """What is solved of a problem: without the bodies that are left out, and on one side of its planes of symmetry."""

    problem: Conductors
    left_out: tuple[LeftOut, ...]
    planes: tuple[Plane, ...]

    @property
    def bound(self) -> Array:
        """What the bodies left out add at most to own entries (n,), in farads."""
        return sum((body.bound for body in self.left_out), np.zeros(len(self.problem.names)))

    def may_leave_out(self, level: Level, shared: SharedErrors, rtol: float) -> bool:
        """Whether the bodies left out are negligible beside all that a level shows."""
        changes, of_changes = level.delta_self, self.bound[: self.problem.sensors]
        if level.readings is not None:
            changes = np.append(changes, level.readings.change)
            of_changes = np.append(of_changes, shared.of_readings(self.problem))
        return not self.left_out or is_negligible(self.bound, level.maxwell, of_changes, changes, rtol)


def solve_conductors(
    problem: Conductors,
    relative_permittivity: float = 1.0,
    rtol: float = 1e-3,
    limits: Limits = Limits(),
    progress: Progress | None = None,
    error: ErrorKind = "enclosure",
    symmetry: bool = True,
    compared: Sequence[Conductors] = (),
    only_readings: bool = False,
    start: float | None = None,
) -> Reference:
    """Solve as `maxwell` does, for conductors given as bodies. The time counts from `start` on the monotonic clock, or from now.

    With wraps, `compared` are the same conductors with wraps of twice the offset and, if wraps close wide hollows, with open ones.
    """
    start = time.monotonic() if start is None else start
    fewer, left_out = without_distant(problem, epsilon_0 * relative_permittivity, rtol)
    set_up = _SetUp(fewer, left_out, fewer.mirror_planes if symmetry else ())
    levels: list[Level] = []
    answer: Reference
    shape: GeometryError | None = None
    sizing = sizing_for(rtol, first_refinement(fewer))
    while True:
        try:
            level = solve_level(
                set_up.problem, relative_permittivity, sizing, error, set_up.planes, only_readings
            )
        except (MemoryError, RuntimeError) as failure:
            if not levels or not _is_want_of_memory(failure):
                raise
            _end_all_processes()
            return answer.stopped("the next level took more memory than there is")
        shared = shared_errors(set_up.problem, relative_permittivity, level, set_up.bound, shape)
        if not set_up.may_leave_out(level, shared, rtol):
            # The first level shows that some entries are too small for the bound: solve the whole scene after all.
            set_up = _SetUp(problem, (), problem.mirror_planes if symmetry else ())
            continue
        levels.append(level)
        if compared and shape is None:
            others = [
                solve_level(
                    other, relative_permittivity, sizing, "none", other.mirror_planes if symmetry else ()
                )
                for other in compared
            ]
            shape = geometry_error(problem, level, *others)
            shared = replace(shared, shape=shape)
        answer = _answer(set_up, levels, shared, rtol, only_readings, time.monotonic() - start)
        if progress is not None:
            progress(answer)
        if answer.reached:
            return answer
        following = _next_sizing(sizing, level, answer)
        # Clocks differ between processes, so that all of them follow the decision of the first.
        stopped_by = MPI.COMM_WORLD.bcast(_stopped_by(level, following, limits, answer.seconds))
        stopped_by = stopped_by or _stopped_by_wraps(answer)
        if stopped_by is not None or len(levels) == MOST_LEVELS:
            return answer.stopped(stopped_by or f"the refinement ends after {MOST_LEVELS} levels")
        sizing = following


def _answer(
    set_up: _SetUp,
    levels: Sequence[Level],
    shared: SharedErrors,
    rtol: float,
    only_readings: bool,
    seconds: float,
) -> Reference:
    """The answer that the levels give together, with the errors that all of them share."""
    problem = set_up.problem
    matrix = combined_matrix(problem, levels, shared)
    proven = shared.shape is None and not problem.curved and matrix.contradicted is None
    return Reference(
        problem=problem,
        maxwell=matrix.value,
        delta_self=delta_self(levels, shared),
        levels=tuple(levels),
        rtol=rtol,
        seconds=seconds,
        readings=combined_readings(problem, levels, matrix.value, shared, proven),
        only_readings=only_readings,
        enclosure=matrix.interval,
        contradicted=matrix.contradicted,
        planes=tuple(problem.in_metres(plane) for plane in set_up.planes),
        left_out=set_up.left_out,
        geometry=shared.shape,
    )


def _end_all_processes() -> None:
    """End this process as if the system had ended it, if others wait for it: mpirun ends these then, and the parent of the first prints
    the answer."""
    if MPI.COMM_WORLD.size > 1:
        os.kill(os.getpid(), signal.SIGKILL)


def _is_want_of_memory(failure: BaseException) -> bool:
    """Whether an exception is a MemoryError, or PETSc's of its kind, perhaps inside of the message of a stage."""
    return isinstance(failure, MemoryError) or PETSC_OUT_OF_MEMORY in str(failure)


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


def _next_sizing(sizing: Sizing, level: Level, answer: Reference) -> Sizing:
    """The sizes of the next mesh, by the marks of the level: those that reach the goal.

    If this takes many more cells, the next mesh is to reach the geometric mean of the present errors and the goal, so that it shows
    more reliably where errors arise.
    """
    assert level.bounds is not None
    marks = level.bounds.marks
    present = max(answer.worst, answer.worst_of_changes) / answer.rtol
    order, away_order = FIRST_ORDER, AWAY_ORDER
    if level.estimated is not None:
        order, away_order = FIRST_ORDER_OF_ESTIMATES, AWAY_ORDER_OF_ESTIMATES
    orders = marks.orders(order)
    if sizing.adapted is not None:
        orders = np.full_like(orders, LATER_ORDER)
    for ratio in (1.0, np.sqrt(max(present, 1.0))):
        # Errors that a check contradicts are smaller than the true ones.
        goal = FRACTION_OF_GOAL * answer.rtol * ratio * min(present, 1.0)
        adapted = adapted_sizes(marks, goal, orders, away_order)
        if adapted.growth_of_cells <= MOST_GROWTH_OF_CELLS:
            break
    return replace(sizing, refinement=sizing.refinement * max(present / ratio, 1.0), adapted=adapted)


def _stopped_by(last: Level, following: Sizing, limits: Limits, seconds: float) -> str | None:
    """The limit that the next level is predicted to exceed, in words; None when it would keep all of them."""
    assert following.adapted is not None
    growth = following.adapted.growth_of_cells
    predicted = seconds + growth**ORDER_OF_TIME * last.seconds
    return limits.exceeded_by(predicted, growth * last.unknowns, growth * last.memory)


def _stopped_by_wraps(answer: Reference) -> str | None:
    """What wraps cost on any mesh, in words, if it is more than was asked for."""
    if answer.geometry is None:
        return None
    changes = np.array([reading.change.value for reading in answer.readings])
    least = answer.geometry.least_error(
        answer.maxwell.value, answer.delta_self.value, answer.problem.readings, changes, answer.only_readings
    )
    if least <= answer.rtol:
        return None
    return f"the wraps alone cost {least:.2g}, on any mesh; a smaller --wrap-offset costs less"
