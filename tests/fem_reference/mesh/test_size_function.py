"""The sizes of the cells: compiled code gives what numpy gives of the same formulas, gaps that are left out set them nowhere, and they
follow the accuracy that was asked for. The sizes that errors ask for: the fewest cells for a given error, and no more error than asked
for."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fem_reference.bodies.distances import distance
from fem_reference.bodies.polyhedron import polyhedron
from fem_reference.bodies.round_bodies import Arc
from fem_reference.bodies.shapes import Cuboid, Rectangle
from fem_reference.mesh.body_distances import (
    ClosedFormBody,
    curvature_radius,
    curved_distance,
    edge_distance,
    surface_distance,
    wall_distance,
)
from fem_reference.mesh.marks import ORDER_ACROSS_GAPS, Marks, adapted_sizes
from fem_reference.mesh.tape import SizeFunction, Tape, smallest
from fem_reference.mesh.sizing import Sizing, _in_gap, _is_wide, size_at_edges, size_function, sizing_for
from geometries.scene import shapes
from tests.fem_reference.problems import BODIES, CENTRE, TURNED, conductors_of

BOX = BODIES[0]
assert isinstance(BOX, Cuboid)
POINTS = np.random.default_rng(1).uniform(-3, 3, (200, 3))


@pytest.mark.parametrize("body", BODIES, ids=lambda body: f"{body.name}")
def test_every_distance_is_the_same_on_a_tape(body: ClosedFormBody) -> None:
    for formula in (surface_distance, edge_distance, curvature_radius, curved_distance):
        expected = formula(body, POINTS.T)
        if isinstance(expected, np.ndarray):
            np.testing.assert_allclose(
                SizeFunction(formula(body, Tape().point))(POINTS), expected, rtol=1e-13
            )


def test_any_step_may_be_the_result_and_equal_steps_are_recorded_once() -> None:
    tape = Tape()
    x, y, _ = tape.point
    total = x + y
    smallest([2.0 - total, -(x + y) / 3])
    assert len(tape.steps) == len(set(tape.steps))
    np.testing.assert_array_equal(SizeFunction(total)(POINTS), POINTS[:, 0] + POINTS[:, 1])
    inside = wall_distance(Cuboid("room", np.zeros(3), np.eye(3), (4.0, 5.0, 6.0)), tape.point)
    np.testing.assert_allclose(SizeFunction(inside)(np.array([[3.5, -1.0, 2.0]])), 0.5)


def test_the_cells_on_a_thin_ring_keep_its_walls_apart() -> None:
    """Far from its edges, the chord of a cell is nearer to its own wall than to the other one."""
    ring = Arc("ring", np.zeros(3), np.eye(3), 0.99, 1.0, 2.0, np.pi)
    problem = conductors_of([ring])
    on_wall = np.array([[np.cos(angle), np.sin(angle), 0.0] for angle in (0.3, 2.0)])
    sizes = problem.unit * size_function(problem, Sizing())(on_wall / problem.unit)
    assert (sizes**2 / 8 < 0.01 / 2).all()


@pytest.mark.parametrize(
    "thickness, fine, coarse", [(0.8, 0.08, 0.16), (0.02, 0.02, 0.04), (0.002, 0.002, 0.008)]
)
def test_the_cells_at_the_edges_of_a_thin_wall_are_those_of_a_sheet_as_far_as_it_is_thick_enough(
    thickness: float, fine: float, coarse: float
) -> None:
    wall = Cuboid("wall", np.zeros(3), np.eye(3), (0.5, thickness / 2, 0.4))
    found = [size_at_edges(wall, sizing_for(rtol, 1.0)) for rtol in (1e-3, 1e-2)]
    np.testing.assert_allclose(found, (fine, coarse))


def test_what_a_tape_cannot_record_is_an_error() -> None:
    with pytest.raises(TypeError):
        np.sin(Tape().point[0])


def test_the_distance_from_triangles_is_that_from_the_solid_they_bound() -> None:
    """The box in many triangles; a tape with several surfaces finds each, and segments are triangles with two equal corners."""
    parts = shapes.Cuboid((0.4, 0.8, 1.2)).triangles()
    for _ in range(3):
        middles = [(parts[:, k] + parts[:, (k + 1) % 3]) / 2 for k in range(3)]
        thirds = [np.stack([parts[:, k], middles[k], middles[k - 1]], axis=1) for k in range(3)]
        parts = np.concatenate([*thirds, np.stack(middles, axis=1)])
    solid = polyhedron("box", parts @ TURNED + CENTRE)
    outside = POINTS[surface_distance(BOX, POINTS.T) > 0]
    tape = Tape()
    surface = tape.distance(solid.vertices[solid.triangles])
    edges = tape.distance(solid.vertices[solid.edges][:, [0, 1, 1]])
    np.testing.assert_allclose(SizeFunction(surface)(outside), surface_distance(BOX, outside.T), rtol=1e-9)
    np.testing.assert_allclose(SizeFunction(edges)(outside), edge_distance(BOX, outside.T), rtol=1e-9)


def test_the_least_sum_of_distance_and_offset_is_found_among_all_triangles() -> None:
    random = np.random.default_rng(2)
    places, offsets = random.uniform(-2, 2, (300, 3)), random.exponential(0.5, 300)
    found = SizeFunction(Tape().distance(np.repeat(places[:, None], 3, axis=1), offsets))(POINTS)
    sums = np.linalg.norm(POINTS[:, None] - places, axis=2) + offsets
    np.testing.assert_allclose(found, sums.min(axis=1), rtol=1e-12)


def test_in_a_wide_gap_the_growth_from_edges_is_smaller_everywhere() -> None:
    random = np.random.default_rng(1)
    sizing, left_out = Sizing(growth=0.6), 0
    for _ in range(200):
        axes = Rotation.random(2, random_state=int(random.integers(1 << 30))).as_matrix()
        body: Rectangle | Cuboid = Cuboid("body", np.zeros(3), axes[0], tuple(random.uniform(0.1, 1, 3)))
        if random.random() < 0.5:
            body = Rectangle("body", np.zeros(3), axes[0], tuple(random.uniform(0.1, 1, 2)))
        other = Cuboid("other", random.uniform(-4, 4, 3), axes[1], (0.3, 0.5, 0.2))
        ratio = _in_gap(body, other, sizing)
        if not _is_wide(body, distance(body, other), ratio, sizing):
            continue
        left_out += 1
        points = np.concatenate([random.uniform(-5, 5, (500, 3)), random.normal(size=(500, 3))])
        edges = edge_distance(body, points.T)
        assert edges is not None
        grown = size_at_edges(body, sizing) + sizing.growth * edges
        in_gap = ratio * (surface_distance(body, points.T) + surface_distance(other, points.T))
        assert np.all(grown <= in_gap)
    assert left_out > 50


def test_cells_follow_the_accuracy_that_is_asked_for() -> None:
    asked = [sizing_for(rtol, 1.0) for rtol in (1e-1, 2e-2, 1e-2, 1e-3, 9e-4, 1e-4)]
    growths = [each.growth for each in asked]
    assert growths == sorted(growths, reverse=True) and growths[0] == growths[3] > growths[4] > growths[5]
    coarse, middle, fine = asked[1:4]
    assert coarse.curvature > middle.curvature == fine.curvature and coarse.far > middle.far == fine.far
    assert (
        coarse.edge == middle.edge > fine.edge
        and coarse.edge_in_gap == middle.edge_in_gap == fine.edge_in_gap
    )


def chain(errors: list[float], away: list[float] | None = None) -> Marks:
    """Marks of an edge of sides of length 0.1 between vertices with these errors, and of cells of size 0.2 away from it."""
    count, others = len(errors), np.array(away or [])
    vertices = np.stack([0.1 * np.arange(count), np.zeros(count), np.zeros(count)], axis=1)
    ends = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    full = np.full(count, 0.1)
    places = np.tile([0.0, 5.0, 0.0], (len(others), 1))
    return Marks(
        vertices[ends],
        ends,
        full,
        np.full(count, np.inf),
        full,
        np.array(errors)[:, None],
        np.full(count, 30),
        30 * count + len(others),
        places,
        np.full(len(others), 0.2),
        others[:, None],
        np.zeros(1),
    )


def test_equal_errors_are_reduced_by_equal_sizes() -> None:
    found = adapted_sizes(chain([1.0] * 50), 25.0, 1.0)
    np.testing.assert_allclose(found.sizes, 0.05, rtol=1e-6)
    assert found.growth_of_cells == pytest.approx(2, rel=1e-6)


@pytest.mark.parametrize("order", [1.0, 1.4])
def test_the_error_is_that_asked_for_with_fewer_cells_than_equal_sizes_take(order: float) -> None:
    errors = np.repeat([4.0, 1.0, 0.25, 1.0], 50)
    goal = 0.3 * errors.sum()
    found = adapted_sizes(chain(errors.tolist()), goal, order)
    at_sides = errors[:-1]
    inside = np.diff(errors) == 0
    sizes = found.sizes[inside] / 0.1
    # Errors that are 4 times as large ask for sizes that are smaller by the power 1/(order + 1) of it.
    powers = sizes ** (order + 1) * at_sides[inside]
    np.testing.assert_allclose(powers, powers[0], rtol=1e-6)
    assert (sizes**order * at_sides[inside]).sum() == pytest.approx(goal, rel=0.05)
    assert found.growth_of_cells < 0.3 ** (-1 / order)


def test_every_quantity_reaches_the_goal() -> None:
    one = chain([1.0] * 40 + [1e-9] * 40)
    other = chain([1e-9] * 40 + [2.0] * 40)
    both = replace(one, at_edges=np.concatenate([one.at_edges, other.at_edges], axis=1), rest=np.zeros(2))
    found = adapted_sizes(both, 20.0, 1.0)
    assert found.sizes[10] <= 0.0501 and found.sizes[-10] <= 0.0251


def test_cells_away_from_edges_are_divided_only_where_they_matter() -> None:
    found = adapted_sizes(chain([1.0] * 20, [1e-12] * 5 + [3.0]), 10.0, 1.0)
    assert len(found.sizes) == 19 + 1 and found.sizes[-1] < 0.2 / 1.15
    np.testing.assert_allclose(found.triangles[-1], np.tile([0.0, 5.0, 0.0], (3, 1)))


def test_a_mesh_that_is_too_fine_becomes_coarser_within_limits() -> None:
    found = adapted_sizes(chain([1e-6] * 20), 10.0, 1.0)
    np.testing.assert_allclose(found.sizes, 0.3)


def test_cells_that_reach_across_a_gap_have_a_higher_order_and_stay_larger() -> None:
    near = np.repeat([0.2, 1.0], 40)
    found = replace(chain([1.0] * 80), gaps=near)
    orders = found.orders(1.2)
    np.testing.assert_array_equal(orders, np.repeat([ORDER_ACROSS_GAPS, 1.2], 40))
    sizes = adapted_sizes(found, 20.0, orders).sizes / 0.1
    assert sizes[10] > 1.2 * sizes[-10]
    left = 40 * (sizes[10] ** ORDER_ACROSS_GAPS + sizes[-10] ** 1.2)
    assert left == pytest.approx(20, rel=0.01)
