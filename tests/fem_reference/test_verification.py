"""The reference against known values that do not come from finite elements; `pytest -s` prints both.

Every test asserts two things: the known value lies within the stated error, and the stated error is small. The set-ups with names are
a sample of those that `python3 -m analysis verify` runs. Last, changes that must not matter to an answer do not.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.special import elliprf

from analysis.topics.verification import set_ups
from analysis.topics.verification.set_ups import UNIT, true_cases
from analysis.topics.verification.truths import (
    LEKNER,
    UNIT_SQUARE_PLATE,
    UNIT_SQUARE_PLATE_ERROR,
    body_of_revolution,
    grounded,
    love,
    sphere_and_plane,
    strips,
    two_balls,
)
from fem_reference.answer.convergence import SHARED_ERROR, estimate
from fem_reference.answer.reference import Reference, solve_conductors
from fem_reference.bodies.round_bodies import Ellipsoid, Swept
from fem_reference.bodies.shapes import Body, Cuboid, Disc
from fem_reference.mesh.sizing import Sizing
from fem_reference.solve.level import solve_level
from tests.by_night import all_but
from tests.fem_reference.invariances import compared, random_scene, written_prism
from tests.fem_reference.problems import ORIGIN, PLATE, TURNED, conductors_of, polygon


def solve(body: Body, rtol: float = 1e-3) -> Reference:
    return solve_conductors(conductors_of([body]), rtol=rtol, error="estimate")


def check(name: str, value: float, error: float, truth: float, truth_error: float, widest: float) -> None:
    """Assert |value − truth| ≤ error + the truth's own error, both relative, and error ≤ widest·|truth|."""
    off, stated = abs(value / truth - 1), error / abs(truth)
    print(f"\n{name}: off by {off:.1e}, stated {stated:.1e}, off/stated {off / stated:.2f}")
    assert off <= stated + truth_error and stated <= widest


@pytest.mark.parametrize(
    ("name", "widest"),
    [
        ("square plate", 5e-4),
        ("cone", 1e-3),
        ("coaxial discs, gap/radius 1", 2e-3),
        ("size 3x3 on 10x10 gap1.5", 1e-3),
        ("the same, the second of permittivity 5", 1e-3),
        *(
            pytest.param(name, widest, marks=pytest.mark.night)
            for name, widest in (
                ("cube", 7e-4),
                ("cylinder", 1e-3),
                ("parallel squares, gap/side 0.2", 2e-3),
                ("inclined hinge1.5 25deg", 1e-3),
                ("corner 0.8 1.2 height1.5", 1e-3),
                ("two sensors 6x10 plate height2.5", 1e-3),
                ("balls of radii 1 and 2, gap 2", 3e-4),
                ("the same, the second floating", 3e-4),
                ("the same, the second of permittivity 0.2", 3e-4),
            )
        ),
    ],
)
def test_a_known_capacitance(name: str, widest: float) -> None:
    """A floating or dielectric ball has no row; it changes the entry of the other one, whose delta_self is known less exactly."""
    case = true_cases()[name]
    found = solve_conductors(case.set_up.conductors(), rtol=min(1e-3, widest), error="estimate")
    assert found.reached and found.maxwell.value.shape == 2 * (len(case.set_up.names),)
    for quantity in case.quantities:
        row = set_ups.compared(quantity, found)
        allowed = widest if quantity.of else 5 / 3 * widest
        words = f"{name}, {quantity.name}"
        check(words, row["value"], row["error"], quantity.truth, quantity.truth_error, allowed)


@pytest.mark.parametrize(
    "truth, published, exactness",
    [
        (love, {1.0: 0.579573861, 0.1: 2.938980798}, 1e-8),
        (strips, {0.5: 1.489949325, 1.0: 2.115778971, 2.0: 3.263468863, 5.0: 6.490675751}, 1e-9),
        (sphere_and_plane, {1.0: 1.341059813, 0.5: 1.535370509, 0.1: 2.155086117, 0.01: 3.238234662}, 1e-9),
    ],
)
def test_integral_equations_integrals_and_series_reproduce_published_values(
    truth: Callable[[float], float], published: dict[float, float], exactness: float
) -> None:
    assert {at: truth(at) for at in published} == pytest.approx(published, rel=exactness)


def test_the_multipoles_of_two_balls_reproduce_published_values() -> None:
    own, mutual = two_balls(0.01, 0.02, 0.05, grounded)
    other, _ = two_balls(0.02, 0.01, 0.05, grounded)
    np.testing.assert_allclose(UNIT * np.array([own, other, mutual]), LEKNER, rtol=1e-9)


def test_rings_of_charge_reproduce_known_values() -> None:
    """Check the method on a ball made of flat rings, and against Smythe's formula (1962) for cylinders, accurate to 0.2 %."""
    angles = np.linspace(0, np.pi, 9)
    inscribed = body_of_revolution(list(zip(np.abs(np.sin(angles)), -np.cos(angles))))
    assert 0.98 < inscribed < 1
    cylinder = body_of_revolution([(0, -1), (1, -1), (1, 1), (0, 1)])
    assert cylinder == pytest.approx((8 + 6.95) / (4 * np.pi), rel=2e-3)


