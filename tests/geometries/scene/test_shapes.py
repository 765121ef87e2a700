"""The triangles of every shape: area, volume and outward normals against closed forms; a person as a mesh and as capsules."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from geometries.__main__ import main
from geometries.scene import reader
from geometries.scene.meshes import read_triangles
from geometries.scene.person import BUILDS, POSTURES, Person
from geometries.scene.shapes import (
    Arc,
    Capsule,
    Cone,
    Cuboid,
    Cylinder,
    Disc,
    Ellipsoid,
    PlateShape,
    Polygon,
    RoundedCuboid,
    Shape,
    Sphere,
)

SEGMENTS = 96


def area(triangles: np.ndarray) -> float:
    edges = triangles[:, 1:] - triangles[:, :1]
    return float(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum() / 2)


def volume(triangles: np.ndarray) -> float:
    """Signed: positive when the triangles are anticlockwise seen from outside (divergence theorem)."""
    return float(np.linalg.det(triangles).sum() / 6)


def is_closed(triangles: np.ndarray) -> bool:
    """Whether every edge is walked once in each direction."""
    edges: dict[tuple[bytes, bytes], int] = {}
    corners = np.round(triangles, 12) + 0.0
    for triangle in corners:
        for start, end in zip(triangle, np.roll(triangle, -1, axis=0)):
            if not np.array_equal(start, end):
                key = (start.tobytes(), end.tobytes())
                edges[key] = edges.get(key, 0) + 1
    return all(count == edges.get((end, start)) for (start, end), count in edges.items())


def polygon_area(radius: float, n: int) -> float:
    return n / 2 * radius**2 * math.sin(2 * math.pi / n)


def test_a_plate_is_two_triangles_with_normal_up() -> None:
    triangles = PlateShape((0.2, 0.1)).triangles()
    expected = [
        [(-0.1, -0.05, 0), (0.1, -0.05, 0), (0.1, 0.05, 0)],
        [(-0.1, -0.05, 0), (0.1, 0.05, 0), (-0.1, 0.05, 0)],
    ]
    np.testing.assert_allclose(triangles, expected)
    assert (np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])[:, 2] > 0).all()


def test_a_cuboid_has_its_area_and_volume() -> None:
    triangles = Cuboid((0.1, 0.2, 0.3)).triangles()
    assert triangles.shape == (12, 3, 3)
    assert area(triangles) == pytest.approx(2 * (0.02 + 0.06 + 0.03), rel=1e-14)
    assert volume(triangles) == pytest.approx(0.006, rel=1e-14)


def test_a_cuboid_lists_its_faces_in_the_order_of_the_format() -> None:
    triangles = Cuboid((2.0, 2.0, 2.0)).triangles()
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    faces = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0)]
    np.testing.assert_allclose(normals / 4, np.repeat(faces, 2, axis=0), atol=1e-15)


def test_a_cylinder_is_the_prism_inscribed() -> None:
    n, radius, height = SEGMENTS, 0.05, 0.2
    triangles = Cylinder(radius, height, n).triangles()
    assert triangles.shape == (4 * n, 3, 3)
    side = 2 * n * radius * math.sin(math.pi / n) * height
    assert area(triangles) == pytest.approx(side + 2 * polygon_area(radius, n), rel=1e-12)
    assert volume(triangles) == pytest.approx(polygon_area(radius, n) * height, rel=1e-12)


def test_a_cone_is_the_pyramid_inscribed() -> None:
    n, radius, height = SEGMENTS, 0.05, 0.2
    triangles = Cone(radius, height, n).triangles()
    assert triangles.shape == (2 * n, 3, 3)
    slant = math.hypot(height, radius * math.cos(math.pi / n))
    side = n * radius * math.sin(math.pi / n) * slant
    assert area(triangles) == pytest.approx(side + polygon_area(radius, n), rel=1e-12)
    assert volume(triangles) == pytest.approx(polygon_area(radius, n) * height / 3, rel=1e-12)


@pytest.mark.parametrize("degrees", [30.0, 200.0, 360.0])
def test_an_arc_is_the_ring_sector_inscribed(degrees: float) -> None:
    n, inner, outer, height = SEGMENTS, 0.05, 0.08, 0.02
    triangles = Arc(inner, outer, height, degrees, n).triangles()
    assert len(triangles) == (8 * n if degrees == 360 else 8 * n + 4)
    step = math.radians(degrees) / n
    base = n / 2 * (outer**2 - inner**2) * math.sin(step)
    curved = 2 * n * (inner + outer) * math.sin(step / 2) * height
    ends = 0 if degrees == 360 else 2 * (outer - inner) * height
    assert volume(triangles) == pytest.approx(base * height, rel=1e-12)
    assert area(triangles) == pytest.approx(2 * base + curved + ends, rel=1e-12)


def test_a_sphere_has_its_vertices_on_the_sphere_and_approaches_its_area_and_volume() -> None:
    radius = 0.05
    triangles = Sphere(radius, SEGMENTS).triangles()
    assert len(triangles) == 2 * SEGMENTS * (SEGMENTS // 2 - 1)
    np.testing.assert_allclose(np.linalg.norm(triangles, axis=2), radius, rtol=1e-14)
    # An inscribed polyhedron is too small, by about (π/segments)²·4/3.
    assert -2e-3 < area(triangles) / (4 * math.pi * radius**2) - 1 < 0
    assert -3e-3 < volume(triangles) / (4 / 3 * math.pi * radius**3) - 1 < 0


SWEPT: list[Capsule | RoundedCuboid] = [
    Capsule(0.05, 0.2, SEGMENTS),
    RoundedCuboid((0.5, 0.7, 0.9), 0.125, SEGMENTS),
    RoundedCuboid((0.5, 0.75, 1.0), 0.25, SEGMENTS),
    RoundedCuboid((0.75, 1.0, 0.5), 0.25, SEGMENTS),
    RoundedCuboid((0.5, 1.0, 0.5), 0.25, SEGMENTS),
    RoundedCuboid((0.5, 0.5, 0.5), 0.25, SEGMENTS),
]


@pytest.mark.parametrize("shape", SWEPT)
def test_a_swept_box_has_its_vertices_on_the_surface_and_approaches_its_volume(
    shape: Capsule | RoundedCuboid,
) -> None:
    """The volume is that of Steiner's formula."""
    triangles = shape.triangles()
    radius = shape.radius if isinstance(shape, Capsule) else shape.rounding
    core = np.array(shape.core)
    beside = np.maximum(np.abs(triangles) - core, 0)
    np.testing.assert_allclose(np.linalg.norm(beside, axis=2), radius, rtol=1e-14)
    x, y, z = 2 * core
    true = x * y * z + 2 * radius * (x * y + y * z + z * x) + math.pi * radius**2 * (x + y + z)
    true += 4 / 3 * math.pi * radius**3
    assert -3e-3 < volume(triangles) / true - 1 < 0
    edges = triangles[:, 1:] - triangles[:, :1]
    assert np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).min() > 1e-6 * radius**2


