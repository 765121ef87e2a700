"""A machine at rest as others feel it, against closed forms: a ball and its images."""

import numpy as np
import pytest
from numpy.typing import NDArray

import fringe

from tests import scenes

RADIUS = 0.1
BALL = scenes.body("ball", "sphere", radius=RADIUS, segments=40, potential="electrode") + scenes.table(
    "reading", name="own", sense="ball", drive=["ball"]
)
WITHIN = 1e-2
"""The ball is a polyhedron within it."""


def around(count: int, nearest: float, farthest: float) -> NDArray[np.float64]:
    """Points in all directions at such distances from the origin."""
    chance = np.random.default_rng(1)
    directions = chance.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * chance.uniform(nearest, farthest, size=(count, 1))


def images(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """The potential, over that of a unit charge, at x of the image in a grounded ball of a charge at y, with the sign turned (Kelvin)."""
    lengths = np.linalg.norm(x, axis=1)[:, None] * np.linalg.norm(y, axis=1)
    return np.asarray(RADIUS / np.sqrt(lengths**2 - 2 * RADIUS**2 * (x @ y.T) + RADIUS**4))


def test_a_driven_ball_has_the_potential_of_a_charge_at_its_centre() -> None:
    scene = fringe.Scene.loads(BALL)
    machine = scene.machine_potentials(rtol=5e-3)
    points = around(300, 1.05 * RADIUS, 20 * RADIUS)
    loads = machine.at(points)
    (reading,) = machine.readings
    assert reading[0] == reading[1] and reading[2] == 1
    np.testing.assert_allclose(loads[:, reading[0]], RADIUS / np.linalg.norm(points, axis=1), rtol=WITHIN)


def test_close_to_a_surface_the_potential_is_the_sum_over_its_panels(sensor_before_a_housing: str) -> None:
    """Above a grounded housing the charges' potentials nearly cancel."""
    options = {"rtol": 0.01, "most_panels": 4000}
    scene = fringe.Scene.loads(sensor_before_a_housing)
    machine, charges = scene.machine_potentials(**options), scene.surface_charges(**options)
    assert machine.panels == len(charges["panels"])
    chance = np.random.default_rng(1)
    for distance in (0.002, 0.01, 0.03):
        points = np.column_stack([chance.uniform(-0.1, 0.1, size=(500, 2)), np.full(500, -0.11 - distance)])
        expected = fringe.triangle_potentials(points, charges["panels"]) @ charges["charges"][:, 0]
        np.testing.assert_allclose(machine.at(points)[:, 0], expected, rtol=0, atol=2.5e-4)


def test_potentials_do_not_depend_on_the_order_of_the_points() -> None:
    machine = fringe.Scene.loads(BALL).machine_potentials()
    points = around(500, 1.02 * RADIUS, 5 * RADIUS)
    order = np.random.default_rng(2).permutation(len(points))
    whole = machine.at(points)
    np.testing.assert_array_equal(whole[order], machine.at(points[order]))
    one_by_one = np.concatenate([machine.at(point[None]) for point in points[:20]])
    np.testing.assert_allclose(whole[:20], one_by_one, rtol=5e-3)
    assert machine.at(np.zeros((0, 3))).shape == (0, 1)


def test_a_body_before_a_ball_changes_it_as_the_images_say() -> None:
    """The body is three points that carry charges as small balls do."""
    machine = fringe.Scene.loads(BALL).machine_potentials(rtol=5e-3)
    points = np.array([[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.0, 0.03, 0.01]])
    own = np.full((3, 3), 0.0)
    np.fill_diagonal(own, 1 / 0.004)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        own[a, b] = own[b, a] = 1 / np.linalg.norm(points[a] - points[b])
    translations = around(40, 2 * RADIUS, 5 * RADIUS)
    answers = machine.answers(around(300, 1.5 * RADIUS, 6 * RADIUS))
    rotations = np.linalg.qr(np.random.default_rng(4).normal(size=(40, 3, 3)))[0]
    rotations[np.linalg.det(rotations) < 0, :, 0] *= -1
    for to_ground in (None, 0.0, 0.003):
        found, clears = machine.changes(points, own, rotations, translations, answers, to_ground)
        assert clears.all() and found.shape == (40, 1)
        for rotation, translation, change in zip(rotations, translations, found[:, 0]):
            placed = points @ rotation.T + translation
            given = RADIUS / np.linalg.norm(placed, axis=1)
            charges = np.linalg.solve(own - images(placed, placed), np.column_stack([given, np.ones(3)]))
            expected = given @ charges[:, 0]
            if to_ground is not None:
                expected -= charges[:, 0].sum() ** 2 / (charges[:, 1].sum() + to_ground)
            assert change == pytest.approx(expected, rel=3 * WITHIN)


def test_a_body_within_the_machine_does_not_clear_it_and_wrong_sizes_are_refused() -> None:
    machine = fringe.Scene.loads(BALL).machine_potentials()
    answers = machine.answers(around(300, 1.01 * RADIUS, 2 * RADIUS))
    one, turn = np.zeros((1, 3)), np.eye(3)[None]
    found, clears = machine.changes(one, [[1 / 0.02]], turn, [[RADIUS + 0.001, 0, 0]], answers)
    assert not clears[0] and found[0, 0] == 0
    with pytest.raises(ValueError, match="potentials: 2 × 2 values for 1 points"):
        machine.changes(one, np.eye(2), turn, one, answers)
    with pytest.raises(ValueError, match="answers have 3 rows, but there are"):
        machine.changes(one, [[1.0]], turn, one, np.zeros((3, 1)))
    with pytest.raises(ValueError, match="rotations must have shape"):
        machine.changes(one, [[1.0]], np.eye(3), one, answers)
