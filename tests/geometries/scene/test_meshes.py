"""Mesh files: read as triangles in the file's order, scaled, refused when damaged; converted whole or not at all. Persons as a mesh and as
capsules. The triangles of the other shapes are compared with those of the library by tests/end_to_end."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from geometries.__main__ import main
from geometries.common.errors import InputError
from geometries.scene import meshes, reader, writer
from geometries.scene.person import BUILDS, POSTURES, Person
from tests.programs import in_this_process

TRIANGLES = np.array(
    [
        [(0, 0, 0), (1, 0, 0), (1, 1, 0)],
        [(0, 0, 0), (1, 1, 0), (0, 1, 0.5)],
        [(0, 0, 1), (2, 0, 1), (0, 2, 1)],
    ],
    dtype=np.float64,
)
PEOPLE = Path(meshes.__file__).parents[1] / "people"
OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\nf 2 3 5\n"


def scene_with(file: str, scale: float = 1.0) -> str:
    return f'[[object]]\nname = "o"\nshape = {{ type = "mesh", file = "{file}", scale = {scale} }}\n'


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply"])
def test_the_faces_of_a_file_are_read_in_its_order(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"body{suffix}"
    meshio.write(path, meshio.Mesh(TRIANGLES.reshape(-1, 3), [("triangle", np.arange(9).reshape(3, 3))]))
    np.testing.assert_allclose(meshes.read_triangles(path), TRIANGLES)


def test_a_scene_scales_its_mesh_and_finds_it_beside_itself(tmp_path: Path) -> None:
    (tmp_path / "body.obj").write_text(OBJ)
    (tmp_path / "scene.toml").write_text(scene_with("body.obj", 0.5))
    triangles = reader.load(tmp_path / "scene.toml").conductors()["o"]
    np.testing.assert_allclose(triangles, 0.5 * meshes.read_triangles(tmp_path / "body.obj"))


def test_a_mesh_counts_by_its_bytes_not_by_its_place(tmp_path: Path) -> None:
    for folder, text in (("a", OBJ), ("b", OBJ), ("c", OBJ.replace("f 2 3 5", "f 3 2 5"))):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "body.obj").write_text(text)
        (tmp_path / folder / "scene.toml").write_text(scene_with("body.obj"))
    here, there, other = (reader.load(tmp_path / folder / "scene.toml") for folder in "abc")
    assert here == there != other
    assert writer.identity(here) == writer.identity(there) != writer.identity(other)


def test_the_canonical_text_of_a_mesh_can_be_loaded_from_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "body.obj").write_text(OBJ)
    (tmp_path / "scene.toml").write_text(scene_with("body.obj", 0.001))
    scene = reader.load(tmp_path / "scene.toml")
    assert reader.loads(writer.canonical(scene), source="/elsewhere/scene.toml") == scene


@pytest.mark.parametrize("suffix", [".vtk", ".vtu", ".msh"])
def test_convert_writes_the_surface_of_another_format(tmp_path: Path, suffix: str) -> None:
    source, target = tmp_path / f"body{suffix}", tmp_path / "body.stl"
    meshio.write(source, meshio.Mesh(TRIANGLES.reshape(-1, 3), [("triangle", np.arange(9).reshape(3, 3))]))
    done = in_this_process(main, "convert", source, target)
    assert done.returncode == 0 and "3 triangles" in done.stdout
    np.testing.assert_allclose(meshes.read_triangles(target), TRIANGLES)


@pytest.mark.parametrize(
    ("points", "cells", "reason"),
    [
        (TRIANGLES.reshape(-1, 3), ("line", [[0, 1]]), "holds no triangles"),
        (TRIANGLES.reshape(-1, 3), ("triangle", [[0, 1, 9]]), "refers to a vertex that does not exist"),
        (np.full((3, 3), np.inf), ("triangle", [[0, 1, 2]]), "not finite"),
    ],
)
def test_another_format_without_a_surface_is_refused(
    tmp_path: Path, points: np.ndarray, cells: tuple[str, list[list[int]]], reason: str
) -> None:
    meshio.write(tmp_path / "body.vtu", meshio.Mesh(points, [cells]))
    with pytest.raises(InputError, match=reason):
        meshes.read_triangles(tmp_path / "body.vtu")


@pytest.mark.parametrize(
    ("source", "target"), [("missing.vtk", "a.stl"), ("bad.vtk", "a.stl"), ("good.obj", "a.xyz")]
)
def test_convert_refuses_with_code_2_and_leaves_nothing_behind(
    tmp_path: Path, source: str, target: str
) -> None:
    (tmp_path / "bad.vtk").write_text("not a mesh")
    (tmp_path / "good.obj").write_text(OBJ)
    done = in_this_process(main, "convert", tmp_path / source, tmp_path / target)
    assert (done.returncode, done.stdout) == (2, "") and done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.vtk", "good.obj"]


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


def test_the_command_writes_a_mesh_or_capsules(tmp_path: Path) -> None:
    asked = ["--height", "1.2", "--age", "child", "--posture", "lying"]
    assert main(["person", str(tmp_path / "child.obj"), *asked]) == 0
    written = meshes.read_triangles(tmp_path / "child.obj")
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
    x, y, z = np.moveaxis(meshes.read_triangles(PEOPLE / file), -1, 0)
    fixed = np.stack([-z, y, x] if posture == "lying" else [x, y, z], axis=-1)
    np.testing.assert_allclose(Person(1.0, age, posture).triangles(), fixed, rtol=0, atol=1e-12)
