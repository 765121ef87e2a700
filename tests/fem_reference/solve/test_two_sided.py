"""Differences from both bounds: exact where the errors of both scenes are equal, and with an error where they are not. Bounds of readings
in matrices that are known, and conductors that are connected to ground through a capacitance. What it costs that cells follow curved
surfaces only nearly: measured on meshes so coarse that it is most of the error."""

import numpy as np
import pytest
from scipy.constants import epsilon_0
from scipy.special import elliprf

from fem_reference import maxwell
from fem_reference.bodies.conductors import Measured
from fem_reference.bodies.round_bodies import Arc, Ellipsoid, Sphere
from fem_reference.bodies.shapes import Disc
from fem_reference.mesh.body_distances import distance_from_surface
from fem_reference.mesh.curved_surfaces import curved_faces, rim_errors
from fem_reference.mesh.quarter_points import straighten
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.solve.cell_gaps import BoundedMatrix
from fem_reference.solve.field_problem import without_floating
from fem_reference.solve.level import solve_level
from fem_reference.solve.readings import reading_bounds
from fem_reference.solve.two_sided import FRACTION_OF_DISTANCE, two_sided, unit_voltages
from geometries.common.arrays import Array
from geometries.scene.reader import loads
from tests import scenes
from tests.by_night import all_but
from tests.fem_reference.problems import ORIGIN, conductors_of, semidefinite
from tests.scenes import SENSOR


def bounded(matrix: Array, gaps: list[Array], shift: float = 0.0) -> BoundedMatrix:
    """Bounds of a matrix that leave these gaps in the cells of a mesh, half of it below and half above; curved surfaces change a share of them."""
    half = sum(gaps) / 2
    return BoundedMatrix(matrix - half, matrix + half, np.array(gaps), shift * np.array(gaps))


def test_what_curved_surfaces_change_in_both_scenes_cancels() -> None:
    own, wrong = np.eye(1), [np.array([[0.1]]), np.array([[0.2]])]
    both = bounded(2 * own, wrong, 0.3), bounded(own, wrong, 0.3)
    np.testing.assert_allclose(two_sided(own, own, *both, 1.0, 0.0).error, 0, atol=1e-12)
    one = bounded(2 * own, wrong, 0.3), bounded(own, wrong)
    found = two_sided(own, own, *one, 1.0, 0.0)
    np.testing.assert_allclose(found.error, 0.3 * 0.3)
    np.testing.assert_allclose(found.of_cells, [[0.03], [0.06]])


def test_errors_that_both_scenes_have_cancel() -> None:
    random = np.random.default_rng(1)
    matrix, around = semidefinite(random, 1.0), semidefinite(random, 0.5)
    gaps = [semidefinite(random, 0.01), semidefinite(random, 0.02)]
    own = np.eye(3)
    found = two_sided(own, own, bounded(matrix, gaps), bounded(around, gaps), 1.0, 0.0)
    np.testing.assert_allclose(found.value, np.diag(matrix - around), rtol=1e-12)
    np.testing.assert_allclose(found.error, 0, atol=1e-12)


def test_errors_of_different_cells_do_not_cancel() -> None:
    """The bounds of the difference would agree by chance, although one scene is wrong in one cell and the other in another."""
    own, wrong, nothing = np.eye(1), np.array([[0.1]]), np.zeros((1, 1))
    scenes = bounded(2 * own, [wrong, nothing]), bounded(own, [nothing, wrong])
    found = two_sided(own, own, *scenes, 1.0, 0.0)
    np.testing.assert_allclose(found.of_cells, FRACTION_OF_DISTANCE * np.array([[0.1], [0.1]]))
    np.testing.assert_allclose(found.error, 0.2 * FRACTION_OF_DISTANCE)


def test_errors_of_one_scene_only_are_stated() -> None:
    """Off the diagonal they count even where the two differences agree because the errors of the two conductors have no product."""
    matrix, wrong = 2 * np.eye(2), np.diag([0.2, 0.4])
    sensed, driven = unit_voltages(2, [[0], [0]]), unit_voltages(2, [[0], [1]])
    exact = bounded(np.eye(2), [np.zeros((2, 2))])
    found = two_sided(sensed, driven, bounded(matrix, [wrong]), exact, np.array([1.0, -1.0]), 0.0)
    np.testing.assert_allclose(found.value, [1, 0], atol=1e-12)
    np.testing.assert_allclose(
        found.error, FRACTION_OF_DISTANCE * np.array([0.2, np.sqrt(0.2 * 0.4)]), atol=1e-12
    )


@pytest.mark.parametrize("gap", all_but([0.05], [0.02, 0.05, 0.2]))
def test_one_mesh_gives_the_change_within_its_error(gap: float) -> None:
    """Against an estimate to 1e-3; the error stated for one mesh is a fraction of its interval's width."""
    scene = loads(SENSOR + scenes.body("target", "plate", size=[0.1, 0.1], translation=[0, 0, gap]))
    one = maxwell(scene, rtol=1e-2, max_unknowns=1)
    other = maxwell(scene, rtol=1e-3, error="estimate")
    assert len(one.levels) == 1 and other.reached and one.enclosure is not None
    difference = np.abs(one.delta_self.value - other.delta_self.value)
    assert np.all(difference <= one.delta_self.error + other.delta_self.error)
    assert one.delta_self.error[0] < one.enclosure.half_width[0, 0]
    print(
        f"\ngap {gap}: off by {difference / one.delta_self.value}, stated {one.delta_self.error / one.delta_self.value}"
    )


