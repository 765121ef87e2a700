"""Quarter-point elements at the edges of plates, and quadratures that are exact on them to rounding error; which vertices and sides of cells lie
on the edges of bodies.

At the edge of a plate without thickness the potential behaves as the square root of the distance. In a second-order element whose
mid-side nodes lie a quarter of the side away from the edge, polynomials in the reference coordinates have this behaviour (Henshell &
Shaw 1975, Barsoum 1976). If the sides are straight, such an element fills the straight tetrahedron, and its map replaces the
coordinate s, which grows away from the vertices on the edge, by s²: NUMERICS.md section 5.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

import basix
import numpy as np

from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.shapes import Body
from fem_reference.mesh.body_distances import edge_distance
from fem_reference.mesh.tape import SizeFunction, Tape
from geometries.common.arrays import Array, Flags, Indices, Integers


CORNERS = np.array(basix.geometry(basix.CellType.tetrahedron))
"""The vertices of the reference tetrahedron."""
FACES = np.array(basix.topology(basix.CellType.tetrahedron)[2])
"""The vertices of each of its faces; face f lies opposite vertex f."""
TETRAHEDRON_EDGES = np.array([[2, 3], [1, 3], [1, 2], [0, 3], [0, 2], [0, 1]])
"""Vertices of the edges that carry nodes 4 … 9 of a second-order tetrahedron, in the order of basix."""

RADIAL_DEGREE = 23
"""Degree of the Gauss rule along s, which has 12 points. The integrands are polynomials in s over (1 + s)², which are analytic except
at s = −1, so that n points leave an error of about 5.8^(−2n): with 12 points it is rounding error."""


def straighten(nodes: Array, cells: Integers) -> None:
    """Put the middle node of every side half way between its ends, in place."""
    for k, (i, j) in enumerate(TETRAHEDRON_EDGES):
        nodes[cells[:, 4 + k]] = (nodes[cells[:, i]] + nodes[cells[:, j]]) / 2


def pull(nodes: Array, cells: Integers, on_edge: Flags) -> None:
    """Move the middle node of every side with one end on a plate's edge to a quarter of the side from this end, in place."""
    straight = nodes.copy()
    for k, (i, j) in enumerate(TETRAHEDRON_EDGES):
        for near, far in ((i, j), (j, i)):
            pulled = on_edge[:, near] & ~on_edge[:, far]
            ends = straight[cells[pulled, near]], straight[cells[pulled, far]]
            nodes[cells[pulled, 4 + k]] = 0.75 * ends[0] + 0.25 * ends[1]


def is_pulled(on_edge: Flags) -> Flags:
    """Which cells (n,) are quarter-point elements: some, but not all, of their four vertices (n, 4) are on a plate's edge."""
    return np.asarray(on_edge.any(axis=1) & ~on_edge.all(axis=1))


def patterns(on_edge: Flags) -> Iterator[tuple[frozenset[int], Indices]]:
    """Group the cells by their vertices on a plate's edge (n, 4), towards which the quarter-point map collapses.

    Yields the vertices and the numbers of the cells; straight cells have no such vertices.
    """
    codes = np.where(is_pulled(on_edge), on_edge @ np.array([1, 2, 4, 8]), 0)
    for code in np.unique(codes):
        yield frozenset(k for k in range(4) if code >> k & 1), np.flatnonzero(codes == code)


@cache
def second_order() -> basix.finite_element.FiniteElement:
    """The second-order Lagrange element, whose shape functions map a second-order tetrahedron."""
    return basix.create_element(
        basix.ElementFamily.P, basix.CellType.tetrahedron, 2, basix.LagrangeVariant.equispaced
    )


def map_derivatives(nodes: Array, points: Array) -> Array:
    """Derivatives (cells, points, 3, 3) of the maps of the reference tetrahedron to second-order cells with nodes (cells, 10, 3)."""
    return np.asarray(np.einsum("dpk,cki->cpid", second_order().tabulate(1, points)[1:, :, :, 0], nodes))


def jacobian(collapsed: frozenset[int], points: Array) -> Array:
    """Derivatives (points, 3, 3) of the quarter-point map of the reference tetrahedron to itself.

    The map of an element with straight sides is this map followed by an affine one, so that its integrals are those over the
    reference tetrahedron with another metric.
    """
    nodes = np.vstack([CORNERS, np.zeros((len(TETRAHEDRON_EDGES), 3))])
    cell = np.arange(10, dtype=np.int32)[None]
    straighten(nodes, cell)
    pull(nodes, cell, np.array([[k in collapsed for k in range(4)]]))
    derivatives = second_order().tabulate(1, points)[1:, :, :, 0]
    return np.asarray(np.einsum("dpk,ki->pid", derivatives, nodes))


