"""Divergence-free fluxes on the reference tetrahedron, and their normal components through its faces.

A flux φ in reference coordinates stands for σ = J·φ/|det J| in space (the contravariant Piola map, P.-A. Raviart & J. M. Thomas
1977): divergence-free where φ is, and with the same flow through every piece of a face. What flows through a face is tested with polynomials in the face's own barycentric
coordinates, its vertices in ascending order of their numbers in the mesh, so that both cells at a face use the same ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import permutations

import basix
import numpy as np
from numpy.typing import NDArray

from fem_reference.mesh.quarter_points import aligned_rule, jacobian

Array = NDArray[np.float64]

CORNERS = np.array(basix.geometry(basix.CellType.tetrahedron))
FACES = np.array(basix.topology(basix.CellType.tetrahedron)[2])
"""Vertices of face f, which lies opposite vertex f."""
ORDERS = list(permutations(range(3)))


@dataclass(frozen=True)
class FluxSpace:
    """The divergence-free part of the Raviart–Thomas space on one kind of cell."""

    degree: int
    combinations: Array
    """(all, n): the n fluxes as combinations of basix's basis."""
    flows: Array
    """(4, 6, m, n): flux n through face f tested with the face's polynomial m, for each order of the face's vertices."""
    products: Array
    """(3, 3, n, n): the integrals of component d of one flux times component e of the other, after the quarter-point map.
    In a cell that is an affine image of the reference tetrahedron the energy is their sum over the metric."""

    def values(self, points: Array) -> Array:
        """The fluxes (points, 3, n) at points (points, 3) of the reference tetrahedron."""
        basis = _element(self.degree).tabulate(0, points)[0]
        return np.asarray(np.einsum("pad,an->pdn", basis, self.combinations))


def face_polynomials(degree: int) -> int:
    """How many polynomials test the flow through a face."""
    return degree * (degree + 1) // 2


@cache
def flux_space(degree: int, collapsed: frozenset[int] = frozenset()) -> FluxSpace:
    """The space for cells whose `collapsed` vertices lie on the edge of a plate (`quarter_points`).

    There det J vanishes on the simplex of these vertices, like the square of the distance to an edge, and only fluxes
    that do not flow along this edge (or within this face) have a finite energy: NUMERICS.md section 5.
    """
    element = _element(degree)
    points, weights = basix.make_quadrature(basix.CellType.tetrahedron, 2 * degree)
    derivatives = element.tabulate(1, points)
    divergence = sum(derivatives[1 + axis][:, :, axis] for axis in range(3))
    tests = basix.create_element(
        basix.ElementFamily.P, basix.CellType.tetrahedron, degree - 1, basix.LagrangeVariant.legendre, True
    ).tabulate(0, points)[0][:, :, 0]
    conditions = [np.einsum("p,pm,pa->ma", weights, tests, divergence)]
    if 2 <= len(collapsed) <= 3:
        conditions.append(_flow_within(element, degree, sorted(collapsed)))
    combinations = _null_space(np.vstack(conditions))
    flows = np.einsum("fpma,an->fpmn", _flows(degree), combinations)
    return FluxSpace(degree, combinations, flows, _products(element, degree, combinations, collapsed))


@cache
def polynomials_on_face(degree: int) -> basix.finite_element.FiniteElement:
    """The polynomials that test the flow through a face: a Lagrange basis, so that all ones are the constant 1."""
    return basix.create_element(
        basix.ElementFamily.P,
        basix.CellType.triangle,
        degree - 1,
        basix.LagrangeVariant.equispaced,
        degree == 1,
    )


def in_order(barycentric: Array, order: tuple[int, ...]) -> Array:
    """Reference coordinates (n, 2) on a face of points given by barycentric coordinates (n, 3) of its local vertices."""
    return barycentric[:, list(order)][:, 1:]


@cache
def _element(degree: int) -> basix.finite_element.FiniteElement:
    return basix.create_element(
        basix.ElementFamily.RT, basix.CellType.tetrahedron, degree, basix.LagrangeVariant.legendre
    )


@cache
def _flows(degree: int) -> Array:
    points, weights = basix.make_quadrature(basix.CellType.triangle, 2 * degree)
    barycentric = np.column_stack([1 - points.sum(axis=1), points])
    tests = polynomials_on_face(degree)
    flows = []
    for face, vertices in enumerate(FACES):
        corners = CORNERS[vertices]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        if normal @ (CORNERS[face] - corners[0]) > 0:
            normal = -normal
        through = _element(degree).tabulate(0, barycentric @ corners)[0] @ normal
        values = [tests.tabulate(0, in_order(barycentric, order))[0][:, :, 0] for order in ORDERS]
        flows.append([np.einsum("p,pm,pa->ma", weights, value, through) for value in values])
    return np.array(flows)


def _flow_within(element: basix.finite_element.FiniteElement, degree: int, vertices: list[int]) -> Array:
    """Rows that vanish for the fluxes without a component within the simplex of these vertices, on this simplex."""
    kind = {2: basix.CellType.interval, 3: basix.CellType.triangle}[len(vertices)]
    lattice = basix.create_lattice(kind, degree + 1, basix.LatticeType.equispaced, True)
    spans = CORNERS[vertices[1:]] - CORNERS[vertices[0]]
    points = CORNERS[vertices[0]] + lattice @ spans
    values = element.tabulate(0, points)[0]
    others = [k for k in range(4) if k not in vertices]
    rows = []
    for point, value in zip(points, values):
        # Along a ray from this point to the far vertices the flow may be what it is: it counts in the frame of the
        # simplex's edges and these rays.
        frame = np.vstack([spans, CORNERS[others] - point])
        rows.append((value @ np.linalg.inv(frame))[:, : len(spans)].T)
    return np.concatenate(rows)


def _products(
    element: basix.finite_element.FiniteElement, degree: int, combinations: Array, collapsed: frozenset[int]
) -> Array:
    if collapsed:
        points, weights = aligned_rule(collapsed, 2 * degree + 2)
    else:
        points, weights = basix.make_quadrature(basix.CellType.tetrahedron, 2 * degree)
    derivatives = jacobian(collapsed, points)
    values = np.einsum("pad,an->pdn", element.tabulate(0, points)[0], combinations)
    mapped = np.einsum("pid,pdn->pin", derivatives, values)
    scaled = weights / np.linalg.det(derivatives)
    return np.asarray(np.einsum("p,pdn,pem->denm", scaled, mapped, mapped, optimize=True))


def _null_space(matrix: Array) -> Array:
    _, singular, rows = np.linalg.svd(matrix)
    # Conditions may depend on each other: their rank counts.
    rank = int(np.sum(singular > 1e-10 * singular[0]))
    return np.asarray(rows[rank:].T)
