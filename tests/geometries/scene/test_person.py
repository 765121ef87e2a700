"""Persons as a mesh and as capsules; the triangles of the other shapes are compared with those of the library by tests/end_to_end."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from geometries.__main__ import main
from geometries.scene import reader
from geometries.scene.meshes import read_triangles
from geometries.scene.person import BUILDS, POSTURES, Person


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
