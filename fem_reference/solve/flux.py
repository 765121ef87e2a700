"""Lower bounds of the Maxwell matrix from divergence-free fluxes on one mesh (complementary energy).

For any voltages V the energy VᵀMV is the maximum over divergence-free fluxes σ of 2·Σ V_i·(flow of σ out of conductor i) −
∫|σ|². Maximising over Raviart–Thomas fluxes, extended to infinity along rays, gives a lower bound. The hybridised system imposes the
continuity of the flow from cell to cell by multipliers on the faces, which act as potentials there. Static condensation eliminates
the fluxes cell by cell and leaves a symmetric positive semidefinite system for the multipliers: NUMERICS.md section 5.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from fem_reference.mesh.distributed import summed, whole_numbers
from fem_reference.solve.face_solver import CellForms, FaceSystem
from fem_reference.mesh.tagged_mesh import FIRST_BODY, FREE_SPACE, OUTER_SURFACE, TaggedMesh
from fem_reference.mesh.quarter_points import (
    CORNERS,
    FACES,
    aligned_rule,
    map_derivatives,
    patterns,
    second_order,
    simplex_rule,
)
from fem_reference.solve.reference_flux import (
    ORDERS,
    FluxSpace,
    face_polynomials,
    flux_space,
    in_order,
    polynomials_on_face,
)
from fem_reference.solve.field_problem import cell_permittivities
from geometries.common.arrays import Array, Flags, Indices, Integers

CURVED_QUADRATURE_DEGREE = 12
"""Quadrature degree in cells on curved surfaces: twice the degree of the fluxes, and as much again for the cell's curvature."""

CHUNK = 1000
"""Number of cells condensed at a time, so that their matrices take no more than some tens of megabytes."""


@dataclass(frozen=True)
class FluxEnergies:
    """Energies (n, n) of the best fluxes (ε = 1), and how much too high the iteration may have left each diagonal entry."""

    lower: Array
    algebraic_error: Array
    multipliers: Array
    """The multipliers (n, faces, m) of these fluxes, which act as potentials on the faces that this process holds."""


@dataclass(frozen=True)
class _Cells:
    """Some cells of a mesh."""

    nodes: Array
    """(n, 10, 3): coordinates of the vertices and of the middle nodes."""
    faces: Integers
    """(n, 4): numbers of the faces."""
    orders: Integers
    """(n, 4): index of the order in ORDERS that sorts the vertices of each face by their numbers in the whole mesh."""
    on_edge: Flags
    """(n, 4): which vertices lie on the edge of a plate."""
    curved: Flags
    """(n,): which cells follow a curved surface."""

    def at(self, numbers: Indices) -> _Cells:
        """The cells of these numbers."""
        return _Cells(*(getattr(self, own.name)[numbers] for own in fields(self)))


class CondensedCells:
    """The cells of a mesh with fluxes of one degree. Each is condensed once, for ε = 1, when a scene first has a field in it."""

    def __init__(self, tagged: TaggedMesh, degree: int) -> None:
        self.tagged = tagged
        self.degree = degree
        self.cells = _all_cells(tagged)
        size = 4 * face_polynomials(degree)
        # Memory that is never written, as that of cells inside of conductors, is never taken.
        self._forms = np.empty((len(self.cells.faces), size, size))
        self._known = np.zeros(len(self.cells.faces), dtype=bool)

    def forms(self, numbers: Indices) -> Array:
        """The energies (n, m, m) of the best fluxes in these cells, as quadratic forms of the multipliers on their faces."""
        missing = numbers[~self._known[numbers]]
        if len(missing):
            self._forms[missing] = _condensed(self.cells.at(missing), self.degree)
            self._known[missing] = True
        return np.asarray(self._forms[numbers])