def test_an_ellipsoid_is_a_ball_stretched() -> None:
    triangles = Ellipsoid((0.05, 0.02, 0.08), 12).triangles()
    np.testing.assert_array_equal(triangles, Sphere(1.0, 12).triangles() * [0.05, 0.02, 0.08])


@pytest.mark.parametrize("posture", POSTURES)
@pytest.mark.parametrize(
    "age, height, mass", [("adult", 1.75, 70), ("child", 1.155, 20.7), ("infant", 0.36, 1)]
)
def test_a_person_is_a_closed_polyhedron_of_its_height_and_about_its_mass(
    age: str, height: float, mass: float, posture: str
) -> None:
    """The adult's density is that of Winter's table 4.1, 1.054 kg/l over all segments."""
    triangles = Person(height, age, posture).triangles()
    assert triangles.shape == (788, 3, 3) and is_closed(triangles)
    assert volume(triangles) == pytest.approx(mass / 1054, rel=0.03)
    along = 0 if posture == "lying" else 2
    assert np.ptp(triangles[..., along]) == pytest.approx(height, rel=1e-14)
    if posture == "arm_stretched":
        build = BUILDS[age]
        reach = build.upper_arm + build.forearm + build.hand
        assert triangles[triangles[..., 1] < 0][:, 0].max() == pytest.approx(reach * height, rel=1e-12)


