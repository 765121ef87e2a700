"""The solution on one mesh: properties of the discrete answer that do not depend on the size of the elements."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from fem_reference.bodies.shapes import Body, Cuboid, Rectangle
from fem_reference.mesh.tagged_mesh import FIRST_BODY, NEAR_EDGE, OUTER_RADIUS, TaggedMesh, tagged_mesh
from fem_reference.bodies.conductors import Conductors, normalised
from fem_reference.mesh.sizing import Sizing
from fem_reference.solve.field_problem import FieldProblem, charges, first_sensor_driven, without_floating
from geometries.scene.poses import AxisRotation

UPRIGHT = AxisRotation((0, 1, 0), 90).matrix().T


def plate(name: str, height: float, half_width: float = 0.5) -> Rectangle:
    return Rectangle(name, np.array([0.1, 0.0, height]), np.eye(3), (half_width, 0.5))


@cache
def above_box() -> tuple[Conductors, TaggedMesh, FieldProblem]:
    """A sensor plate, a plate above it and an upright box beside it."""
    box = Cuboid("box", np.array([1.2, 0.0, 0.1]), UPRIGHT, (0.3, 0.4, 0.2))
    problem = normalised(
        ["sensor", "plate", "box"], 1, [plate("sensor", 0.0), plate("plate", 0.4), box], range(3)
    )
    mesh = tagged_mesh(problem, Sizing())
    return problem, mesh, FieldProblem(mesh, problem)


def test_the_mesh_tags_every_body_and_the_outer_sphere() -> None:
    problem, mesh, _ = above_box()
    nodes = mesh.mesh.geometry.x
    assert np.linalg.norm(nodes, axis=1).max() == pytest.approx(OUTER_RADIUS, rel=1e-6)
    assert len(mesh.facets.find(FIRST_BODY)) > 100 and len(mesh.facets.find(FIRST_BODY + 1)) > 100
    assert len(mesh.cells.find(FIRST_BODY + 2)) > 100, "solids are meshed inside"
    assert 0 < len(mesh.near_edge.find(NEAR_EDGE)) < mesh.cell_count


def test_the_smallest_tetrahedra_are_at_the_edges_of_the_plates() -> None:
    """The cells at the edges have the prescribed size, within the scatter of tetrahedra."""
    problem, mesh, _ = above_box()
    cells = mesh.mesh.geometry.dofmap.array.reshape(-1, 10)[mesh.near_edge.values == NEAR_EDGE]
    corners = mesh.mesh.geometry.x[cells[:, :4]]
    longest = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=3).max(axis=(1, 2))
    asked = Sizing().edge * problem.bodies[0].size
    assert 0.5 * asked < np.median(longest) < 3 * asked


def test_the_maxwell_matrix_is_that_of_conductors_in_free_space() -> None:
    """The matrix is symmetric and positive definite, has negative off-diagonal entries, and is diagonally dominant: some flux escapes."""
    _, _, system = above_box()
    matrix = charges(system, 1).maxwell
    assert np.array_equal(matrix, matrix.T)
    assert np.linalg.eigvalsh(matrix).min() > 0
    assert np.all(matrix[~np.eye(3, dtype=bool)] < 0)
    assert np.all(matrix.sum(axis=1) > 0)


def test_energies_are_the_charges_by_reaction() -> None:
    _, _, system = above_box()
    potentials = system.potentials(range(3), 3)
    energies = system.energies(potentials)
    for j, potential in enumerate(potentials):
        source, image = system.stiffness.createVecRight(), system.stiffness.createVecLeft()
        source.array[:] = potential
        system.stiffness.mult(source, image)
        reactions = [image.array[dofs].sum() for dofs in system.dofs]
        np.testing.assert_allclose(energies[:, j], reactions, rtol=1e-4)


def test_without_its_objects_a_sensor_is_the_plate_alone() -> None:
    """Solved on the mesh of all three bodies and on a mesh of its own, the plate has the same capacitance to the mesh error."""
    problem, _, system = above_box()
    found = charges(system, 1)
    single = normalised(["sensor"], 1, [plate("sensor", 0.0)], [0])
    alone = charges(FieldProblem(tagged_mesh(single, Sizing()), single), 1).maxwell * single.unit
    assert found.sensors_alone * problem.unit == pytest.approx(alone, rel=1e-3)
    assert found.sensors_alone[0, 0] < found.maxwell[0, 0]


def test_a_floating_conductor_carries_no_charge_and_has_no_row() -> None:
    """With the box floating its reactions add up to 0, and those of the others are the rows of the reduced matrix."""
    _, _, system = above_box()
    potential = first_sensor_driven(system, 1)
    source, image = system.stiffness.createVecRight(), system.stiffness.createVecLeft()
    source.array[:] = potential
    system.stiffness.mult(source, image)
    reactions = [image.array[dofs].sum() for dofs in system.dofs]
    reduced = charges(system, 1, floating=1).maxwell
    assert abs(reactions[2]) < 1e-6 * reactions[0]
    np.testing.assert_allclose(reduced[:, 0], reactions[:2], rtol=1e-4)
    assert np.ptp(potential[system.dofs[2]]) == 0 and 0 < potential[system.dofs[2][0]] < 1


def test_a_floating_conductor_is_between_grounded_and_absent() -> None:
    """From a grounded to a floating to an absent third conductor, each step removes a constraint, so that the energies fall."""
    _, _, system = above_box()
    grounded = charges(system, 3).maxwell
    floating = without_floating(grounded, 1)
    absent = system.energies(system.potentials([0, 1], 2))
    assert np.linalg.eigvalsh(grounded[:2, :2] - floating).min() > 0
    assert np.linalg.eigvalsh(floating - absent).min() > 0


def test_a_sensor_of_two_rectangles_is_one_conductor() -> None:
    """Two halves that share an edge are equivalent to the whole plate."""
    halves: list[Body] = [
        Rectangle("left", np.array([-0.25, 0, 0]), np.eye(3), (0.25, 0.5)),
        Rectangle("right", np.array([0.25, 0, 0]), np.eye(3), (0.25, 0.5)),
    ]
    whole: list[Body] = [Rectangle("whole", np.zeros(3), np.eye(3), (0.5, 0.5))]
    values = []
    for bodies in (halves, whole):
        problem = normalised(["sensor"], 1, bodies, [0] * len(bodies))
        mesh = tagged_mesh(problem, Sizing(refinement=2))
        values.append(charges(FieldProblem(mesh, problem), 1).maxwell[0, 0])
    assert values[0] == pytest.approx(values[1], rel=5e-4)


def test_the_same_problem_gives_the_same_bits() -> None:
    _, _, system = above_box()
    first, again = charges(system, 1), charges(system, 1)
    assert np.array_equal(first.maxwell, again.maxwell)
