"""Divergence-free Raviart–Thomas fluxes on the reference tetrahedron, and their flows through its faces.

A flux φ in reference coordinates stands for σ = J·φ/|det J| in space (the contravariant Piola map, P.-A. Raviart & J. M. Thomas
1977). σ is divergence-free where φ is, and has the same flow through every piece of a face. The flow through a face is tested with
polynomials in the barycentric coordinates of the face. Its vertices are taken in ascending order of their numbers in the mesh, so
that both cells at a face use the same polynomials.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import permutations

import basix
import numpy as np

from fem_reference.mesh.quarter_points import CORNERS, FACES, aligned_rule, jacobian, simplex_rule
from geometries.common.arrays import Array

ORDERS = list(permutations(range(3)))
"""The orders in which the three vertices of a face can be numbered."""


@dataclass(frozen=True)
class FluxSpace:
    """The divergence-free part of the Raviart–Thomas space on one kind of cell."""

    degree: int
    combinations: Array
    """(all, n): coefficients of the n fluxes in basix's basis of the whole Raviart–Thomas space."""
    flows: Array
    """(4, 6, m, n): flow of flux n through face f, tested with the face's polynomial m, for each order of the face's vertices."""
    products: Array
    """(3, 3, n, n): integrals of component d of one flux times component e of another, after the quarter-point map. In a cell that
    is an affine image of the reference tetrahedron the energy is their sum weighted with the metric."""

    def values(self, points: Array) -> Array:
        """The fluxes (points, 3, n) at points (points, 3) of the reference tetrahedron."""
        basis = _element(self.degree).tabulate(0, points)[0]
        return np.asarray(np.einsum("pad,an->pdn", basis, self.combinations))


def face_polynomials(degree: int) -> int:
    """Number of polynomials that test the flow through a face, which is the number of multipliers on it."""
    return degree * (degree + 1) // 2


@cache
def flux_space(degree: int, collapsed: frozenset[int] = frozenset()) -> FluxSpace:
    """The space of fluxes in cells whose `collapsed` vertices lie on the edge of a plate (`quarter_points`).

    In such a cell det J vanishes on the simplex of these vertices (an edge or a face): like the square of the distance from an edge.
    Only fluxes without a component along this edge, or within this face, have a finite energy: NUMERICS.md section 5.
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
        conditions.append(_conditions_within(element, degree, sorted(collapsed)))
    combinations = _null_space(np.vstack(conditions))
    flows = np.einsum("fpma,an->fpmn", _flows(degree), combinations)
    return FluxSpace(degree, combinations, flows, _products(element, degree, combinations, collapsed))


@cache
def polynomials_on_face(degree: int) -> basix.finite_element.FiniteElement:
    """The polynomials that test the flow through a face: a Lagrange basis, so that coefficients of 1 give the constant 1."""
    return basix.create_element(
        basix.ElementFamily.P,
        basix.CellType.triangle,
        degree - 1,
        basix.LagrangeVariant.equispaced,
        degree == 1,
    )


def in_order(barycentric: Array, order: tuple[int, ...]) -> Array:
    """Convert barycentric coordinates (n, 3) with respect to a face's local vertices to reference coordinates (n, 2) of the face.

    `order` is the order of ORDERS that sorts these vertices by their numbers in the mesh.
    """
    return barycentric[:, list(order)][:, 1:]


@cache
def _element(degree: int) -> basix.finite_element.FiniteElement:
    return basix.create_element(
        basix.ElementFamily.RT, basix.CellType.tetrahedron, degree, basix.LagrangeVariant.legendre
    )


@cache
def _flows(degree: int) -> Array:
    """The flows (4, 6, m, all) of basix's basis through the faces, tested with the polynomials of each face."""
    barycentric, weights = simplex_rule(3, 2 * degree)
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


def _conditions_within(
    element: basix.finite_element.FiniteElement, degree: int, vertices: list[int]
) -> Array:
    """Linear conditions (rows) that a flux has no component within the simplex of these vertices, on this simplex."""
    kind = {2: basix.CellType.interval, 3: basix.CellType.triangle}[len(vertices)]
    lattice = basix.create_lattice(kind, degree + 1, basix.LatticeType.equispaced, True)
    spans = CORNERS[vertices[1:]] - CORNERS[vertices[0]]
    points = CORNERS[vertices[0]] + lattice @ spans
    values = element.tabulate(0, points)[0]
    others = [k for k in range(4) if k not in vertices]
    rows = []
    for point, value in zip(points, values):
        # The flow along rays from this point to the far vertices is not restricted. So the flux is resolved in the frame of the
        # simplex's edges and these rays, and only its components along the edges must vanish.
        frame = np.vstack([spans, CORNERS[others] - point])
        rows.append((value @ np.linalg.inv(frame))[:, : len(spans)].T)
    return np.concatenate(rows)


def _products(
    element: basix.finite_element.FiniteElement, degree: int, combinations: Array, collapsed: frozenset[int]
) -> Array:
    """The integrals `FluxSpace.products`."""
    points, weights = aligned_rule(collapsed, 2 * degree + 2 if collapsed else 2 * degree)
    derivatives = jacobian(collapsed, points)
    values = np.einsum("pad,an->pdn", element.tabulate(0, points)[0], combinations)
    mapped = np.einsum("pid,pdn->pin", derivatives, values)
    scaled = weights / np.linalg.det(derivatives)
    return np.asarray(np.einsum("p,pdn,pem->denm", scaled, mapped, mapped, optimize=True))


def _null_space(matrix: Array) -> Array:
    _, singular, rows = np.linalg.svd(matrix)
    # The conditions may be linearly dependent, so that the dimension follows from their rank.
    rank = int(np.sum(singular > 1e-10 * singular[0]))
    return np.asarray(rows[rank:].T)