@pytest.mark.night
def test_the_error_falls_linearly_with_the_edge_size() -> None:
    """Measures the order of convergence on which extrapolation and adaptation rely, 1, from the true errors of four meshes of halved sizes.

    Values of five are extrapolated.
    """
    problem = conductors_of([PLATE])
    sizes = [Sizing(growth=0.25, refinement=2.0**k) for k in range(5)]
    levels = [solve_level(problem, 1.0, sizing, "none", problem.mirror_planes) for sizing in sizes]
    truth = UNIT * UNIT_SQUARE_PLATE
    errors = [level.maxwell[0, 0] / truth - 1 for level in levels]
    order = np.polyfit(np.log([level.edge_size for level in levels[:4]]), np.log(errors[:4]), 1)[0]
    print(f"\nobserved order {order:.2f}")
    assert 0.85 <= order <= 1.15
    assert all(error > 0 for error in errors), "a conforming potential has too much energy"
    found = estimate([level.maxwell for level in levels])
    # The error that all levels share was measured at a growth of 0.4; it falls with the sixth power of the growth.
    error = found.error[0, 0] + SHARED_ERROR * (0.25 / 0.4) ** 6 * found.value[0, 0]
    check("five levels", found.value[0, 0], error, truth, UNIT_SQUARE_PLATE_ERROR, 1e-4)


def test_two_meshes_give_a_small_error() -> None:
    found = solve(PLATE, 1e-4)
    assert found.reached and len(found.levels) <= 3
    value, error = found.maxwell.value[0, 0], found.maxwell.error[0, 0]
    check("adapted", value, error, UNIT * UNIT_SQUARE_PLATE, UNIT_SQUARE_PLATE_ERROR, 1e-4)


SQUARE = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))


@pytest.mark.parametrize(
    "body, truth, exactness, widest",
    [
        # 1/R_F(a², b², c²), which is (1/2)∫ds/√((a² + s)(b² + s)(c² + s)) over 0 … ∞, inverted.
        pytest.param(
            Ellipsoid("ellipsoid", ORIGIN, TURNED, (1.0, 0.7, 0.5)),
            1 / elliprf(1.0, 0.49, 0.25),
            0,
            1e-3,
            marks=pytest.mark.night,
        ),
        (Swept("swept point", ORIGIN, TURNED, (0.0, 0.0, 0.0), 1.0), 1.0, 0, 3e-4),
        (Disc("disc", ORIGIN, TURNED, 1.0), 2 / np.pi, 0, 1e-3),
        (polygon("square", SQUARE, ORIGIN, TURNED), UNIT_SQUARE_PLATE, UNIT_SQUARE_PLATE_ERROR, 1e-3),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_capacitance_of_one_body(body: Body, truth: float, exactness: float, widest: float) -> None:
    found = solve(body, widest).maxwell
    check(body.name, found.value[0, 0], found.error[0, 0], UNIT * truth, exactness, widest)


@pytest.mark.night
def test_a_capsule_is_that_of_rings_of_charge() -> None:
    """The outline of the rings is inscribed in the capsule's; two polygons give the limit of infinitely many sides."""

    def inscribed(sides: int) -> float:
        angles = np.linspace(0, np.pi / 2, sides + 1)
        lower = [(float(np.sin(a)), float(-1 - np.cos(a))) for a in angles]
        return body_of_revolution([*lower, *((rho, -z) for rho, z in reversed(lower))])

    coarse, fine = inscribed(4), inscribed(8)
    truth = fine + (fine - coarse) / 3
    found = solve(Swept("capsule", ORIGIN, TURNED, (0.0, 0.0, 1.0), 1.0)).maxwell
    error = found.error[0, 0] + 0.1 * (fine - coarse) * UNIT
    check("capsule", found.value[0, 0], error, UNIT * truth, 0, 1e-3)


def test_a_cuboid_with_round_edges_lies_between_the_cuboids_around_it_and_within_it() -> None:
    """A conductor that contains another one has the larger capacitance, and a large rounding makes a clear difference."""
    found = solve(Swept("rounded", ORIGIN, TURNED, (0.25, 0.25, 0.0), 0.25)).maxwell
    value, error = found.value[0, 0], found.error[0, 0]
    within, around = (
        solve(Cuboid("cuboid", ORIGIN, TURNED, (half, half, 0.25))).maxwell.value[0, 0]
        for half in (0.25, 0.5)
    )
    assert within < value - error and value + error < around and error < 1e-3 * value


# Scenes in free space and in rooms, with zero to two planes of symmetry and one to three conductors; every change, bounds and estimates.
SCENES = (8, 16, 9, 10, 51, 93, 21, 30, 22, 31, 15, 68)
SEED = 1


@pytest.mark.parametrize("number", all_but(SCENES[:2], SCENES))
def test_answers_that_have_to_agree_do(number: int, tmp_path: Path) -> None:
    scene = random_scene(number, SEED, written_prism(tmp_path / "prism.obj"))
    found = compared(scene, number, tmp_path)
    assert found is not None and found.pairs >= 1
    assert not found.disagree
