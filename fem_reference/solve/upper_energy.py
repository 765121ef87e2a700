"""Upper bounds of the Maxwell matrix: the exact energies, out to infinity, of the potentials found on one mesh.

Any continuous potential that is V_i on conductor i has at least the energy VᵀMV (Dirichlet's principle). The solver's potentials,
continued to infinity by 1/t along rays from the centre, are of this kind however inexact the iteration was, so that their exactly
integrated energies are upper bounds: NUMERICS.md section 5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import basix
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_vector
from petsc4py import PETSc

from fem_reference.mesh.curved_surfaces import face_rule
from fem_reference.mesh.quarter_points import (
    CORNERS,
    FACES,
    aligned_rule,
    is_pulled,
    jacobian,
    map_derivatives,
    patterns,
)
from fem_reference.mesh.tagged_mesh import AWAY_FROM_EDGES, OUTER_SURFACE
from fem_reference.solve.field_problem import (
    COMPILATION,
    DEGREE,
    FieldProblem,
    cell_permittivities,
    permittivity,
)
from fem_reference.solve.flux import with_field
from geometries.common.arrays import Array, Indices


CURVED_QUADRATURE_DEGREE = 12
"""Quadrature degree in cells on curved surfaces: twice the degree of the potentials, and as much again for the cell's curvature."""

CHUNK = 500
"""Number of curved cells integrated at a time, so that the values at their quadrature points take some tens of megabytes at most."""

CELLS_AT_A_TIME = 4000
"""Number of cells whose stiffness matrices are computed at a time: they take some tens of megabytes."""


def upper_energies(problem: FieldProblem, potentials: Sequence[Array]) -> Array:
    """The energies (n, n) of potentials (unknowns,) continued to infinity; ε is 1 outside of dielectric bodies."""
    fields = problem.with_ghosts(potentials)
    own = _away_from_edges(problem, fields) + _near_edges(problem, fields)
    return np.asarray(problem.tagged.mesh.comm.allreduce(own))


