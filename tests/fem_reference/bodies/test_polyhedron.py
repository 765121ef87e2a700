"""Triangle meshes as solids: their sharp edges, and the refusal of meshes that do not bound a solid."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from geometries.scene.person import BUILDS, POSTURES, Person
from fem_reference.bodies.polyhedron import NotASolid, polyhedron
from geometries.scene import shapes

Array = NDArray[np.float64]
CUBE = shapes.Cuboid((0.2, 0.2, 0.2)).triangles()


def test_a_cube_has_twelve_edges_and_eight_vertices() -> None:
    """The diagonals of its faces are no edges, and vertices that differ by the rounding of single precision are merged."""
    found = polyhedron("cube", CUBE + 1e-9 * np.random.default_rng(1).normal(size=CUBE.shape))
    assert len(found.vertices) == 8 and len(found.edges) == 12 and len(found.parts) == 1
    lengths = np.linalg.norm(np.diff(found.vertices[found.edges], axis=1), axis=2)
    np.testing.assert_allclose(lengths, 0.2, rtol=1e-6)
    assert found.size == pytest.approx(0.2, rel=1e-6)


def test_a_finely_faceted_ball_has_no_edges() -> None:
    assert len(polyhedron("ball", shapes.Sphere(1.0, 48).triangles()).edges) == 0


def test_more_than_5000_triangles_bound_a_solid_as_fewer_do() -> None:
    found = polyhedron("ball", shapes.Sphere(1.0, 80).triangles())
    assert len(found.triangles) == 6240 and found.size == pytest.approx(2.0, rel=2e-3)


def test_edges_that_open_inwards_are_not_singular() -> None:
    """An L-shaped prism has 18 edges, 3 at each of the 6 corners of its outline; the one at the inner corner is not singular."""
    outline = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
    top = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    low, high = (np.column_stack([outline, np.full(6, z)]) for z in (0.0, 1.0))
    faces = [[high[i] for i in face] for face in top] + [[low[i] for i in face[::-1]] for face in top]
    for i, j in zip(range(6), [1, 2, 3, 4, 5, 0]):
        faces += [[low[i], low[j], high[j]], [low[i], high[j], high[i]]]
    assert len(polyhedron("L", np.array(faces)).edges) == 17


def test_pieces_that_do_not_touch_are_parts() -> None:
    assert len(polyhedron("two", np.concatenate([CUBE, CUBE + 1.0])).parts) == 2


def test_points_inside_are_held() -> None:
    points = np.random.default_rng(2).uniform(-0.2, 0.2, (200, 3))
    inside = np.abs(points).max(axis=1) < 0.1
    assert np.array_equal(polyhedron("cube", CUBE).holds(points), inside) and inside.any()


def one_flipped() -> Array:
    flipped = CUBE.copy()
    flipped[3] = flipped[3, ::-1]
    return flipped


@pytest.mark.parametrize(
    "triangles, words",
    [
        (CUBE[:-1], r"is open at the edge around \(0.1, "),
        (one_flipped(), "opposite orientation"),
        (CUBE[:, ::-1], "inside out"),
        (np.concatenate([CUBE, 2 * CUBE[:, ::-1]]), "inside out"),
        (np.concatenate([3 * CUBE, CUBE[:, ::-1]]), "has a cavity around"),
        (np.concatenate([CUBE, CUBE + 0.05]), r"meets itself around .*: triangles \d+ and \d+"),
        (np.concatenate([CUBE, CUBE + [0.2, 0.05, 0.05]]), "meets itself"),  # face on face
        (np.concatenate([CUBE, CUBE]), "triangles at the edge|opposite|4 triangles"),
        (np.concatenate([CUBE, CUBE + [0.2, 0.2, 0.0]]), "4 triangles at the edge around"),
        (np.zeros((4, 3, 3)), "no triangle with an area"),
    ],
    ids=[
        "open",
        "flipped",
        "inside out",
        "inside out around another",
        "with a cavity",
        "crossing",
        "touching",
        "twice",
        "along an edge",
        "a point",
    ],
)
def test_a_surface_that_bounds_no_solid_is_refused_with_the_place(triangles: Array, words: str) -> None:
    with pytest.raises(NotASolid, match=words):
        polyhedron("mesh", triangles)


@pytest.mark.parametrize("posture", POSTURES)
@pytest.mark.parametrize("age", BUILDS)
def test_a_person_is_a_solid(age: str, posture: str) -> None:
    polyhedron("person", Person(1.0, age, posture).triangles())  # Raises NotASolid where its triangles meet.
