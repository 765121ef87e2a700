"""The gap between both bounds of a scene's energies, cell by cell.

For a potential u and a divergence-free flux σ that have the same voltages, the upper bound of the energy minus the lower one is the
integral of |σ + ε∇u|²/ε (W. Prager & J. L. Synge 1947). The share of a cell follows from what is known on its faces: with Q the quadratic form
of the multipliers to which the fluxes of the cell are condensed, λ the multipliers, μ the projections of u to the face polynomials, and E the energy
of u in the cell, it is

    ∫|σ|²/ε + 2·∫σ·∇u + E = λᵀQλ − 2·μᵀQλ + E.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from fem_reference.mesh.distributed import gathered
from fem_reference.mesh.quarter_points import CORNERS, FACES, simplex_rule
from fem_reference.mesh.tagged_mesh import local_count
from fem_reference.solve.field_problem import (
    FieldProblem,
    cell_permittivities,
    with_floating,
    without_floating,
)
from fem_reference.solve.flux import CondensedCells, flux_energies, with_field
from fem_reference.solve.reference_flux import ORDERS, face_polynomials, in_order, polynomials_on_face
from fem_reference.solve.upper_energy import (
    CELLS_AT_A_TIME,
    cell_energies,
    lagrange,
    nodal_values,
    surface_shift,
    upper_energies,
)
from geometries.common.arrays import Array, Indices, Integers


@dataclass(frozen=True)
class BoundedMatrix:
    """Quadratic forms L ≤ M ≤ U (n, n) around the Maxwell matrix of one scene (ε = 1), and what every cell adds to their gap."""

    lower: Array
    upper: Array
    gaps: Array
    """(cells, n, n) of the whole mesh: their sum is U − L, except for the gap outside of the mesh; 0 in cells without a field."""
    shift: Array
    """(cells, n, n): parts of a bound of first order on what the bodies' curved surfaces change, which the cells follow only nearly."""

    @property
    def with_shift(self) -> BoundedMatrix:
        """The forms that bound the matrix of the bodies as they are; the gaps of the cells include what the surfaces change."""
        whole = self.shift.sum(axis=0)
        return BoundedMatrix(
            self.lower - whole, self.upper + whole, self.gaps + 2 * self.shift, 0 * self.shift
        )

    def of(self, rows: Sequence[int]) -> BoundedMatrix:
        """The same for some of the conductors."""
        chosen = np.ix_(rows, rows)
        parts = [form[:, chosen[0], chosen[1]] for form in (self.gaps, self.shift)]
        return BoundedMatrix(self.lower[chosen], self.upper[chosen], *parts)


def bounded_matrix(
    system: FieldProblem,
    condensed: CondensedCells,
    potentials: Sequence[Array],
    conductors: Sequence[Sequence[int]],
    permittivities: Mapping[int, float],
    floating: int = 0,
) -> BoundedMatrix:
    """Bound the matrix of a scene by its potentials and fluxes, and eliminate its last `floating` conductors, which keeps the order.

    `conductors[k]` lists the bodies of conductor k, the first of which have `potentials`, and `permittivities` are those of the bodies that
    have a field inside. Raises RuntimeError when the iteration for the fluxes does not converge.
    """
    with_ghosts = system.with_ghosts(potentials)
    guesses = _on_faces(system, condensed, with_ghosts)
    flux = flux_energies(condensed, conductors, len(potentials), permittivities, guesses)
    upper = upper_energies(system, potentials)
    lower = flux.lower - np.diag(flux.algebraic_error)
    above, below = (without_floating(form, floating, system.to_ground) for form in (upper, lower))
    fields = with_floating(with_ghosts, upper, floating, system.to_ground)
    multipliers = with_floating(flux.multipliers, lower, floating, system.to_ground)
    tagged = condensed.tagged
    numbers = with_field(tagged, permittivities)
    numbers = numbers[numbers < tagged.owned_cells]
    gaps = np.zeros((tagged.owned_cells, *below.shape))
    for start in range(0, len(numbers), CELLS_AT_A_TIME):
        chosen = numbers[start : start + CELLS_AT_A_TIME]
        gaps[chosen] = _gaps(system, condensed, fields, multipliers, permittivities, chosen)
    shift = surface_shift(system, fields, permittivities)
    return BoundedMatrix(below, above, *(gathered(tagged.mesh.comm, parts) for parts in (gaps, shift)))


def _gaps(
    system: FieldProblem,
    condensed: CondensedCells,
    potentials: Array,
    multipliers: Array,
    permittivities: Mapping[int, float],
    cells: Indices,
) -> Array:
    """The gaps (cells, n, n) between the energies of potentials (n, unknowns) and of the fluxes of multipliers (n, faces, m) in some cells."""
    own = condensed.cells.at(cells)
    at_nodes = nodal_values(system, potentials, cells)
    projected = _face_values(at_nodes, own.orders, condensed.degree)
    known = multipliers[:, own.faces].reshape(len(multipliers), len(cells), -1).transpose(1, 0, 2)
    forms = condensed.forms(cells)
    forms *= cell_permittivities(condensed.tagged, permittivities)[cells, None, None]
    off, both = known - projected, forms @ projected.transpose(0, 2, 1)
    found = cell_energies(system, potentials, cells) - projected @ both
    return np.asarray(found + off @ (forms @ off.transpose(0, 2, 1)))


def _on_faces(system: FieldProblem, condensed: CondensedCells, potentials: Array) -> Array:
    """Project potentials (n, unknowns) to the polynomials of all faces: multipliers (n, faces, m)."""
    faces = condensed.cells.faces
    per_face = face_polynomials(condensed.degree)
    found = np.zeros((len(potentials), local_count(condensed.tagged.mesh, 2), per_face))
    for start in range(0, len(faces), CELLS_AT_A_TIME):
        chosen = np.arange(start, min(start + CELLS_AT_A_TIME, len(faces)))
        at_nodes = nodal_values(system, potentials, chosen)
        own = _face_values(at_nodes, condensed.cells.orders[chosen], condensed.degree)
        values = own.reshape(len(chosen), len(potentials), 4, per_face).transpose(1, 0, 2, 3)
        found[:, faces[chosen]] = values
    return found


def _face_values(at_nodes: Array, orders: Integers, degree: int) -> Array:
    """Project potentials (cells, n, nodes) to the polynomials of each face: coefficients (cells, n, 4·m)."""
    projections = _projections(degree)
    found = np.empty((*at_nodes.shape[:2], len(FACES), projections.shape[2]))
    for face in range(len(FACES)):
        for order in range(len(ORDERS)):
            members = np.flatnonzero(orders[:, face] == order)
            found[members, :, face] = at_nodes[members] @ projections[face, order].T
    return found.reshape(*at_nodes.shape[:2], -1)


@cache
def _projections(degree: int) -> Array:
    """The matrices (4, 6, m, nodes) that project a potential to the polynomials of a face, for each order of the face's vertices."""
    barycentric, weights = simplex_rule(3, 2 * degree + 2)
    found = []
    for vertices in FACES:
        values = lagrange().tabulate(0, barycentric @ CORNERS[vertices])[0, :, :, 0]
        for order in ORDERS:
            tests = polynomials_on_face(degree).tabulate(0, in_order(barycentric, order))[0, :, :, 0]
            mass = np.einsum("p,pm,pn->mn", weights, tests, tests)
            found.append(np.linalg.solve(mass, np.einsum("p,pm,pk->mk", weights, tests, values)))
    return np.array(found).reshape(len(FACES), len(ORDERS), *found[0].shape)
