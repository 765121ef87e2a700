"""Scenes in a room: a grounded box around everything, whose walls take the place of ground at infinity."""

from functools import cache

import numpy as np
import pytest
from scipy.constants import epsilon_0

from analysis.topics.verification.truths import UNIT_CUBE, UNIT_SQUARE_PLATE
from fem_reference import maxwell
from fem_reference.bodies.round_bodies import Sphere
from fem_reference.bodies.shapes import Body, Cuboid
from fem_reference.bodies.symmetry import mirror_planes
from fem_reference.mesh import tagged_mesh
from fem_reference.mesh.sizing import Sizing
from fem_reference.output.documents import table
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import solve_level
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene.reader import loads
from tests.by_night import all_but
from tests.fem_reference.problems import ORIGIN, PLATE, conductors_of, plate
from tests.scenes import SENSOR


def box(*size: float, axes: Array = np.eye(3), centre: tuple[float, ...] = (0, 0, 0)) -> Cuboid:
    return Cuboid("room", np.array(centre, dtype=float), axes, (size[0] / 2, size[1] / 2, size[2] / 2))


def enclosed(bodies: list[Body], room: Cuboid | None) -> Enclosure:
    """The enclosure of the Maxwell matrix of bodies that are a conductor each."""
    problem = conductors_of(bodies, room=room)
    found = solve_level(problem, 1.0, Sizing(), "enclosure", problem.mirror_planes).enclosure
    assert found is not None
    return found


def own(found: Enclosure) -> tuple[float, float]:
    """The interval of the first diagonal entry over ε0, in metres."""
    return found.lower[0, 0] / epsilon_0, found.upper[0, 0] / epsilon_0


@cache
def cube_in(side: float) -> tuple[float, float]:
    return own(enclosed([Cuboid("cube", ORIGIN, np.eye(3), (0.5, 0.5, 0.5))], box(side, side, side)))


def test_the_smaller_the_room_the_larger_the_capacitance_and_a_large_one_is_free_space() -> None:
    """A room of radius R adds about C/4πε0R of C, a cube of half width R less than that of its inscribed ball."""
    free = 4 * np.pi * UNIT_CUBE
    small, large = cube_in(3.0), cube_in(60.0)
    assert small[0] > large[1] and large[1] > free
    assert large[0] <= free / (1 - UNIT_CUBE / 30) and large[1] - large[0] <= 5e-3 * free
    assert large[1] >= free / (1 - UNIT_CUBE / (30 * np.sqrt(3)))


def test_a_ball_in_a_box_lies_between_the_two_concentric_balls() -> None:
    """The capacitance lies between those of the spherical condensers with the balls in and around the room, which is turned."""
    turned = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
    lower, upper = own(enclosed([Sphere("ball", np.zeros(3), 0.5)], box(4, 4, 4, axes=turned)))
    between = [4 * np.pi / (1 / 0.5 - 1 / radius) for radius in (2 * np.sqrt(3), 2.0)]
    assert between[0] < lower <= upper < between[1] and upper - lower <= 1e-2 * upper


def test_a_plate_near_a_wall_is_a_plate_and_its_image() -> None:
    """The wall below acts as a mirror: M[0, 0] is that of one of two plates at opposite voltages. The other walls are far away."""
    gap, far = 0.3, 40.0
    lower, upper = own(enclosed([PLATE], box(far, far, far, centre=(0, 0, far / 2 - gap))))
    pair = enclosed([PLATE, plate("image", (0.5, 0.5), 0, 0, -2 * gap)], None)
    below = (pair.lower[0, 0] - pair.upper[0, 1]) / epsilon_0
    above = (pair.upper[0, 0] - pair.lower[0, 1]) / epsilon_0
    assert lower <= above * 1.001 and below <= upper and upper - lower <= 2e-2 * upper


EDGE_TO_EDGE = (
    plate("first", (1.0, 0.45), 0, -0.5, -3.0),
    plate("second", (1.0, 0.45), 0, 0.6, -3.0),
)
BESIDE = Sphere("ball", np.array([0, 0, 1.5]), 0.5)
CUBOID = Cuboid("cuboid", ORIGIN, np.eye(3), (0.5, 0.4, 0.3))
IN_ROOMS: list[tuple[tuple[Body, ...], tuple[float, ...], int]] = [
    (EDGE_TO_EDGE[:1], (0, 0, 0), 1),
    ((CUBOID,), (0, 0, 0), 3),
    (EDGE_TO_EDGE, (0, 0, 0), 1),
    (EDGE_TO_EDGE[:1], (0, -0.5, 0), 2),
    ((PLATE, BESIDE), (0, 0.3, 0.2), 1),
    ((CUBOID,), (0.5, 0, 0), 2),
]


@pytest.mark.parametrize("case", all_but([0], range(len(IN_ROOMS))))
def test_one_side_of_the_planes_of_a_room_gives_the_answer_of_the_whole(case: int) -> None:
    """A face in a plane of symmetry may have corners in opposite walls. It was once mistaken for a wall, and grounded, where no body
    cut it."""
    bodies, centre, number = IN_ROOMS[case]
    problem = conductors_of(bodies, room=box(8, 8, 8, centre=centre))
    planes = problem.mirror_planes
    assert len(planes) == number
    side, whole = (solve_level(problem, 1.0, Sizing(), "estimate", used) for used in (planes, ()))
    assert side.bounds is not None and whole.bounds is not None
    one, other = side.bounds.interval, whole.bounds.interval
    assert np.all(one.lower <= other.upper) and np.all(other.lower <= one.upper)
    np.testing.assert_allclose(side.maxwell, whole.maxwell, rtol=5e-3)


def test_an_outer_surface_that_is_not_whole_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The check of the area catches any mistake about which faces are walls."""
    monkeypatch.setattr(tagged_mesh, "_is_wall", lambda face, room: face % 2 == 0)
    with pytest.raises(RuntimeError, match="outer surface"):
        enclosed([PLATE], box(4, 4, 4))


def test_planes_of_symmetry_of_the_bodies_that_the_room_lacks_are_not_used() -> None:
    centred = mirror_planes([PLATE], [0], box(4, 4, 4))
    aside = mirror_planes([PLATE], [0], box(4, 4, 4, centre=(0.5, 0, 0)))
    assert len(centred) == 2 and len(aside) == 1 and abs(aside[0].normal[1]) == pytest.approx(1)


def in_room(height: float) -> str:
    return f"[room]\nsize = [1, 1, {height}]\ntranslation = [0, 0, 0.3]\n{SENSOR}"


def test_a_body_that_is_not_in_the_room_is_refused_by_name() -> None:
    with pytest.raises(InputError, match='room: "front" is not inside'):
        maxwell(loads(in_room(0.6)))


def test_a_scene_in_a_room_needs_no_open_boundary() -> None:
    found = maxwell(loads(in_room(0.8)), max_seconds=1e-3)
    assert found.names == ("front",) and len(found.planes) == 2
    assert np.all(found.lower <= found.maxwell.value) and np.all(found.maxwell.value <= found.upper)
    assert found.lower[0, 0] > 4 * np.pi * epsilon_0 * UNIT_SQUARE_PLATE * 0.1
    assert "ground: the walls of the room" in table(found).splitlines()
