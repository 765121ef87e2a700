"""The errors that all levels share: of the open boundary, of the bodies left out, and of wraps.

What it costs that bodies were wrapped is measured with wraps of two offsets, and some bounds stay proven nevertheless: NUMERICS.md section 13.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.constants import epsilon_0

from fem_reference.answer.convergence import Estimate
from fem_reference.bodies.conductors import Conductors, Measured
from fem_reference.bodies.wrapping import Wrap
from fem_reference.mesh.tagged_mesh import OUTER_RADIUS
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import Level
from geometries.common.arrays import Array, Flags


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


@dataclass(frozen=True)
class GeometryError:
    """By how much twice the offset of all wraps and the hollows that they close change each entry (farads), and which bounds hold without wraps
    as well."""

    growth: Array
    """(n, n): the Maxwell matrix with twice the offset less that with the offset used, and that with hollows closed less that with them open, on
    the coarsest mesh."""
    growth_of_change: Array
    """(m,): the same of the sensors' `delta_self`."""
    upper_proven: Flags
    """(n, n): which entries are with wraps at least as large as without."""
    lower_proven: Flags
    """(n, n): which entries are with wraps at most as large as without."""
    growth_of_readings: Array | None = None
    """(k,): the same of the change of each reading; None without readings."""

    @property
    def error(self) -> Array:
        """The error (n, n) of each entry that is stated for the wraps."""
        return np.asarray(np.abs(self.growth))

    def widened(self, interval: Enclosure) -> Enclosure:
        """The interval of the bodies as they are, from that of the wraps: by twice the growth, except where a bound stays proven."""
        twice = 2 * self.growth
        lower = interval.lower - np.where(self.lower_proven, 0.0, np.maximum(twice, self.error))
        upper = interval.upper + np.where(self.upper_proven, 0.0, np.maximum(-twice, self.error))
        off_diagonal = ~np.eye(len(upper), dtype=bool)
        return Enclosure(lower, np.where(off_diagonal, np.minimum(upper, 0.0), upper))

    def least_error(
        self,
        maxwell: Array,
        delta_self: Array,
        readings: Sequence[Measured],
        changes: Array,
        only_readings: bool,
    ) -> float:
        """The largest relative error that the wraps leave on any mesh: in the entries (n, n) and `delta_self` (m,), unless only readings are
        asked for, and in the `changes` (k,) of readings."""
        sums = [
            (form[reading.sense, list(reading.drive)].sum() for form in (self.growth, maxwell))
            for reading in readings
        ]
        parts = [abs(float(growth / value)) for growth, value in sums if value]
        if self.growth_of_readings is not None:
            parts += [abs(float(g / v)) for g, v in zip(self.growth_of_readings, changes) if v]
        if not only_readings:
            parts += list(np.abs(self.growth / maxwell).ravel())
            parts += [abs(float(g / v)) for g, v in zip(self.growth_of_change, delta_self) if v]
        return max(parts, default=0.0)


def corrected(found: Estimate, growth: Array) -> Estimate:
    """Extrapolate linearly to no offset; the whole correction counts as error."""
    return Estimate(found.value - growth, found.error + np.abs(growth), found.extrapolated)


def geometry_error(
    problem: Conductors, level: Level, coarser: Level, opened: Level | None = None
) -> GeometryError:
    """Compare the coarsest levels with wraps of one offset, of twice that offset and, if they close hollows, with those `opened`.

    Where two wraps close the same hollow, their difference says nothing of it: what opening it changes is added, sizes as sizes.

    A larger conductor raises the matrix as a quadratic form, so that its diagonal is proven from above. A larger conductor that is
    grounded lowers all potentials, so that it raises the entries between other conductors. A larger conductor that is driven raises all
    potentials, so that it lowers its entries with other conductors. If several conductors, or a floating one, are wrapped, these two
    statements about an entry may contradict each other, and the entry is not proven.
    """
    count = len(problem.names)
    wrapped = {number for body, number in zip(problem.bodies, problem.owner) if isinstance(body, Wrap)}
    rows = np.array([number in wrapped for number in range(count)])
    only_grounded = all(number < count or number >= problem.driven for number in wrapped)
    diagonal = np.eye(count, dtype=bool)
    neither = ~rows[:, None] & ~rows[None]
    either = rows[:, None] ^ rows[None]
    steps = [(coarser, level)] if opened is None else [(coarser, level), (level, opened)]
    changes = [
        (larger.readings.change, smaller.readings.change)
        for larger, smaller in steps
        if larger.readings is not None and smaller.readings is not None
    ]
    return GeometryError(
        _sum([larger.maxwell - smaller.maxwell for larger, smaller in steps]),
        _sum([larger.delta_self - smaller.delta_self for larger, smaller in steps]),
        diagonal | (neither & only_grounded),
        ~diagonal & either & (len(wrapped) == 1),
        _sum([larger - smaller for larger, smaller in changes]) if changes else None,
    )


def _sum(parts: Sequence[Array]) -> Array:
    """The sum of the parts; where they have opposite signs, the one of the larger size, so that none hides another."""
    every = np.array(parts)
    largest = np.take_along_axis(every, np.abs(every).argmax(axis=0)[None], axis=0)[0]
    same = (np.sign(every) == np.sign(largest)).all(axis=0)
    return np.asarray(np.where(same, every.sum(axis=0), largest))