def flux_energies(
    condensed: CondensedCells,
    conductors: Sequence[Sequence[int]],
    driven: int,
    permittivities: Mapping[int, float],
    guesses: Array,
) -> FluxEnergies:
    """Solve for the best fluxes and return their energies.

    `conductors[k]` lists the bodies that make up conductor k. There is one flux for each of the first `driven` conductors; the other
    conductors are grounded. `permittivities` maps each dielectric body to its permittivity relative to the medium's. The iteration
    starts from multipliers `guesses` (driven, faces, m). Raises RuntimeError when it does not converge.
    """
    tagged, degree = condensed.tagged, condensed.degree
    numbers = with_field(tagged, permittivities)
    cells = condensed.cells.at(numbers)
    forms = condensed.forms(numbers)
    forms *= cell_permittivities(tagged, permittivities)[numbers, None, None]
    # The space beyond each face of the outer surface is one more cell, with this single face. A process's own cells come first.
    own = int(np.searchsorted(numbers, tagged.owned_cells))
    parts = [CellForms(forms, cells.faces, own)]
    fixed = [_faces_of(tagged, cells, bodies) for bodies in conductors]
    if tagged.in_room:
        fixed.append(_of_any_process(tagged, tagged.facets.find(OUTER_SURFACE)))
    else:
        parts.append(_condensed_exterior(tagged, cells, own, degree))
    system = FaceSystem(tagged.mesh, parts, np.concatenate(fixed), degree)
    solutions = [system.solve(faces, guess) for faces, guess in zip(fixed[:driven], guesses)]
    potentials = [solution.potentials for solution in solutions]
    energies_left = np.array([solution.energy_left for solution in solutions])
    return FluxEnergies(system.energies(potentials), energies_left, np.array(potentials))


def with_field(tagged: TaggedMesh, permittivities: Mapping[int, float]) -> Indices:
    """The numbers of the cells of free space and of dielectric bodies, where there is a field."""
    tags = [FREE_SPACE, *(FIRST_BODY + body for body in permittivities)]
    return np.sort(np.concatenate([tagged.cells.find(tag) for tag in tags])).astype(np.int64)


def _all_cells(tagged: TaggedMesh) -> _Cells:
    """Collect the cells of a mesh."""
    topology = tagged.mesh.topology
    for pair in ((3, 2), (3, 0), (2, 0)):
        topology.create_connectivity(*pair)
    count = tagged.local_cells
    vertices = whole_numbers(topology.index_map(0))[topology.connectivity(3, 0).array.reshape(count, 4)]
    codes = np.empty((count, 4), dtype=np.int32)
    place = np.array([9, 3, 1])
    lookup = np.zeros(27, dtype=np.int32)
    lookup[np.array(ORDERS) @ place] = np.arange(len(ORDERS))
    for face, corners in enumerate(FACES):
        codes[:, face] = lookup[np.argsort(vertices[:, corners], axis=1) @ place]
    geometry = tagged.mesh.geometry.dofmap.array.reshape(count, -1)
    return _Cells(
        tagged.mesh.geometry.x[geometry],
        topology.connectivity(3, 2).array.reshape(count, 4),
        codes,
        tagged.on_edge,
        tagged.curved,
    )


def _condensed(cells: _Cells, degree: int) -> Array:
    """Statically condense each cell: the energy (n, m, m) of its best flux for ε = 1, a quadratic form of the multipliers on its faces."""
    size = 4 * face_polynomials(degree)
    forms = np.empty((len(cells.faces), size, size))
    for collapsed, members in patterns(cells.on_edge):
        space = flux_space(degree, collapsed)
        for chosen, curved in _chunks(members, cells.curved):
            nodes = cells.nodes[chosen]
            mass = _curved_mass(nodes, space, collapsed) if curved else _straight_mass(nodes, space)
            flows = np.concatenate(
                [space.flows[face][cells.orders[chosen, face]] for face in range(4)], axis=1
            )
            forms[chosen] = flows @ np.linalg.solve(mass, flows.transpose(0, 2, 1))
    return forms


def _chunks(members: Indices, curved: Flags) -> Iterator[tuple[Indices, bool]]:
    """Split cells into chunks that are either all straight or all curved, with which it is."""
    for kind in (False, True):
        own = members[curved[members] == kind]
        for start in range(0, len(own), CHUNK):
            yield own[start : start + CHUNK], kind


