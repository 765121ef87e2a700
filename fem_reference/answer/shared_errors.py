"""The errors that all levels share: of the open boundary, of the bodies left out, and of wraps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.constants import epsilon_0

from fem_reference.answer.wrapped import GeometryError
from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.tagged_mesh import OUTER_RADIUS
from fem_reference.solve.level import Level
from geometries.common.arrays import Array


@dataclass(frozen=True)
class SharedErrors:
    """Errors in farads that no finer mesh takes away."""

    boundary: Array
    """(n, n): that of the open boundary; 0 in a room."""
    relative: Array
    """(n,): the same of the own entries, over these."""
    left_out: Array
    """(n,): what the bodies left out add at most to the own entries."""
    shape: GeometryError | None
    """What wraps cost, if there are any."""

    def of_readings(self, problem: Conductors) -> Array:
        """Bounds (k,) on what bodies left out change readings by: |ΔM_ij| ≤ √(b_i·b_j), if they add at most b to each own entry."""
        root = np.sqrt(self.left_out)
        return np.array([root[r.sense] * root[list(r.drive)].sum() for r in problem.readings])


def shared_errors(
    problem: Conductors,
    relative_permittivity: float,
    finest: Level,
    left_out: Array,
    shape: GeometryError | None,
) -> SharedErrors:
    """The errors of levels of which this is the finest."""
    boundary = np.zeros_like(finest.maxwell)
    if problem.room is None:
        farads = epsilon_0 * relative_permittivity * problem.unit
        own = farads * open_boundary_error(finest.maxwell / farads, 1.0, OUTER_RADIUS)
        boundary = np.asarray(problem.most_charge**2 * own)
    return SharedErrors(boundary, np.diag(boundary) / np.diag(finest.maxwell), left_out, shape)


def open_boundary_error(maxwell: Array, extent: float, radius: float) -> Array:
    """Bound (n, n) on the error of the open-boundary condition, in the unit of `maxwell` (ε = 1, metres).

    The condition is exact for a charge in the centre; for a multipole of order l it has the coefficient 1/R instead of (l + 1)/R.
    All charges lie within `extent` of the centre of the sphere of `radius` R, and their absolute values add up to at most
    2·maxwell[i, i], which bounds every multipole: NUMERICS.md section 4.
    """
    q = extent / radius
    orders = np.arange(1, 20)
    series = float(np.sum(orders / (2 * orders + 1) * q ** (2 * orders)))
    own = (2 * np.diag(maxwell)) ** 2 / (4 * np.pi * radius) * series
    return np.asarray(np.sqrt(np.outer(own, own)))