def _away_from_edges(problem: FieldProblem, potentials: Array) -> Array:
    """The energies (n, n) in this process's straight cells and, without a room, beyond their faces on the outer surface.

    Values u on the outer surface are continued as u(x)/t along the ray t·x, t ≥ 1. With d = x·n this continuation has the energy
    ∫ d·|∇_Γ u|² + (u + x·∇_Γ u)²/d dA.
    """
    tagged = problem.tagged
    u, v = fem.Function(problem.space), ufl.TestFunction(problem.space)
    dx = ufl.Measure("dx", domain=tagged.mesh, subdomain_data=tagged.near_edge)
    ds = ufl.Measure("ds", domain=tagged.mesh, subdomain_data=tagged.facets)
    # Both quadratures are exact on straight cells and flat faces, where gradients are polynomials and normals constant.
    away = dx(AWAY_FROM_EDGES, metadata={"quadrature_degree": 2 * DEGREE - 2})
    outer = ds(OUTER_SURFACE, metadata={"quadrature_degree": 2 * DEGREE})
    x = ufl.SpatialCoordinate(tagged.mesh) - fem.Constant(tagged.mesh, PETSc.ScalarType(tuple(tagged.centre)))
    normal = ufl.FacetNormal(tagged.mesh)
    distance = ufl.dot(x, normal)

    def along(w: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return ufl.grad(w) - ufl.dot(ufl.grad(w), normal) * normal

    energy = ufl.inner(ufl.grad(u), ufl.grad(v))
    if problem.permittivities:
        energy *= permittivity(tagged, problem.permittivities)
    form = energy * away
    if not tagged.in_room:
        form += distance * ufl.dot(along(u), along(v)) * outer
        form += (u + ufl.dot(x, along(u))) * (v + ufl.dot(x, along(v))) / distance * outer
    # The products with a matrix, without the matrix, which takes ten times as long to assemble as a product.
    compiled = fem.form(form, jit_params=COMPILATION)
    images = []
    for potential in potentials:
        u.x.array[:] = potential
        image = assemble_vector(compiled)
        # The vector with the unknowns of other processes, to which this process's cells have added.
        with image.localForm() as local:
            images.append(local.array.copy())
        image.destroy()
    found = potentials @ np.array(images).T
    return np.asarray((found + found.T) / 2)


def _near_edges(problem: FieldProblem, potentials: Array) -> Array:
    """The energies (n, n) in this process's other cells: quarter-point elements, integrated to rounding error, and cells on curved surfaces."""
    near = np.flatnonzero(is_pulled(problem.tagged.on_edge) | problem.tagged.curved)
    near = near[near < problem.tagged.owned_cells]
    energies = np.zeros((len(potentials), len(potentials)))
    for start in range(0, len(near), CELLS_AT_A_TIME):
        chosen = near[start : start + CELLS_AT_A_TIME]
        energies += cell_energies(problem, potentials, chosen).sum(axis=0)
    return energies


def cell_energies(problem: FieldProblem, potentials: Array, cells: Indices) -> Array:
    """The energies (cells, n, n) of potentials (n, unknowns), with those of ghosts, in each of some cells."""
    tagged = problem.tagged
    values = nodal_values(problem, potentials, cells)
    nodes = tagged.mesh.geometry.x[tagged.mesh.geometry.dofmap.array.reshape(tagged.local_cells, -1)[cells]]
    coefficient = cell_permittivities(tagged, problem.permittivities)[cells]
    energies = np.empty((len(cells), len(potentials), len(potentials)))
    for collapsed, members in patterns(tagged.on_edge[cells]):
        curved = tagged.curved[cells[members]]
        straight, others = members[~curved], members[curved]
        if len(straight):
            inverse = np.linalg.inv(nodes[straight, 1:4] - nodes[straight, :1])
            volume = coefficient[straight] / np.abs(np.linalg.det(inverse))
            metric = inverse.transpose(0, 2, 1) @ inverse * volume[:, None, None]
            stiffness = (metric.reshape(-1, 9) @ _products(collapsed).reshape(9, -1)).reshape(
                len(straight), values.shape[2], values.shape[2]
            )
            energies[straight] = values[straight] @ stiffness @ values[straight].transpose(0, 2, 1)
        for start in range(0, len(others), CHUNK):
            some = others[start : start + CHUNK]
            energies[some] = _curved_energies(nodes[some], values[some], coefficient[some], collapsed)
    return energies


def nodal_values(problem: FieldProblem, potentials: Array, cells: Indices) -> Array:
    """The values (cells, n, nodes) of potentials (n, unknowns) at the nodes of each of some cells."""
    dofs = problem.space.dofmap.list.array.reshape(problem.tagged.local_cells, -1)[cells]
    return np.ascontiguousarray(potentials[:, dofs].transpose(1, 0, 2))


def _curved_energies(nodes: Array, values: Array, coefficient: Array, collapsed: frozenset[int]) -> Array:
    """Energies (cells, n, n) of potentials (cells, n, dofs) in any second-order cells (cells, 10, 3), by quadrature."""
    points, weights = aligned_rule(collapsed, CURVED_QUADRATURE_DEGREE)
    gradients, derivatives = gradients_in_cells(nodes, values, points)
    volumes = coefficient[:, None] * weights * np.abs(np.linalg.det(derivatives))
    return np.asarray(np.einsum("cp,cpdi,cpdj->cij", volumes, gradients, gradients, optimize=True))


def gradients_in_cells(nodes: Array, values: Array, points: Array) -> tuple[Array, Array]:
    """Gradients (cells, p, 3, n) of potentials (cells, n, dofs) at points of any second-order cells (cells, 10, 3), and the derivatives
    (cells, p, 3, 3) of the cells' maps."""
    derivatives = map_derivatives(nodes, points)
    slopes = np.einsum("dpk,cjk->cpdj", lagrange().tabulate(1, points)[1:, :, :, 0], values)
    return np.linalg.solve(derivatives.transpose(0, 1, 3, 2), slopes), derivatives


@cache
def lagrange() -> basix.finite_element.FiniteElement:
    """The element of the potentials."""
    return basix.create_element(
        basix.ElementFamily.P, basix.CellType.tetrahedron, DEGREE, basix.LagrangeVariant.gll_warped
    )


@cache
def _products(collapsed: frozenset[int]) -> Array:
    """Integrals (3, 3, n, n) over the reference tetrahedron of ∂_d of one shape function times ∂_e of another.

    The derivatives are taken after the quarter-point map. In a cell that is an affine image of the reference tetrahedron the energy
    is the sum of these integrals weighted with the metric.
    """
    points, weights = aligned_rule(collapsed, 2 * DEGREE + 2)
    derivatives = jacobian(collapsed, points)
    slopes = lagrange().tabulate(1, points)[1:, :, :, 0]
    gradients = np.linalg.solve(derivatives.transpose(0, 2, 1), slopes.transpose(1, 0, 2))
    volumes = weights * np.linalg.det(derivatives)
    return np.asarray(np.einsum("p,pdn,pem->denm", volumes, gradients, gradients, optimize=True))


SAFETY = 1.5
"""Factor on the bound of first order, for the orders that it leaves out and the error of the field at the faces."""


def surface_shift(problem: FieldProblem, potentials: Array, permittivities: Mapping[int, float]) -> Array:
    """Bound by how much the energies of potentials (n, unknowns), with those of ghosts, change if every face is moved to its surface, which the cells
    follow only nearly.

    If a surface moves by δ along its normal, the energy of a field changes, to first order, by ∫ε·|∇u|²·δ on a conductor, and on the surface of a
    dielectric body by ∫(ε − ε')·∇u·∇u'·δ, where ∇u and ∇u' are the fields on both sides (J. Hadamard 1908). With |δ|, the distance of the faces
    from the surface, in the place of δ these are quadratic forms that bound the change to first order: NUMERICS.md section 5.

    Returns the parts (cells, n, n) of the process's own cells. `permittivities` are those of the bodies that have a field inside, as if
    the medium had 1.
    """
    tagged = problem.tagged
    faces = tagged.curved_faces
    parts = np.zeros((tagged.owned_cells, len(potentials), len(potentials)))
    has_field = np.zeros(tagged.local_cells, dtype=bool)
    has_field[with_field(tagged, permittivities)] = True
    own, other = (cell_permittivities(tagged, permittivities)[cells] for cells in (faces.cells, faces.others))
    is_conductor = ~has_field[faces.others]
    # Each face between two media is there from both sides, which share its part.
    normal = np.where(is_conductor, own, np.abs(own - other) / 2 * own / other)
    tangential = np.where(is_conductor, own, np.abs(own - other) / 2)
    matters = has_field[faces.cells] & (is_conductor | (own != other))
    nodes = tagged.mesh.geometry.x[tagged.mesh.geometry.dofmap.array.reshape(tagged.local_cells, -1)]
    for side in range(len(FACES)):
        chosen = np.flatnonzero(matters & (faces.sides == side))
        for start in range(0, len(chosen), CELLS_AT_A_TIME):
            some = chosen[start : start + CELLS_AT_A_TIME]
            cells = faces.cells[some]
            values = nodal_values(problem, potentials, cells)
            gradients, normals = _at_face(nodes[cells], values, side)
            areas = np.linalg.norm(normals, axis=2)
            along = np.einsum("cpin,cpn->cpi", gradients, normals / areas[:, :, None])
            weights = SAFETY * face_rule(side)[1] * areas * faces.deviations[some]
            every = np.einsum("cp,cpin,cpjn->cij", weights, gradients, gradients, optimize=True)
            across = np.einsum("cp,cpi,cpj->cij", weights, along, along, optimize=True)
            found = tangential[some, None, None] * (every - across) + normal[some, None, None] * across
            np.add.at(parts, cells, found)
    return parts


def _at_face(nodes: Array, values: Array, side: int) -> tuple[Array, Array]:
    """Gradients (cells, p, n, 3) of potentials (cells, n, dofs) in cells (cells, 10, 3) at the points of a face, and normals (cells, p, 3) whose
    lengths are the areas that those of the reference triangle become."""
    gradients, derivatives = gradients_in_cells(nodes, values, face_rule(side)[0])
    corners = CORNERS[FACES[side]]
    first, second = (derivatives @ (corners[k] - corners[0]) for k in (1, 2))
    return gradients.transpose(0, 1, 3, 2), np.cross(first, second)
