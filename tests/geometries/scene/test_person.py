"""A person as a mesh and as capsules: both have the size of the shape, whose triangles are those of the files of the format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from geometries.__main__ import main
from geometries.scene import reader
from geometries.scene.meshes import read_triangles
from geometries.scene.person import BUILDS, POSTURES, Person


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