def test_a_disc_and_a_polygon_face_up() -> None:
    disc = Disc(0.05, 7).triangles()
    assert disc.shape == (7, 3, 3) and area(disc) == pytest.approx(polygon_area(0.05, 7), rel=1e-14)
    outline = Polygon(((0, 0), (0, 1), (1, 1), (1, 2), (2, 2), (2, 0))).triangles()
    assert outline.shape == (4, 3, 3) and area(outline) == 3
    for sheet in (disc, outline):
        assert not sheet[:, :, 2].any()
        assert (np.cross(sheet[:, 1] - sheet[:, 0], sheet[:, 2] - sheet[:, 0])[:, 2] > 0).all()


@pytest.mark.parametrize("segments", [3, 4, 5, 48])
@pytest.mark.parametrize(
    "make",
    [
        lambda n: Cylinder(0.05, 0.2, n),
        lambda n: Cone(0.05, 0.2, n),
        lambda n: Arc(0.05, 0.08, 0.02, 200.0, n),
        lambda n: Arc(0.05, 0.08, 0.02, 360.0, n),
        lambda n: Sphere(0.05, n),
        lambda n: Ellipsoid((0.05, 0.02, 0.08), n),
        lambda n: Capsule(0.05, 0.2, n),
        lambda n: RoundedCuboid((0.1, 0.2, 0.3), 0.02, n),
        lambda n: RoundedCuboid((0.1, 0.2, 0.3), 0.05, n),
    ],
    ids=["cylinder", "cone", "arc", "ring", "sphere", "ellipsoid", "capsule", "rounded", "stadium"],
)
def test_solid_shapes_are_closed_with_outward_normals(make, segments: int) -> None:  # type: ignore[no-untyped-def]
    shape: Shape = make(segments)
    triangles = shape.triangles()
    assert is_closed(triangles)
    assert volume(triangles) > 0


def test_the_cuboid_is_closed() -> None:
    assert is_closed(Cuboid((0.1, 0.2, 0.3)).triangles())


PEOPLE = Path(__file__).resolve().parents[3] / "geometries" / "people"


def test_the_command_writes_a_mesh_or_capsules(tmp_path: Path) -> None:
    asked = ["--height", "1.2", "--age", "child", "--posture", "lying"]
    assert main(["person", str(tmp_path / "child.obj"), *asked]) == 0
    written = read_triangles(tmp_path / "child.obj")
    np.testing.assert_allclose(written, Person(1.2, "child", "lying").triangles(), atol=1e-6)
    assert main(["person", str(tmp_path / "child.toml"), *asked]) == 0
    scene = reader.load(tmp_path / "child.toml")
    assert {body.conductor for body in scene.objects} == {"person"}
    assert main(["person", str(tmp_path / "child.xyz")]) == 2


@pytest.mark.parametrize("posture", POSTURES)
@pytest.mark.parametrize("age", BUILDS)
def test_capsules_reach_as_far_as_the_surface(tmp_path: Path, age: str, posture: str) -> None:
    file = tmp_path / "person.toml"
    assert main(["person", str(file), "--height", "1", "--age", age, "--posture", posture]) == 0
    points = np.concatenate([own.reshape(-1, 3) for own in reader.load(file).conductors().values()])
    surface = Person(1.0, age, posture).triangles().reshape(-1, 3)
    np.testing.assert_allclose(points.min(axis=0), surface.min(axis=0), atol=0.02)
    np.testing.assert_allclose(points.max(axis=0), surface.max(axis=0), atol=0.02)


@pytest.mark.parametrize("posture", POSTURES)
@pytest.mark.parametrize("age", BUILDS)
def test_the_meshes_of_the_format_are_persons(age: str, posture: str) -> None:
    file = f"{age}_arm_stretched.obj" if posture == "arm_stretched" else f"{age}.obj"
    x, y, z = np.moveaxis(read_triangles(PEOPLE / file), -1, 0)
    fixed = np.stack([-z, y, x] if posture == "lying" else [x, y, z], axis=-1)
    np.testing.assert_allclose(Person(1.0, age, posture).triangles(), fixed, rtol=0, atol=1e-12)
