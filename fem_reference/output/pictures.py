"""Pictures of the potential with the first sensor at 1 V: in a vertical plane, and as a VTU file for ParaView with the field and the bodies.

Solved on the coarsest mesh, with straight tetrahedra, without an error estimate.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import dolfinx
import meshio
import numpy as np
import ufl
from dolfinx import fem

from fem_reference.bodies.conductors import Conductors, conductors
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import FIRST_BODY, TaggedMesh, tagged_mesh
from fem_reference.solve.field_problem import COMPILATION, FieldProblem, first_sensor_driven
from geometries.common.arrays import Array, Indices
from geometries.common.files import whole_file
from geometries.scene.scene import Scene

POINTS = 121
"""Number of points along each side of the picture."""
REACH = 1.6
"""Half the width of the picture over the radius of the conductors' bounding sphere."""
SAME_PLACE = 0.02
"""Largest horizontal distance of two centres, over the radius of the bounding sphere, at which they count as lying above each other."""
_ROUNDING = 1e-9
"""Largest rounding error of the potential of a conductor that is driven, in volts."""


def driven_sensor(problem: Conductors) -> tuple[TaggedMesh, fem.Function]:
    """The mesh, and the potential with every other conductor grounded or, if it is floating, uncharged.

    Raises RuntimeError when the mesher or the solver fails.
    """
    tagged = tagged_mesh(problem, Sizing(), straight=True)
    system = FieldProblem(tagged, problem)
    potential = fem.Function(system.space)
    potential.x.array[:] = first_sensor_driven(system, len(problem.floating))
    return tagged, potential


def potential_slice(scene: Scene, source: str = "scene") -> dict[str, Any]:
    """{"origin": (2,), "direction": (2,), "along": (k,), "z": (k,), "potential": (k, k)}: metres, volts.

    The vertical plane goes through the centre of the first sensor and the common centre of all other bodies; it is parallel to x when
    these lie above each other. Its points have the horizontal coordinates origin + along·direction and the height z; the rows of
    `potential` follow z. The first sensor is at 1 V, every other conductor grounded or, if it is floating, uncharged. Raises
    InputError as `conductors` does.
    """
    problem = conductors(scene, source)
    potential = driven_sensor(problem)[1]
    origin, direction = _vertical_plane(problem)
    offsets = np.linspace(-REACH, REACH, POINTS)
    along, z = np.meshgrid(offsets, offsets)
    horizontal = origin + along.reshape(-1, 1) * direction
    values = _evaluate(potential, np.column_stack([horizontal, z.ravel()])).reshape(along.shape)
    return {
        "origin": (problem.centre[:2] + problem.unit * origin).tolist(),
        "direction": direction.tolist(),
        "along": (problem.unit * offsets).tolist(),
        "z": (problem.centre[2] + problem.unit * offsets).tolist(),
        "potential": np.round(values, 5).tolist(),
    }


def _vertical_plane(problem: Conductors) -> tuple[Array, Array]:
    """The point (2,) halfway between the two centres, and the plane's horizontal unit vector (2,) with x ≥ 0, in the scaled frame."""
    centres = [body.corners.mean(axis=0)[:2] for body in problem.bodies]
    sensor = np.mean([centres[k] for k in problem.bodies_of(0)], axis=0)
    elsewhere = [centre for centre, owner in zip(centres, problem.owner) if owner != 0]
    others = np.mean(elsewhere, axis=0) if elsewhere else sensor
    difference = others - sensor
    length = float(np.linalg.norm(difference))
    direction = difference / length if length > SAME_PLACE else np.array([1.0, 0.0])
    turned = direction[0] < 0 or (direction[0] == 0 and direction[1] < 0)
    return (sensor + others) / 2, -direction if turned else direction


def _evaluate(function: fem.Function, points: Array) -> Array:
    """Values (n,) of a function at points (n, 3); 0 outside of its mesh, that is behind the walls of a room."""
    mesh = function.function_space.mesh
    tree = dolfinx.geometry.BoundingBoxTree(mesh, mesh.topology.dim)
    candidates = dolfinx.geometry.compute_collisions(tree, points)
    cells = dolfinx.geometry.compute_colliding_cells(mesh, candidates, points)
    found = [k for k in range(len(points)) if len(cells.links(k))]
    values = np.zeros(len(points))
    values[found] = function.eval(points[found], [cells.links(k)[0] for k in found])[:, 0]
    return values


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
