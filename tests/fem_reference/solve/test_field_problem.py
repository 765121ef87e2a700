"""The solution on one mesh: properties of the discrete answer that do not depend on the size of the elements."""

from functools import cache

import numpy as np
import pytest

from fem_reference.bodies.conductors import Conductors, scaled
from fem_reference.bodies.shapes import Body, Cuboid
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import FIRST_BODY, NEAR_EDGE, OUTER_RADIUS, TaggedMesh, tagged_mesh
from fem_reference.solve.field_problem import Charges, FieldProblem, charges, with_floating, without_floating
from geometries.scene.poses import AxisRotation
from tests.fem_reference.problems import conductors_of, plate

UPRIGHT = AxisRotation((0, 1, 0), 90).matrix().T
SENSOR = plate("sensor", (0.5, 0.5), 0.1, 0.0, 0.0)


@cache
def above_box() -> tuple[Conductors, TaggedMesh, FieldProblem]:
    """A sensor plate, a plate above it and an upright box beside it."""
    box = Cuboid("box", np.array([1.2, 0.0, 0.1]), UPRIGHT, (0.3, 0.4, 0.2))
    problem = conductors_of([SENSOR, plate("plate", (0.5, 0.5), 0.1, 0.0, 0.4), box])
    mesh = tagged_mesh(problem, Sizing())
    return problem, mesh, FieldProblem(mesh, problem)


@cache
def solved() -> Charges:
    """Its charges, and the potentials that these follow from."""
    return charges(above_box()[2], 1)


def charges_by_reaction(potential: np.ndarray) -> list[float]:
    """The charges on the three conductors, by the sums over their unknowns."""
    system = above_box()[2]
    (reactions,) = system.reactions([potential])
    return [float(reactions[dofs].sum()) for dofs in system.dofs]


def test_the_mesh_tags_every_body_and_the_outer_sphere() -> None:
    _, mesh, _ = above_box()
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
    matrix = solved().maxwell
    assert np.array_equal(matrix, matrix.T)
    assert np.linalg.eigvalsh(matrix).min() > 0
    assert np.all(matrix[~np.eye(3, dtype=bool)] < 0)
    assert np.all(matrix.sum(axis=1) > 0)


def test_energies_are_the_charges_by_reaction() -> None:
    for column, potential in zip(solved().maxwell.T, solved().potentials):
        np.testing.assert_allclose(column, charges_by_reaction(potential), rtol=1e-4)


def test_without_its_objects_a_sensor_is_the_plate_alone() -> None:
    """Solved on the mesh of all three bodies and on a mesh of its own, the plate has the same capacitance to the mesh error."""
    single = conductors_of([SENSOR])
    alone = charges(FieldProblem(tagged_mesh(single, Sizing()), single), 1).maxwell * single.unit
    assert solved().sensors_alone * above_box()[0].unit == pytest.approx(alone, rel=1e-3)
    assert solved().sensors_alone[0, 0] < solved().maxwell[0, 0]


def test_a_floating_conductor_carries_no_charge_and_has_no_row() -> None:
    """With the box floating its reactions add up to 0, and those of the others are the rows of the reduced matrix."""
    potential = with_floating(np.array(solved().potentials), solved().maxwell, 1)[0]
    reactions = charges_by_reaction(potential)
    assert abs(reactions[2]) < 1e-6 * reactions[0]
    np.testing.assert_allclose(without_floating(solved().maxwell, 1)[:, 0], reactions[:2], rtol=1e-4)
    on_box = potential[above_box()[2].dofs[2]]
    assert np.ptp(on_box) < 1e-9 and 0 < on_box[0] < 1


def test_the_same_problem_gives_the_same_bits() -> None:
    system = above_box()[2]
    assert np.array_equal(system.energies(system.potentials(range(3), 3)), solved().maxwell)


def test_plates_of_one_sensor_are_one_conductor() -> None:
    """Two that share an edge and two that overlap are equivalent to the plate that they cover."""
    values = []
    for half_width, aside in ((0.25, 0.25), (0.35, 0.15), (0.5, 0.0)):
        bodies: list[Body] = [plate("sensor", (half_width, 0.5), x, 0, 0) for x in sorted({-aside, aside})]
        problem = scaled(Conductors(("sensor",), 1, tuple(bodies), (0,) * len(bodies)))
        values.append(charges(FieldProblem(tagged_mesh(problem, Sizing()), problem), 1).maxwell[0, 0])
    assert values == pytest.approx([values[-1]] * 3, rel=1e-3)
