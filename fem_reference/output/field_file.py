"""Writes the field around a scene as a VTU file for ParaView: the potential, the field and the bodies."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fem_reference.output.driven_sensor import driven_sensor
from fem_reference.mesh.tagged_mesh import FIRST_BODY, TaggedMesh
from fem_reference.bodies.conductors import Conductors, conductors
from fem_reference.solve.field_problem import COMPILATION
from geometries.common.files import whole_file
from geometries.scene.scene import Scene

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

_ROUNDING = 1e-9
"""Largest rounding error of the potential of a conductor that is driven, in volts."""


def write_field_file(scene: Scene, target: Path, source: str = "scene") -> None:
    """Write the field with the first sensor at 1 V on the coarsest mesh, with straight tetrahedra; leaves no incomplete file behind.

    Every other conductor is grounded or, if it is floating, uncharged. Coordinates are in metres. The file has the `potential` (V) at
    the nodes, which of them are at `1 V: NAME` (1, else 0), NAME the conductor that is driven, the `field` (V/m) in the middle of the tetrahedra (NaN on the triangles of plates), and the `body` of tetrahedra and
    triangles: 0 in free space, else one more than the position in the answer's `conductors`, `floating` and `dielectrics`, in this
    order. Raises InputError as `conductors` does, RuntimeError when the mesher or the solver fails, OSError when the file cannot be
    written.
    """
    problem = conductors(scene, source)
    tagged, potential = driven_sensor(problem)
    cells = tagged.mesh.geometry.dofmap.array.reshape(-1, 4)
    plates, plate_bodies = _plates(tagged, problem)
    field = _field_in_cells(potential) / problem.unit
    at_nodes = _at_nodes(potential)
    content = meshio.Mesh(
        problem.centre + problem.unit * tagged.mesh.geometry.x,
        [("tetra", cells), ("triangle", plates)],
        point_data={
            "potential": at_nodes,
            f"1 V: {problem.names[0]}": np.isclose(at_nodes, 1, rtol=0, atol=_ROUNDING).astype(np.float64),
        },
        cell_data={
            "field": [field, np.full((len(plates), 3), np.nan)],
            "body": [_bodies_of_cells(tagged, problem), plate_bodies],
        },
    )
    with whole_file(target) as unfinished:
        meshio.write(unfinished, content)


def _at_nodes(potential: fem.Function) -> Array:
    """Values (n,) of a potential at the nodes of a mesh of straight tetrahedra."""
    mesh = potential.function_space.mesh
    linear = fem.Function(fem.FunctionSpace(mesh, ("Lagrange", 1), jit_params=COMPILATION))
    linear.interpolate(potential)
    values = np.zeros(len(mesh.geometry.x))
    values[mesh.geometry.dofmap.array] = linear.x.array[linear.function_space.dofmap.list.array]
    return values


def _field_in_cells(potential: fem.Function) -> Array:
    """The field −∇u (n, 3) in the middle of every cell."""
    mesh = potential.function_space.mesh
    vectors = ufl.VectorElement("DG", mesh.ufl_cell(), 0)
    constant = fem.Function(fem.FunctionSpace(mesh, vectors, jit_params=COMPILATION))
    middle = constant.function_space.element.interpolation_points()
    constant.interpolate(fem.Expression(-ufl.grad(potential), middle, jit_params=COMPILATION))
    return np.asarray(constant.x.array.reshape(-1, 3))


def _bodies_of_cells(tagged: TaggedMesh, problem: Conductors) -> Indices:
    """The `body` number (n,) of every tetrahedron."""
    bodies = np.zeros(tagged.cell_count, dtype=np.int64)
    for k, owner in enumerate(problem.owner):
        bodies[tagged.cells.find(FIRST_BODY + k)] = owner + 1
    return bodies


def _plates(tagged: TaggedMesh, problem: Conductors) -> tuple[Indices, Indices]:
    """The triangles of all plates as numbers of nodes (n, 3), and their `body` numbers (n,)."""
    topology = tagged.mesh.topology
    topology.create_connectivity(2, 0)
    node = np.zeros(topology.index_map(0).size_local, dtype=np.int64)
    node[topology.connectivity(3, 0).array] = tagged.mesh.geometry.dofmap.array
    corners = topology.connectivity(2, 0).array.reshape(-1, 3)
    facets = [tagged.facets.find(FIRST_BODY + k) for k in range(len(problem.bodies))]
    bodies = [np.full(len(found), owner + 1) for found, owner in zip(facets, problem.owner)]
    return node[corners[np.concatenate(facets)]], np.concatenate(bodies)
