"""The Maxwell capacitance matrix of a scene, with an error for every entry, to the accuracy asked for."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from fem_reference.convergence import SHARED_ERROR, Estimate, estimate, open_boundary_error
from fem_reference.mesh import OUTER_RADIUS, tagged_mesh
from fem_reference.scene_bodies import Conductors, conductors
from fem_reference.sizing import Sizing
from fem_reference.solve import Charges, FieldProblem, charges
from geometries.scene import Scene

Array = NDArray[np.float64]

LEVELS_BEFORE_CHECK = 3
"""The ratio of two differences takes three levels: with fewer no accuracy counts as reached."""
MOST_LEVELS = 6
GROWTH_OF_TIME = 3.2
"""Time of a level over that of the one before, somewhat above the largest ratio met in the default study (2.9)."""


@dataclass(frozen=True)
class Level:
    """What one mesh gave; farads, and the size of its tetrahedra at the finest body's edges in metres."""

    edge_size: float
    unknowns: int
    cells: int
    seconds: float
    maxwell: Array
    sensors_alone: Array
    delta_self: Array


@dataclass(frozen=True)
class Reference:
    """The answer for one scene; farads. `names` and the rows of the matrices: sensors first, then objects."""

    names: tuple[str, ...]
    sensors: int
    maxwell: Estimate
    """(n, n): Q = maxwell · V."""
    delta_self: Estimate
    """(m,): maxwell[s, s] less what it is without the objects, per sensor."""
    levels: tuple[Level, ...]
    rtol: float
    seconds: float

    @property
    def reached(self) -> bool:
        """Whether every error is within `rtol`, and was judged by enough levels."""
        return len(self.levels) >= LEVELS_BEFORE_CHECK and self.worst <= self.rtol

    @property
    def worst(self) -> float:
        """The largest relative error among the entries of the Maxwell matrix and the delta_self."""
        pairs = [self.maxwell] if len(self.names) == self.sensors else [self.maxwell, self.delta_self]
        return float(max(np.max(pair.error / np.abs(pair.value)) for pair in pairs))

    @property
    def lower(self) -> Array:
        return np.asarray(self.maxwell.value - self.maxwell.error)

    @property
    def upper(self) -> Array:
        return np.asarray(self.maxwell.value + self.maxwell.error)


def maxwell(
    scene: Scene,
    rtol: float = 1e-3,
    max_seconds: float = float("inf"),
    source: str = "scene",
    progress: Callable[[Level, float], None] | None = None,
) -> Reference:
    """Solve the scene on finer and finer meshes until every entry's relative error is at most `rtol`.

    Stops unfinished (`reached` False, the errors as they are) when the next level would end after `max_seconds`.
    `progress` is told every level and the largest relative error so far. Raises InputError for scenes that cannot be
    solved, RuntimeError when the mesher or the solver fails.
    """
    return solve_conductors(
        conductors(scene, source), scene.medium.relative_permittivity, rtol, max_seconds, progress
    )


def solve_conductors(
    problem: Conductors,
    relative_permittivity: float = 1.0,
    rtol: float = 1e-3,
    max_seconds: float = float("inf"),
    progress: Callable[[Level, float], None] | None = None,
) -> Reference:
    """As `maxwell`, for conductors given as bodies."""
    start = time.monotonic()
    levels: list[Level] = []
    while True:
        levels.append(_level(problem, relative_permittivity, 2.0 ** len(levels)))
        answer = _answer(problem, relative_permittivity, levels, rtol, time.monotonic() - start)
        if progress is not None:
            progress(levels[-1], answer.worst)
        predicted = answer.seconds + GROWTH_OF_TIME * levels[-1].seconds
        if answer.reached or len(levels) == MOST_LEVELS or predicted > max_seconds:
            return answer


def _level(problem: Conductors, relative_permittivity: float, refinement: float) -> Level:
    start = time.monotonic()
    sizing = Sizing(refinement=refinement)
    mesh = tagged_mesh(problem.bodies, problem.owner, sizing)
    system = FieldProblem(mesh, [problem.bodies_of(k) for k in range(len(problem.names))])
    found: Charges = charges(system, problem.sensors)
    farads = epsilon_0 * relative_permittivity * problem.unit
    smallest = min(body.size for body in problem.bodies)
    return Level(
        sizing.edge * smallest * problem.unit / refinement,
        found.unknowns,
        mesh.cell_count,
        time.monotonic() - start,
        farads * found.maxwell,
        farads * found.sensors_alone,
        farads * np.diag(found.maxwell[: problem.sensors, : problem.sensors] - found.sensors_alone),
    )


def _answer(
    problem: Conductors, relative_permittivity: float, levels: Sequence[Level], rtol: float, seconds: float
) -> Reference:
    """Extrapolate, and add what the levels share: the open boundary, and the elements away from the edges."""
    farads = epsilon_0 * relative_permittivity * problem.unit
    finest = levels[-1].maxwell
    boundary = farads * open_boundary_error(finest / farads, 1.0, OUTER_RADIUS)
    matrix = estimate([level.maxwell for level in levels])
    change = estimate([level.delta_self for level in levels])
    relative_boundary = (np.diag(boundary) / np.diag(finest))[: problem.sensors]
    matrix_error = matrix.error + boundary + SHARED_ERROR * np.abs(matrix.value)
    change_error = change.error + (relative_boundary + SHARED_ERROR) * np.abs(change.value)
    return Reference(
        problem.names,
        problem.sensors,
        Estimate(matrix.value, matrix_error, matrix.extrapolated),
        Estimate(change.value, change_error, change.extrapolated),
        tuple(levels),
        rtol,
        seconds,
    )
