"""Triangle meshes as solids: their sharp edges, and the refusal of meshes that do not bound a solid. Merging of triangles in one plane
into faces, and of the triangles of a box into a cuboid, whatever the triangulation."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.bodies.plane_faces import cuboid_of, plane_faces
from fem_reference.bodies.conductors import normalised
from fem_reference.bodies.polyhedron import NotASolid, polyhedron
from fem_reference.bodies.shapes import Body, Cuboid, Rectangle
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import tagged_mesh
from geometries.common.arrays import Array
from geometries.scene import shapes
from geometries.scene.person import BUILDS, POSTURES, Person
from geometries.scene.poses import AxisRotation

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


TURNED = AxisRotation((1.0, 2.0, -0.5), 33.0).matrix().T
SIZE = (0.3, 0.2, 0.1)
BOX = shapes.Cuboid(SIZE).triangles() @ TURNED + [0.1, -0.2, 0.3]
OUTLINE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)


def finer(triangles: Array, count: int) -> Array:
    """Divide every triangle into count² triangles."""
    pieces = []
    for start, first, second in triangles:
        u, v = (first - start) / count, (second - start) / count
        for i in range(count):
            for j in range(count - i):
                corner = start + i * u + j * v
                pieces.append([corner, corner + u, corner + v])
                if i + j < count - 1:
                    pieces.append([corner + u, corner + u + v, corner + v])
    return np.array(pieces)


def prism(outline: Array, hole: Array | None = None) -> Array:
    """The triangles of a prism of height 1, whose base is an L or a square with a square hole."""

    def wall(loop: Array) -> list[list[Array]]:
        low, high = (np.column_stack([loop, np.full(len(loop), z)]) for z in (0.0, 1.0))
        rest = [*range(1, len(loop)), 0]
        faces = [[low[i], low[j], high[j]] for i, j in enumerate(rest)]
        return faces + [[low[i], high[j], high[i]] for i, j in enumerate(rest)]

    if hole is None:
        flat = [outline[list(three)] for three in ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5))]
    else:
        flat = []
        for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)):
            flat += [np.array([outline[i], outline[j], hole[j]]), np.array([outline[i], hole[j], hole[i]])]
    top = [list(np.column_stack([three, np.ones(3)])) for three in flat]
    bottom = [list(np.column_stack([three, np.zeros(3)])[::-1]) for three in flat]
    walls = wall(outline) + ([] if hole is None else wall(hole[::-1]))
    return np.array(top + bottom + walls)


def test_a_finely_cut_cube_has_six_faces_of_four_vertices() -> None:
    """The diagonals of the faces are gone, and so are the vertices inside faces and edges."""
    ((*faces,),) = plane_faces(polyhedron("box", finer(BOX, 3)))
    assert len(faces) == 6
    assert all(len(face) == 1 and len(face[0]) == 4 for face in faces)


def test_faces_may_be_bent_inwards_and_have_holes() -> None:
    ((*faces,),) = plane_faces(polyhedron("L", prism(OUTLINE)))
    assert sorted(len(face[0]) for face in faces) == [4] * 6 + [6] * 2
    square = np.array([[0, 0], [3, 0], [3, 3], [0, 3]], dtype=float)
    ((*faces,),) = plane_faces(polyhedron("frame", prism(square, square / 3 + 1)))
    assert sorted(len(face) for face in faces) == [1] * 8 + [2] * 2
    assert all(len(loop) == 4 for face in faces for loop in face)


def test_a_round_surface_keeps_its_facets() -> None:
    """The facets at the poles are triangles; those between two circles are trapezoids, whose two triangles lie in one plane."""
    ball = polyhedron("ball", shapes.Sphere(1.0, 16).triangles())
    assert ball.rounded.all()
    ((*faces,),) = plane_faces(ball)
    assert {len(face[0]) for face in faces} == {3, 4}
    assert sum(len(face[0]) - 2 for face in faces) == len(ball.triangles)


@pytest.mark.parametrize("count, precision", [(1, np.float64), (3, np.float64), (3, np.float32)])
def test_the_triangles_of_a_box_are_a_cuboid(count: int, precision: type) -> None:
    found = cuboid_of(polyhedron("box", finer(BOX, count).astype(precision).astype(np.float64)))
    assert found is not None
    np.testing.assert_allclose(sorted(found.half_widths), [0.05, 0.1, 0.15], rtol=1e-6)
    wanted = Cuboid("box", np.array([0.1, -0.2, 0.3]), TURNED, (0.15, 0.1, 0.05)).corners
    off = np.linalg.norm(found.corners[:, None] - wanted, axis=2).min(axis=0)
    assert off.max() < 1e-6


def test_other_solids_are_not_replaced_by_a_cuboid() -> None:
    leaning = BOX + 1e-3 * BOX[..., :1] * [0, 1, 0]
    two = np.concatenate([BOX, BOX + 1])
    for triangles in (leaning, two, prism(OUTLINE), shapes.Sphere(1.0, 16).triangles()):
        assert cuboid_of(polyhedron("no box", triangles)) is None


def cell_count(target: Body) -> int:
    """Number of cells of a coarse mesh around the target and a plate close to it."""
    plate = Rectangle("s", np.array([0.1, -0.2, 0.3]) + [0, 0, -0.3], np.eye(3), (0.1, 0.1))
    problem = normalised(["s", "t"], 1, [plate, target], [0, 1])
    return tagged_mesh(problem, Sizing(edge=0.2), straight=True).cell_count


def test_the_mesh_around_a_box_of_triangles_is_as_coarse_as_around_the_cuboid() -> None:
    cuboid = cell_count(Cuboid("t", np.array([0.1, -0.2, 0.3]), TURNED, (0.15, 0.1, 0.05)))
    assert cell_count(polyhedron("t", finer(BOX, 4))) < 1.05 * cuboid
