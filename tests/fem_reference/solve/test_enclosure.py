"""Enclosures are narrow and always contain the known value. `pytest -s` prints them."""

from typing import Any

import numpy as np
import pytest

from analysis.topics.verification.set_ups import UNIT
from analysis.topics.verification.truths import UNIT_CUBE, UNIT_SQUARE_PLATE, stored
from fem_reference.answer.reference import solve_conductors
from fem_reference.bodies.conductors import Conductors, Dielectric, scaled
from fem_reference.bodies.shapes import Body, Cuboid, rectangle
from fem_reference.mesh.sizing import Sizing
from fem_reference.solve.enclosure import Enclosure, contradict, enclosure, intersection
from fem_reference.solve.level import Level, solve_level
from tests.by_night import all_but
from tests.fem_reference.problems import ORIGIN, PLATE, conductors_of, semidefinite

CASES = stored("boundary_elements")[::3]
"""A sample of the cases; `python3 -m analysis verify` runs all of them."""


@pytest.mark.parametrize("seed", range(20))
def test_every_matrix_between_the_bounds_is_enclosed(seed: int) -> None:
    """The entries of any M with L ≤ M ≤ U lie inside, if its off-diagonal entries are not positive, as those of a Maxwell matrix."""
    random = np.random.default_rng(seed)
    below, gap = np.diag([9.0, 8.0, 7.0]) - 2.5 + semidefinite(random, 0.1), semidefinite(random)
    found = enclosure(below, below + gap)
    for t in np.linspace(0, 1, 5):
        middle = below + t * gap
        middle[~np.eye(3, dtype=bool)] = np.minimum(middle[~np.eye(3, dtype=bool)], 0)
        assert np.all(found.lower <= middle + 1e-12) and np.all(middle <= found.upper + 1e-12)


def test_the_bound_off_the_diagonal_is_sharp() -> None:
    """With D = [[1, 1], [1, 1]] M may be L or U, whose off-diagonal entries are both half of D's entry away from the middle."""
    below = np.array([[4.0, -3.0], [-3.0, 4.0]])
    found = enclosure(below, below + 1)
    assert found.lower[0, 1] == pytest.approx(-3) and found.upper[0, 1] == pytest.approx(-2)


def test_a_lower_bound_above_the_upper_one_is_a_fault() -> None:
    with pytest.raises(RuntimeError, match="exceeds"):
        enclosure(np.ones((1, 1)), np.zeros((1, 1)))


def test_enclosures_intersect_and_give_what_holds_both_where_they_exclude_each_other() -> None:
    """Only entries that have nothing in common contradict: an interval is never upside down."""
    one = Enclosure(np.array([[1.0, -2.0]]), np.array([[2.0, -1.0]]))
    other = Enclosure(np.array([[3.0, -1.5]]), np.array([[4.0, -0.5]]))
    assert contradict([one, other]) and not contradict([one, one])
    found = intersection([one, other])
    np.testing.assert_array_equal(found.lower, [[1.0, -1.5]])
    np.testing.assert_array_equal(found.upper, [[4.0, -1.0]])


def conductors_in(case: dict[str, Any]) -> Conductors:
    bodies = [
        rectangle(str(k), *(np.array(plate[key]) for key in ("corner", "edge_u", "edge_v")))
        for k, plate in enumerate(case["rectangles"])
    ]
    sensors = sum(conductor.startswith("sensor") for conductor in case["conductors"])
    owner = tuple(plate["conductor"] for plate in case["rectangles"])
    return scaled(Conductors(tuple(case["conductors"]), sensors, tuple(bodies), owner))


def level(problem: Conductors, refinement: float) -> Level:
    return solve_level(problem, 1.0, Sizing(refinement=refinement), "enclosure", problem.mirror_planes)


