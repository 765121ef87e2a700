"""What it costs that the cells follow curved surfaces only nearly: the energy in the layer between the cells' faces and the surface.

If a surface moves by δ along its normal, the energy of a field changes, to first order, by ∫ε·|∇u|²·δ on a conductor, and on the surface of a
dielectric body by ∫(ε − ε')·∇u·∇u'·δ, where ∇u and ∇u' are the fields on both sides (J. Hadamard 1908). With |δ|, the distance of the faces
from the surface, in the place of δ these are quadratic forms that bound the change to first order: NUMERICS.md section 5.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_reference.mesh.curved_surfaces import face_rule
from fem_reference.mesh.quarter_points import CORNERS, FACES
from fem_reference.solve.field_problem import FieldProblem, cell_permittivities
from fem_reference.solve.flux import with_field
from fem_reference.solve.upper_energy import CELLS_AT_A_TIME, gradients_in_cells, nodal_values
from geometries.common.arrays import Array

SAFETY = 1.5
"""Factor on the bound of first order, for the orders that it leaves out and the error of the field at the faces."""


def surface_shift(problem: FieldProblem, potentials: Array, permittivities: Mapping[int, float]) -> Array:
    """Bound by how much the energies of potentials (n, unknowns), with those of ghosts, change if every face is moved to its surface.

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
