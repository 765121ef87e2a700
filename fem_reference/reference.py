"""The Maxwell capacitance matrix of a scene, with an error for every entry, to the accuracy asked for."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from fem_reference.best_value import best_value
from fem_reference.convergence import Estimate, estimate, open_boundary_error, shared_error
from fem_reference.distant import LeftOut, is_negligible, without_distant
from fem_reference.enclosure import Enclosure, intersection, with_left_out
from fem_reference.level import Level, solve_level
from fem_reference.limits import Limits
from fem_reference.mesh import OUTER_RADIUS
from fem_reference.scene_bodies import Conductors, Dielectric, conductors
from fem_reference.size_rules import Sizing, growth_for
from fem_reference.symmetry import Plane, mirror_planes
from geometries.scene.scene import Scene

Array = NDArray[np.float64]
ErrorKind = Literal["enclosure", "estimate"]

LEVELS_BEFORE_CHECK = 3
"""The ratio of two differences takes three levels: with fewer no accuracy counts as reached."""
MOST_LEVELS = 6
GROWTH_OF_TIME = 3.2
"""Time of a level over that of the one before, somewhat above the largest ratio met in the default study (2.9)."""
GROWTH_OF_UNKNOWNS = 2.4
"""The same for unknowns and memory: the cells along the edges double."""


@dataclass(frozen=True)
class Reference:
    """The answer for one scene; farads. `names` and the rows of the matrices: sensors first, then objects."""

    names: tuple[str, ...]
    sensors: int
    """How many of them are sensors."""
    maxwell: Estimate
    """(n, n): Q = maxwell · V."""
    delta_self: Estimate
    """(m,): maxwell[s, s] less what it is without the objects, per sensor."""
    levels: tuple[Level, ...]
    rtol: float
    seconds: float
    grounded: tuple[str, ...] = ()
    """Conductors that are present and not asked for: they have no row. Sensors first."""
    grounded_sensors: int = 0
    floating: tuple[str, ...] = ()
    """Conductors without charge: eliminated from the matrix."""
    dielectrics: tuple[Dielectric, ...] = ()
    curved: tuple[str, ...] = ()
    """Bodies with curved surfaces, of which the cells are an approximation."""
    planes: tuple[Plane, ...] = ()
    """Planes of symmetry, metres; the answer is that of one side of them, a half, a quarter or an eighth of space."""
    enclosure: Enclosure | None = None
    """Where the entries of the Maxwell matrix lie, when asked for."""
    in_room: bool = False
    """Whether ground is the walls of a room; else it is infinity."""
    left_out: tuple[LeftOut, ...] = ()
    """Distant bodies that were not solved for; the errors and the interval account for them."""
    stopped_by: str | None = None
    """The limit that ended the refinement."""

    @property
    def has_objects(self) -> bool:
        """Whether there is anything that `delta_self` could be due to."""
        grounded_objects = len(self.grounded) - self.grounded_sensors
        others = grounded_objects or self.floating or self.dielectrics
        return len(self.names) > self.sensors or bool(others)

    @property
    def reached(self) -> bool:
        """Whether every error is within `rtol`, and was judged by enough levels."""
        return len(self.levels) >= LEVELS_BEFORE_CHECK and self.worst <= self.rtol

    @property
    def error_kind(self) -> ErrorKind:
        return "estimate" if self.enclosure is None else "enclosure"

    @property
    def worst(self) -> float:
        """The largest relative error among the entries of the Maxwell matrix, and the delta_self if errors are estimates.

        Of an enclosure: half its width. What is proven says nothing about the difference of two solutions.
        """
        if self.enclosure is not None:
            return float(np.max(self.enclosure.half_width / np.abs(self.maxwell.value)))
        pairs = [self.maxwell]
        if self.has_objects and self.sensors:
            pairs.append(self.delta_self)
        return float(max(np.max(pair.error / np.abs(pair.value)) for pair in pairs))

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


Progress = Callable[[Level, float], None]


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
) -> Reference:
    """Solve the scene on finer and finer meshes until every entry's relative error is at most `rtol`.

    `error` says which: half the width of an interval that is proven to hold the truth, or an estimate from successive
    levels, several times faster. Stops unfinished (`reached` False, the errors as they are) when the next level would end
    after `max_seconds`, have more than `max_unknowns` or take more than `max_memory` bytes. `progress` is told every level
    and the largest relative error so far; `source` names the scene in errors. With
    `columns`, names of conductors, only their rows and columns are solved and returned, the others grounded. Raises InputError for scenes that cannot be
    solved, RuntimeError when the mesher or the solver fails.
    """
    limits = Limits(max_seconds, max_unknowns, max_memory)
    return solve_conductors(
        conductors(scene, source, columns), scene.medium.relative_permittivity, rtol, limits, progress, error
    )


def solve_conductors(
    problem: Conductors,
    relative_permittivity: float = 1.0,
    rtol: float = 1e-3,
    limits: Limits = Limits(),
    progress: Progress | None = None,
    error: ErrorKind = "enclosure",
) -> Reference:
    """As `maxwell`, for conductors given as bodies."""
    start = time.monotonic()
    growth = growth_for(rtol)
    whole = problem
    problem, left_out = without_distant(whole, epsilon_0 * relative_permittivity, rtol)
    planes = mirror_planes(problem.bodies, problem.owner, problem.room)
    levels: list[Level] = []
    next_enclosed = 0
    while True:
        number = len(levels)
        sizing = Sizing(refinement=2.0**number, growth=growth)
        # The next level may be the last when there are limits, and is when none are left.
        enclosed = error == "enclosure" and (
            number >= next_enclosed
            or number == MOST_LEVELS - 1
            or (limits != Limits() and next_enclosed < MOST_LEVELS)
        )
        level = solve_level(problem, relative_permittivity, sizing, enclosed, planes)
        bound = sum((body.bound for body in left_out), np.zeros(len(problem.names)))
        if left_out and not is_negligible(bound, level.maxwell, level.delta_self, rtol):
            # Only the first level tells how small the smallest entries are.
            problem, left_out, planes = whole, (), mirror_planes(whole.bodies, whole.owner, whole.room)
            continue
        levels.append(level)
        answer = _answer(
            problem, relative_permittivity, levels, rtol, growth, time.monotonic() - start, planes, bound
        )
        answer = replace(answer, left_out=left_out)
        if progress is not None:
            progress(levels[-1], answer.worst)
        # Every process takes the decision of the first, whose clock it is.
        stopped_by = MPI.COMM_WORLD.bcast(_stopped_by(levels, limits, answer.seconds))
        if answer.reached or len(levels) == MOST_LEVELS or stopped_by is not None:
            most = f"{MOST_LEVELS} levels are the most"
            return answer if answer.reached else replace(answer, stopped_by=stopped_by or most)
        if enclosed:
            next_enclosed = number + _halvings(answer.worst, rtol)


def _halvings(worst: float, rtol: float) -> int:
    """How many halvings of the edge size to go before the next enclosure; no further one is needed when it is narrow enough.

    The width falls at least like the edge size, on the coarsest levels faster: from two levels on it is worth asking.
    """
    if worst <= rtol:
        return MOST_LEVELS
    return min(math.ceil(math.log2(worst / rtol)), 2)


def _stopped_by(levels: Sequence[Level], limits: Limits, seconds: float) -> str | None:
    last = levels[-1]
    # A level without bounds says nothing about their time; it goes with the cells.
    flux = max(level.flux_seconds / level.cells for level in levels) * last.cells
    predicted = seconds + GROWTH_OF_TIME * (last.seconds - last.flux_seconds + flux)
    return limits.exceeded_by(predicted, GROWTH_OF_UNKNOWNS * last.unknowns, GROWTH_OF_UNKNOWNS * last.memory)


def _answer(
    problem: Conductors,
    relative_permittivity: float,
    levels: Sequence[Level],
    rtol: float,
    growth: float,
    seconds: float,
    planes: Sequence[Plane],
    left_out: Array,
) -> Reference:
    """Extrapolate, and add what the levels share: the open boundary, the elements away from the edges, what is left out.

    `left_out` (n,) is what bodies left out may add to the diagonal.
    """
    farads = epsilon_0 * relative_permittivity * problem.unit
    finest = levels[-1].maxwell
    open_boundary = 1.0 if problem.room is None else 0.0
    boundary = (
        open_boundary
        * problem.most_charge**2
        * farads
        * open_boundary_error(finest / farads, 1.0, OUTER_RADIUS)
    )
    matrix = best_value(levels)
    change = estimate([level.delta_self for level in levels])
    relative_boundary = (np.diag(boundary) / np.diag(finest))[: problem.sensors]
    matrix_error = matrix.error + boundary + shared_error(growth) * np.abs(matrix.value)
    matrix_error += np.sqrt(np.outer(left_out, left_out))
    change_error = change.error + (relative_boundary + shared_error(growth)) * np.abs(change.value)
    change_error += left_out[: problem.sensors]
    value = matrix.value
    proven = [level.enclosure for level in levels if level.enclosure is not None]
    interval = with_left_out(intersection(proven), left_out) if proven else None
    if interval is not None:
        value = np.clip(value, interval.lower, interval.upper)
        matrix_error = np.minimum(matrix_error, np.maximum(value - interval.lower, interval.upper - value))
    return Reference(
        names=problem.names,
        sensors=problem.sensors,
        maxwell=Estimate(value, matrix_error, matrix.extrapolated),
        delta_self=Estimate(change.value, change_error, change.extrapolated),
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
    )
