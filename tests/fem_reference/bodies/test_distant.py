"""Distant bodies that are left out: the interval still contains the true value, and no body that matters is left out."""

import numpy as np
import pytest

from fem_reference.bodies.shapes import Body
from fem_reference.bodies.distant import is_negligible, without_distant
from fem_reference.common.limits import Limits
from fem_reference.answer.reference import solve_conductors
from fem_reference.bodies.round_bodies import Sphere
from fem_reference.bodies.conductors import Conductors, Dielectric
from tests.fem_reference.problems import conductors_of, plate


NEAR: list[Body] = [plate("sensor"), plate("target", (0.4, 0.4), 0, 0, 0.5)]
FAR = Sphere("far", np.array([0, 0, 60.0]), 0.2)


def with_far(far: Body, kind: str, contrast: float = 5.0) -> Conductors:
    """A sensor, a target above it, and one more body."""
    body = Dielectric(far.name, contrast, contrast) if kind == "dielectrics" else far.name
    return conductors_of([*NEAR, far], **{kind: (body,)})


@pytest.mark.parametrize("kind", ["floating", "grounded", "dielectrics"])
def test_a_small_body_far_away_is_left_out_whatever_it_is_made_of(kind: str) -> None:
    reduced, (left,) = without_distant(with_far(FAR, kind), 1.0, 1e-3)
    assert left.name == "far" and np.all(left.bound > 0)
    assert (reduced.floating, reduced.grounded, reduced.dielectrics) == ((), (), ())
    expected = conductors_of(NEAR)
    assert reduced.unit == pytest.approx(expected.unit) and reduced.centre == pytest.approx(expected.centre)
    assert reduced.owner == (0, 1) and reduced.bodies[0].corners == pytest.approx(expected.bodies[0].corners)


def test_a_body_near_by_or_with_a_row_or_of_less_permittivity_is_not() -> None:
    kept = [
        with_far(Sphere("near", np.array([0, 0, 3.0]), 0.2), "floating"),
        conductors_of([*NEAR, FAR]),
        with_far(FAR, "dielectrics", contrast=0.5),
    ]
    for problem in kept:
        assert without_distant(problem, 1.0, 1e-3) == (problem, ())


def test_bodies_left_out_add_up() -> None:
    """As many bodies are left out as the accuracy allows together, the farthest first."""
    spheres = [Sphere(str(k), np.array([0, 0, 35.0 + 10 * k]), 0.2) for k in range(6)]
    problem = conductors_of([NEAR[0], *spheres], grounded=tuple(body.name for body in spheres))
    reduced, left = without_distant(problem, 1.0, 1e-3)
    assert 0 < len(left) < 6 and reduced.grounded == tuple(str(k) for k in range(6 - len(left)))
    assert sum(body.bound[0] for body in left) <= 1e-4 * 4


def test_what_matters_to_the_smallest_entry_is_not_negligible() -> None:
    maxwell = np.array([[1.0, -1e-6], [-1e-6, 1.0]])
    assert not is_negligible(np.array([1e-8, 1e-8]), maxwell, np.array([1e-8]), np.array([0.5]), 1e-3)
    assert is_negligible(np.array([1e-11, 1e-11]), maxwell, np.array([1e-11]), np.array([0.5]), 1e-3)
    assert not is_negligible(np.array([1e-11, 1e-11]), maxwell, np.array([1e-11]), np.array([1e-9]), 1e-3)


def test_the_bound_is_above_the_change_of_two_balls() -> None:
    """Grounding a far ball changes the entry by C12²/C22, from the series of images (Maxwell, Treatise, art. 173)."""
    a, b, apart = 1.0, 0.5, 40.0
    balls: list[Body] = [Sphere("near", np.zeros(3), a), Sphere("far", np.array([apart, 0, 0]), b)]
    problem = conductors_of(balls, grounded=("far",))
    _, (left,) = without_distant(problem, 1.0, 0.05)
    change = 4 * np.pi * a**2 * b / (apart**2 - b**2)
    assert change <= left.bound[0] <= 6 * change


def test_left_out_or_solved_whole_the_intervals_have_the_truth_in_common() -> None:
    """The body is at a distance at which it may not be left out at an accuracy of 1e-3, and is left out at 1e-2."""
    problem = with_far(Sphere("far", np.array([0, 0, 30.0]), 0.1), "floating")
    found = solve_conductors(problem, 2.0, rtol=1e-2, limits=Limits(seconds=1e-3))
    whole = solve_conductors(problem, 2.0, rtol=1e-3, limits=Limits(seconds=1e-3))
    assert [body.name for body in found.left_out] == ["far"] and whole.left_out == ()
    assert np.all(found.lower <= whole.upper) and np.all(whole.lower <= found.upper)
    assert np.all(np.diag(found.upper - found.lower) > found.left_out[0].bound)
    assert np.all(found.left_out[0].bound <= 1e-3 * np.diag(found.maxwell.value))