@cache
def aligned_rule(collapsed: frozenset[int], degree: int) -> tuple[Array, Array]:
    """Quadrature points (n, 3) and weights (n,) on the reference tetrahedron for the integrals over a quarter-point element.

    `collapsed` are the vertices on the plate's edge, one to three; without any the element is a usual one. Let s be the sum of the other barycentric coordinates. The integrand
    is analytic in s, and a polynomial of at most `degree` in the positions within the two simplices that the collapsed and the other
    vertices span.
    """
    if not collapsed:
        points, weights = basix.make_quadrature(basix.CellType.tetrahedron, degree)
        return np.asarray(points), np.asarray(weights)
    points, weights = basix.make_quadrature(basix.CellType.interval, RADIAL_DEGREE)
    s = points[:, 0]
    near, far = sorted(collapsed), [k for k in range(4) if k not in collapsed]
    near_points, near_weights = simplex_rule(len(near), degree)
    far_points, far_weights = simplex_rule(len(far), degree)
    shape = (len(s), len(near_weights), len(far_weights), 4)
    barycentric = np.empty(shape)
    barycentric[..., near] = (1 - s)[:, None, None, None] * near_points[None, :, None, :]
    barycentric[..., far] = s[:, None, None, None] * far_points[None, None, :, :]
    along_s = weights * (1 - s) ** (len(near) - 1) * s ** (len(far) - 1)
    total = along_s[:, None, None] * near_weights[None, :, None] * far_weights[None, None, :]
    return np.ascontiguousarray(barycentric.reshape(-1, 4)[:, 1:]), total.ravel()


def simplex_rule(vertices: int, degree: int) -> tuple[Array, Array]:
    """Barycentric points (n, vertices) and weights of a quadrature on a simplex; the weights add up to the reference volume."""
    if vertices == 1:
        return np.ones((1, 1)), np.ones(1)
    kind = {2: basix.CellType.interval, 3: basix.CellType.triangle}[vertices]
    points, weights = basix.make_quadrature(kind, degree)
    return np.column_stack([1 - points.sum(axis=1), points]), weights


ON_EDGE = 1e-7
"""Largest distance of a vertex on an edge, over the size of the body."""
ALONG_EDGE = 0.15
"""Largest distance of the middle of a tetrahedron's side from an edge, over the length of the side, if it lies along this edge: a
side along a circular edge is a chord, and one across a right-angled corner is 0.35 of its length away."""


def on_edges(bodies: Sequence[Body], nodes: Array, used: Integers) -> Flags:
    """Which of the nodes (n, 3) lie on an edge of one of the bodies; only those with the numbers `used` are looked at."""
    found = np.zeros(len(nodes), dtype=bool)
    for body in bodies:
        away = _distance_from_edges(body, nodes[used])
        if away is not None:
            found[used] |= away < ON_EDGE * body.size
    return found


def sides_along_edges(bodies: Sequence[Body], nodes: Array, cells: Integers) -> Indices:
    """The sides (n, 2) of tetrahedra that lie along the edges of bodies, by the numbers of their vertices."""
    used = np.unique(cells)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for body in bodies:
        on_edge = on_edges([body], nodes, used)
        if not on_edge.any():
            continue
        pairs = [cells[:, pair] for pair in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))]
        sides = np.unique(np.sort(np.concatenate([p[on_edge[p].all(axis=1)] for p in pairs]), axis=1), axis=0)
        ends = nodes[sides]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        middle = _distance_from_edges(body, ends.mean(axis=1)) if len(sides) else None
        if middle is not None:
            found.append(sides[middle < ALONG_EDGE * length])
    return np.asarray(np.unique(np.concatenate(found), axis=0), dtype=np.int64)


def _distance_from_edges(body: Body, points: Array) -> Array | None:
    """The distances (n,) of points from the nearest edge of a body; None if it has none."""
    if isinstance(body, Polyhedron):
        edges = body.vertices[body.edges]
        if not len(edges):
            return None
        return SizeFunction(Tape().distance(edges[:, [0, 1, 1]]))(points)
    found = edge_distance(body, points.T)
    return None if found is None else np.asarray(found)