def _straight_mass(nodes: Array, space: FluxSpace) -> Array:
    """Mass matrices ∫σ_n·σ_m (cells, n, n) of cells that are affine images of a reference element."""
    edges = nodes[:, 1:4] - nodes[:, :1]
    metric = edges @ edges.transpose(0, 2, 1) / np.abs(np.linalg.det(edges))[:, None, None]
    count = space.products.shape[2]
    return np.asarray((metric.reshape(-1, 9) @ space.products.reshape(9, -1)).reshape(-1, count, count))


def _curved_mass(nodes: Array, space: FluxSpace, collapsed: frozenset[int]) -> Array:
    """Mass matrices of any second-order cells, by quadrature. The integrands are rational, and smooth except at the edges of discs."""
    points, weights = aligned_rule(collapsed, CURVED_QUADRATURE_DEGREE)
    derivatives = map_derivatives(nodes, points)
    scaled = weights / np.abs(np.linalg.det(derivatives))
    values = space.values(points)
    mass = np.empty((len(nodes), values.shape[2], values.shape[2]))
    for k, derivative in enumerate(derivatives):
        mapped = derivative @ values
        flat = mapped.reshape(-1, mapped.shape[2])
        mass[k] = (np.repeat(scaled[k], 3)[:, None] * flat).T @ flat
    return mass


def _condensed_exterior(tagged: TaggedMesh, cells: _Cells, own: int, degree: int) -> CellForms:
    """Condense the space beyond the outer surface: the energy of the best flux from each of its faces to infinity.

    The first `own` of the cells belong to this process, and so do the forms beyond them. A flux of q per area that leaves along rays from the
    centre has the energy ∫ q²·|x|²/(x·n) dA.
    """
    barycentric, weights = simplex_rule(3, 2 * degree + 2)
    tests = polynomials_on_face(degree)
    outer = np.flatnonzero(np.isin(cells.faces.ravel(), tagged.facets.find(OUTER_SURFACE)))
    forms = []
    for cell, face in zip(*np.divmod(outer, 4)):
        corners = CORNERS[FACES[face]]
        tabulated = second_order().tabulate(1, barycentric @ corners)[:, :, :, 0]
        x = tabulated[0] @ cells.nodes[cell] - tagged.centre
        jacobian = np.einsum("dpk,ki->pid", tabulated[1:], cells.nodes[cell])
        area = np.cross(jacobian @ (corners[1] - corners[0]), jacobian @ (corners[2] - corners[0]))
        # q is given per reference area, that is q/|area| per area; one factor |area| remains in the denominator x·area.
        weight = weights * np.einsum("pi,pi->p", x, x) / np.abs(np.einsum("pi,pi->p", x, area))
        value = tests.tabulate(0, in_order(barycentric, ORDERS[cells.orders[cell, face]]))[0][:, :, 0]
        product = np.einsum("p,pm,pn->mn", weights, value, value)
        forms.append(product @ np.linalg.solve(np.einsum("p,pm,pn->mn", weight, value, value), product))
    size = face_polynomials(degree)
    return CellForms(
        np.array(forms).reshape(-1, size, size),
        cells.faces.ravel()[outer][:, None],
        int((outer < 4 * own).sum()),
    )


def _faces_of(tagged: TaggedMesh, cells: _Cells, bodies: Sequence[int]) -> Integers:
    """Numbers of the faces on the surfaces of these bodies."""
    found = []
    for body in bodies:
        found.append(tagged.facets.find(FIRST_BODY + body))
        inside = tagged.cells.find(FIRST_BODY + body)
        if len(inside):
            own = tagged.mesh.topology.connectivity(3, 2).array.reshape(-1, 4)[inside]
            found.append(np.intersect1d(own, cells.faces))
    return _of_any_process(tagged, np.concatenate(found))


def _of_any_process(tagged: TaggedMesh, faces: Integers) -> Integers:
    """Numbers of the faces, of those that this process holds, that are among the `faces` of any process.

    A process that holds one cell of a face as a ghost need not hold the other, inside a body, by which its owner knows the face.
    """
    entities = tagged.mesh.topology.index_map(2)
    among = np.zeros(entities.size_local + entities.num_ghosts)
    among[faces] = 1
    return np.flatnonzero(summed(entities, among)).astype(np.int32)