@pytest.mark.parametrize(
    "body, truth, exactness",
    [
        (PLATE, UNIT_SQUARE_PLATE, 3e-6),
        (Cuboid("cube", ORIGIN, np.eye(3), (0.5, 0.5, 0.5)), UNIT_CUBE, 1e-12),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_width_falls_with_the_edge_size_around_the_truth(
    body: Body, truth: float, exactness: float
) -> None:
    """The known value is inside at each of three halvings of the edge size."""
    widths = []
    for refinement in (1, 2, 4):
        found = level(conductors_of([body]), refinement).enclosure
        assert found is not None
        below, above = (bound[0, 0] / (UNIT * truth) - 1 for bound in (found.lower, found.upper))
        print(f"\n{body.name}, refinement {refinement}: truth {below:+.2e} … {above:+.2e}")
        assert below <= exactness and above >= -exactness
        widths.append(above - below)
    assert widths[1] < 0.6 * widths[0] and widths[2] < 0.6 * widths[1]
    if body is PLATE:
        order = np.log2(widths[0] / widths[2]) / 2
        assert 0.85 <= order <= 1.25 and widths[2] <= 6e-4


def covered_plate(contrast: float) -> Conductors:
    """A square plate under a layer of a tenth of its side; of an infinite `contrast` the layer is a conductor of the plate."""
    layer = Cuboid("layer", np.array([0, 0, 0.05]), np.eye(3), (0.5, 0.5, 0.05))
    if np.isinf(contrast):
        return conductors_of([layer], 0)
    return conductors_of([PLATE, layer], 0, dielectrics=(Dielectric("layer", contrast, contrast),))


def test_bounds_beside_jumps_of_the_permittivity() -> None:
    """Intervals of two meshes have the truth in common, which lies between the bare plate and the conducting layer (Dirichlet's principle)."""

    def interval(contrast: float, refinement: float) -> tuple[float, float]:
        found = level(covered_plate(contrast), refinement).enclosure
        assert found is not None
        return float(found.lower[0, 0]), float(found.upper[0, 0])

    coarse, fine = interval(6.0, 0.5), interval(6.0, 2.0)
    assert max(coarse[0], fine[0]) < min(coarse[1], fine[1]) and np.ptp(fine) < 0.7 * np.ptp(coarse)
    assert interval(1.0, 0.5)[1] < fine[0] and fine[1] < interval(np.inf, 0.5)[0]
    bare = interval(1.0, 0.5)
    assert bare[0] < UNIT * UNIT_SQUARE_PLATE < bare[1], "a layer of the medium is not there"


@pytest.mark.parametrize("case", all_but(CASES[::3], CASES), ids=[case["name"] for case in CASES])
def test_plates_against_boundary_elements(case: dict[str, Any]) -> None:
    """The coarsest mesh encloses every entry of every case within the error of the boundary elements."""
    found = level(conductors_in(case), 1).enclosure
    assert found is not None
    truth = 1e-12 * np.array(case["maxwell_pF"])
    slack = case["relative_error"] * np.abs(truth)
    assert np.all(found.lower <= truth + slack) and np.all(truth - slack <= found.upper)
    width = np.max((found.upper - found.lower) / np.abs(truth))
    print(f"\n{case['name']}: widest {width:.1e}")
    assert width <= 0.03


def test_the_answer_stops_when_the_enclosure_is_narrow_enough_and_keeps_its_best_value_inside() -> None:
    found = solve_conductors(conductors_of([PLATE]), rtol=2e-4)
    truth = UNIT * UNIT_SQUARE_PLATE
    assert found.reached and found.error_kind == "enclosure" and found.worst <= 2e-4
    assert found.lower[0, 0] <= truth * (1 + 3e-6) and truth * (1 - 3e-6) <= found.upper[0, 0]
    assert found.lower[0, 0] <= found.maxwell.value[0, 0] <= found.upper[0, 0]
    assert abs(found.maxwell.value[0, 0] / truth - 1) <= (found.upper[0, 0] - found.lower[0, 0]) / truth / 5
