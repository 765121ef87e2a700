"""Triangle meshes as solids: their sharp edges, and the refusal of meshes that do not bound a solid. Merging of triangles in one plane
into faces, and of the triangles of a box into a cuboid, whatever the triangulation."""

import numpy as np
import pytest

from fem_reference.bodies.plane_faces import cuboid_of, plane_faces
from fem_reference.bodies.polyhedron import NotASolid, polyhedron
from fem_reference.bodies.shapes import Body, Cuboid
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import tagged_mesh
from geometries.common.arrays import Array
from geometries.scene import shapes
from geometries.scene.person import BUILDS, POSTURES, Person
from tests.fem_reference.problems import CENTRE, TURNED, conductors_of, plate, prism

CUBE = shapes.Cuboid((0.2, 0.2, 0.2)).triangles()
OUTLINE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)


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
    assert len(polyhedron("L", prism(OUTLINE)).edges) == 17


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
        pytest.param(CUBE[:-1], r"is open at the edge around \(0.1, ", id="open"),
        pytest.param(one_flipped(), "opposite orientation", id="flipped"),
        pytest.param(CUBE[:, ::-1], "inside out", id="inside out"),
        pytest.param(np.concatenate([CUBE, 2 * CUBE[:, ::-1]]), "inside out", id="inside out around another"),
        pytest.param(np.concatenate([3 * CUBE, CUBE[:, ::-1]]), "has a cavity around", id="with a cavity"),
        pytest.param(
            np.concatenate([CUBE, CUBE + 0.05]), r"meets itself .*: triangles \d+ and \d+", id="crossing"
        ),
        pytest.param(np.concatenate([CUBE, CUBE + [0.2, 0.05, 0.05]]), "meets itself", id="touching"),
        pytest.param(np.concatenate([CUBE, CUBE]), "triangles at the edge|opposite|4 triangles", id="twice"),
        pytest.param(
            np.concatenate([CUBE, CUBE + [0.2, 0.2, 0.0]]), "4 triangles at the edge", id="along an edge"
        ),
        pytest.param(np.zeros((4, 3, 3)), "no triangle with an area", id="a point"),
    ],
)
def test_a_surface_that_bounds_no_solid_is_refused_with_the_place(triangles: Array, words: str) -> None:
    with pytest.raises(NotASolid, match=words):
        polyhedron("mesh", triangles)


@pytest.mark.parametrize("posture", POSTURES)
@pytest.mark.parametrize("age", BUILDS)
def test_a_person_is_a_solid(age: str, posture: str) -> None:
    polyhedron("person", Person(1.0, age, posture).triangles())  # Raises NotASolid where its triangles meet.


BOX = shapes.Cuboid((0.3, 0.2, 0.1)).triangles() @ TURNED + CENTRE


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
    wanted = Cuboid("box", CENTRE, TURNED, (0.15, 0.1, 0.05)).corners
    off = np.linalg.norm(found.corners[:, None] - wanted, axis=2).min(axis=0)
    assert off.max() < 1e-6


def test_other_solids_are_not_replaced_by_a_cuboid() -> None:
    leaning = BOX + 1e-3 * BOX[..., :1] * [0, 1, 0]
    two = np.concatenate([BOX, BOX + 1])
    for triangles in (leaning, two, prism(OUTLINE), shapes.Sphere(1.0, 16).triangles()):
        assert cuboid_of(polyhedron("no box", triangles)) is None


def cell_count(target: Body) -> int:
    """Number of cells of a coarse mesh around the target and a plate close to it."""
    problem = conductors_of([plate("s", (0.1, 0.1), 0.1, -0.2, 0.0), target])
    return tagged_mesh(problem, Sizing(edge=0.2), straight=True).cell_count


def test_the_mesh_around_a_box_of_triangles_is_as_coarse_as_around_the_cuboid() -> None:
    cuboid = cell_count(Cuboid("t", CENTRE, TURNED, (0.15, 0.1, 0.05)))
    assert cell_count(polyhedron("t", finer(BOX, 4))) < 1.05 * cuboid