READINGS = (Measured("self", 0, (0,)), Measured("guarded", 0, (0, 2)), Measured("transmitted", 1, (0, 2)))


def test_a_reading_lies_between_the_bounds_of_two_quadratic_forms() -> None:
    random = np.random.default_rng(1)
    for _ in range(50):
        matrix = semidefinite(random, 1.0)
        found = reading_bounds(
            READINGS, matrix - semidefinite(random, 0.1), matrix + semidefinite(random, 0.1), 0.0
        )
        values = [matrix[0, 0], matrix[0, 0] + matrix[0, 2], -matrix[1, 0] - matrix[1, 2]]
        assert np.all(found[:, 0] <= values) and np.all(values <= found[:, 1])


def test_equal_forms_leave_no_doubt_but_that_of_curved_surfaces_by_both_energies() -> None:
    matrix = semidefinite(np.random.default_rng(2), 1.0)
    np.testing.assert_allclose(*reading_bounds(READINGS, matrix, matrix, 0.0).T, atol=1e-12)
    width = np.ptp(reading_bounds(READINGS[:1], matrix, matrix, 1e-3), axis=1)
    assert width == pytest.approx(2e-3 * matrix[0, 0])


def test_a_capacitance_to_ground_is_between_floating_and_grounded() -> None:
    """The energy for any voltages grows with the capacitance: the conductor's potential is less free to follow."""
    matrix = semidefinite(np.random.default_rng(4), 1.0)
    own = [without_floating(matrix, 1, [capacitance]) for capacitance in (0.0, 0.1, 1.0, 1e9)]
    for less, more in zip(own, own[1:]):
        assert np.all(np.linalg.eigvalsh(more - less) > -1e-12)
    np.testing.assert_allclose(own[0], without_floating(matrix, 1))
    np.testing.assert_allclose(own[-1], matrix[:2, :2], atol=1e-8)


COARSE = Sizing(growth=0.6, curvature=1.0)


@pytest.mark.parametrize(
    "semi_axes", all_but([(1.0, 0.6, 0.25)], [(1.0, 1.0, 0.2), (1.0, 0.6, 0.25)]), ids=str
)
def test_the_interval_of_an_ellipsoid_holds_the_closed_form(semi_axes: tuple[float, float, float]) -> None:
    """1/R_F(a², b², c²), with R_F as Carlson defined it."""
    problem = conductors_of([Ellipsoid("ellipsoid", ORIGIN, np.eye(3), semi_axes)], 0)
    found = solve_level(problem, 1.0, COARSE, "estimate", problem.mirror_planes)
    truth = 4 * np.pi * epsilon_0 / elliprf(*np.square(semi_axes))
    assert found.bounds is not None and found.estimated is not None
    assert found.bounds.interval.lower[0, 0] <= truth <= found.bounds.interval.upper[0, 0]
    value, error = (float(part[0, 0]) for part in found.estimated)
    assert abs(value - truth) <= error < 0.1 * truth


def test_distances_from_surfaces_are_measured_on_straight_faces_too() -> None:
    """A ball whose cells have straight sides, as where bent ones would be turned inside out: the faces are chords."""
    problem = conductors_of([Sphere("ball", ORIGIN, 0.5)])
    (ball,) = problem.bodies
    assert isinstance(ball, Sphere)
    mesh = tagged_mesh(problem, COARSE)
    bent = mesh.curved_faces.deviations.max()
    nodes = mesh.mesh.geometry.x
    straighten(nodes, mesh.mesh.geometry.dofmap.array.reshape(mesh.local_cells, -1))
    faces = curved_faces(mesh.mesh, mesh.cells, [ball])
    cells = mesh.mesh.geometry.dofmap.array.reshape(mesh.local_cells, -1)[faces.cells]
    corners = nodes[cells[:, :4]]
    longest = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=3).max()
    assert 5 * bent < faces.deviations.max() < longest**2 / (2 * ball.radius)
    # Every face is there from both sides.
    assert sorted(zip(faces.cells, faces.others)) == sorted(zip(faces.others, faces.cells))


def test_the_distance_from_an_arc_is_known_inside_of_it_too() -> None:
    arc = Arc("arc", ORIGIN, np.eye(3), 1.0, 2.0, 1.0, np.pi / 2)
    points = np.array([[1.9, 0, 0], [2.1, 0, 0], [1.1, 0, 0], [0.9, 0, 0], [1.5, 0, 0.45], [0.05, 1.5, 0]])
    np.testing.assert_allclose(
        distance_from_surface(arc, points.T), [0.1, 0.1, 0.1, 0.1, 0.05, 0.05], atol=1e-12
    )


def test_the_rim_of_a_disc_that_is_a_polygon_has_the_error_of_its_chords() -> None:
    problem = conductors_of([Disc("disc", ORIGIN, np.eye(3), 0.5)])
    (disc,) = problem.bodies
    assert isinstance(disc, Disc)
    mesh = tagged_mesh(problem, COARSE)
    assert 0 < mesh.mean_rim_error <= mesh.rim_error < 1e-3
    nodes, cells = mesh.mesh.geometry.x, mesh.mesh.geometry.dofmap.array.reshape(mesh.local_cells, -1)
    straighten(nodes, cells)
    errors, lengths = rim_errors([disc], nodes, cells)
    sagitta = disc.radius - np.sqrt(disc.radius**2 - lengths**2 / 4)
    np.testing.assert_allclose(errors, 2 * sagitta * (1 / disc.radius + 1 / lengths), rtol=1e-6)
