"""Adapts the size of the cells to the errors that a mesh leaves: where they are large, the next mesh is finer, elsewhere coarser.

The error of a capacitance is a sum over cells (`solve.cell_gaps`). Next to an edge with cells of size h it is κ·h^p per length of the edge, with a κ
that depends on how strong the singularity is there, and takes a number of cells in proportion to 1/h. For a given sum of the errors
the number of cells is least where κ·h^(p+1) is the same along all edges. Away from edges the error of a volume falls with a higher power of the size
of its cells. What the sum must be, and hence κ·h^(p+1), follows from the accuracy asked for: NUMERICS.md section 5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.quarter_points import ON_EDGE, sides_along_edges
from fem_reference.mesh.tape import SizeFunction, Tape
from fem_reference.mesh.sizing import AdaptedSizes, distance_on_tape
from geometries.common.arrays import Array, Indices, Integers

REACH = 3.0
"""Distance from an edge, over the size of the cells there, up to which cells count as next to it: their sizes grow from that at the edge."""
REACH_OF_GROWTH = 12.0
"""The same for the number of cells: nine tenths of the cells whose sizes grow from the edge are nearer."""
CELLS_PER_SIDE = 20.0
"""Number of cells that one more side along an edge takes."""
LEAST_RATIO, MOST_RATIO = 1 / 10, 3.0
"""Least and largest ratio of successive sizes at an edge."""
LEAST_DIVISION = 1.15
"""Ratio of successive sizes away from edges, from which on cells there are made smaller."""
FIRST_ORDER, FIRST_ORDER_OF_ESTIMATES, LATER_ORDER = 1.2, 1.5, 1.1
"""Orders of the errors at edges in the size there: 1 in theory, but 1.3 to 3 between the first two meshes; 1.2 to 1.8 with fluxes of degree 2."""
ORDER_ACROSS_GAPS, ACROSS = 4.0, 0.45
"""Order at edges whose cells reach across a gap, so that one polynomial has to represent what both sides of the gap cause, and the least size of such
cells over the width of the gap: between plates with a gap of 0.02 the order is 4 from 0.6 to 0.3 of it."""
AWAY_ORDER, AWAY_ORDER_OF_ESTIMATES = 6.0, 4.0
"""Orders of the errors away from edges in the size of the cells: between bounds by fluxes of degree 3, and of degree 2."""
LOGARITHMS, BISECTIONS = (-40.0, 10.0), 60
"""Interval of the logarithm of the error of one side along an edge, over the goal, and the number of times that it is halved."""
FRACTION_OF_GOAL = 0.75
"""Error that the next mesh is to leave, as a fraction of that asked for: meshes scatter, and a mesh more costs more than a larger one."""


@dataclass(frozen=True)
class Marks:
    """What the cells of one mesh add to q relative errors: next to vertices on edges, away from these, and elsewhere."""

    sides: Array
    """(s, 2, 3): the sides of cells along edges."""
    ends: Indices
    """(s, 2): the numbers of the vertices at their ends."""
    sizes: Array
    """(v,): the mean length of the sides at each vertex."""
    gaps: Array
    """(v,): the distance of each vertex from the nearest body of another conductor; infinite without one."""
    lengths: Array
    """(v,): the length of edge for which each vertex stands."""
    at_edges: Array
    """(v, q): the errors of the cells next to each vertex."""
    cells_at: Indices
    """(v,): the number of cells whose size grows from that at each vertex."""
    cells: int
    """Number of all cells."""
    places: Array
    """(m, 3): the middles of the other cells."""
    away_sizes: Array
    """(m,): the sizes of these cells."""
    away: Array
    """(m, q): their errors."""
    rest: Array
    """(q,): the remaining errors."""

    def orders(self, order: float) -> Array:
        """The orders (v,) of the errors at edges, if cells that do not reach across a gap have this one."""
        return np.where(self.sizes > ACROSS * self.gaps, np.maximum(order, ORDER_ACROSS_GAPS), order)


def marks(problem: Conductors, nodes: Array, cells: Integers, errors: Array, totals: Array) -> Marks:
    """Collect the errors (cells, q) of the cells (n, 4) of a mesh, whose sums are at most the `totals` (q,)."""
    corners = nodes[cells]
    sides = sides_along_edges(problem.bodies, nodes, cells)
    vertices, ends = np.unique(sides, return_inverse=True)
    ends = ends.reshape(-1, 2)
    lengths = np.linalg.norm(nodes[sides[:, 0]] - nodes[sides[:, 1]], axis=1)
    number = np.bincount(ends.ravel(), minlength=len(vertices))
    length = np.bincount(ends.ravel(), np.repeat(lengths, 2), len(vertices))
    size = length / np.maximum(number, 1)
    at_edges, count = np.zeros((len(vertices), errors.shape[1])), np.zeros(len(vertices), dtype=np.int64)
    middles = corners.mean(axis=1)
    near = np.zeros(len(cells), dtype=bool)
    if len(vertices):
        distances, nearest = cKDTree(nodes[vertices]).query(corners.reshape(-1, 3))
        distances, nearest = distances.reshape(-1, 4), nearest.reshape(-1, 4)
        closest = distances.argmin(axis=1)
        rows = np.arange(len(cells))
        near = distances[rows, closest] <= REACH * size[nearest[rows, closest]]
        # A cell with several vertices on edges adds an equal part to each of them, any other cell to the nearest vertex.
        is_least = (
            distances <= distances[rows, closest][:, None] + ON_EDGE * size[nearest[rows, closest]][:, None]
        )
        share = is_least & near[:, None]
        weight = share / np.maximum(share.sum(axis=1), 1)[:, None]
        for corner in range(4):
            np.add.at(at_edges, nearest[:, corner], weight[:, corner, None] * errors)
        grown = distances[rows, closest] <= REACH_OF_GROWTH * size[nearest[rows, closest]]
        count = np.bincount(nearest[rows, closest][grown], minlength=len(vertices))
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    away = ~near
    return Marks(
        nodes[sides],
        ends,
        size,
        _gaps(problem, nodes[vertices]),
        length / 2,
        at_edges,
        count,
        len(cells),
        middles[away],
        (6 * np.sqrt(2) * volume[away]) ** (1 / 3),
        errors[away],
        np.maximum(totals - errors.sum(axis=0), 0),
    )


def _gaps(problem: Conductors, points: Array) -> Array:
    """The distances (n,) of points on bodies from the nearest body of another conductor, or another dielectric body."""
    if not len(points):
        return np.zeros(0)
    distances = np.empty((len(problem.bodies), len(points)))
    for body, found in zip(problem.bodies, distances):
        found[:] = SizeFunction(distance_on_tape(body, Tape()))(points)
    owners = np.array(problem.owner)
    other = owners[:, None] != owners[distances.argmin(axis=0)]
    return np.asarray(np.where(other, distances, np.inf).min(axis=0))


def adapted_sizes(
    found: Marks, goal: float, order: float | Array, away_order: float = AWAY_ORDER
) -> AdaptedSizes:
    """Choose the sizes with the fewest cells that leave at most `goal` of each error, as far as the marks show.

    `order` is that of the errors at edges in the size there, one for all or (v,), `away_order` that of the errors elsewhere. Errors outside of the mesh and those of curved surfaces fall in other
    ways; at least half of the goal is for the cells.
    """
    goals = np.maximum(goal - found.rest, goal / 2)
    order = np.broadcast_to(np.asarray(order), found.sizes.shape)
    at_edges = (found.at_edges / goals).max(axis=1) * found.sizes / np.maximum(found.lengths, 1e-300)
    away = (found.away / goals).max(axis=1, initial=0.0)

    least = order.min(initial=np.inf)

    def ratios(logarithm: float) -> tuple[Array, Array]:
        """The ratios of sizes at edges, and the divisors of sizes away from them, if a side along an edge is to leave this error."""
        of_side = np.exp(logarithm)
        # Where the order is higher, a smaller size takes away more.
        ratio = (of_side * least / (order * np.maximum(at_edges, 1e-300))) ** (1 / (order + 1))
        division = (away_order / 3 * CELLS_PER_SIDE * away / of_side) ** (1 / (away_order + 3))
        return np.clip(ratio, LEAST_RATIO, MOST_RATIO), np.where(division > LEAST_DIVISION, division, 1.0)

    low, high = LOGARITHMS
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        ratio, division = ratios(middle)
        left = (found.at_edges * (ratio**order)[:, None]).sum(axis=0)
        left += (found.away / division[:, None] ** away_order).sum(axis=0)
        low, high = (middle, high) if np.all(left <= goals) else (low, middle)
    ratio, division = ratios(low)
    finer = division > 1
    ends = (found.sizes * ratio)[found.ends]
    points = np.repeat(found.places[finer][:, None], 3, axis=1)
    more = (found.cells_at / ratio - found.cells_at).sum() + (division**3 - 1).sum()
    return AdaptedSizes(
        np.concatenate([found.sides[:, [0, 1, 1]], points]),
        np.concatenate([np.sqrt(ends[:, 0] * ends[:, 1]), found.away_sizes[finer] / division[finer]]),
        float(1 + more / found.cells),
    )
