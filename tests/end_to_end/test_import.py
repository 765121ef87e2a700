"""`fringe import`: robots (URDF) and models (glTF) become scenes that both readers read alike."""

from __future__ import annotations

import base64
import json
import math
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometries.scene import reader
from geometries.scene.shapes import Cuboid, Cylinder, MeshShape, Sphere
from tests.end_to_end.importing import (
    ROOT,
    SINGLE_PRECISION,
    about,
    affine,
    assert_refused,
    fringe_import,
    imported,
)

# A corner of a cube: three faces' triangles would do; two are enough to see order, scale and reflection.
OBJ = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\n"
TRIANGLES = np.array([[[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 0, 0], [0, 2, 0], [0, 0, 3]]], dtype=float)

ROBOT = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base">
    <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision>
    <visual><geometry><sphere radius="1"/></geometry></visual>
  </link>
  <link name="upper arm">
    <collision>
      <origin xyz="0 0 0.25" rpy="0 1.5707963267948966 0"/>
      <geometry><cylinder radius="0.05" length="0.5"/></geometry>
    </collision>
    <collision><geometry><sphere radius="0.07"/></geometry></collision>
  </link>
  <link name="hand">
    <collision>
      <geometry><mesh filename="package://arm_description/meshes/hand.obj" scale="0.001 0.001 -0.002"/></geometry>
    </collision>
  </link>
  <link name="finger"><collision><geometry><box size="0.01 0.02 0.03"/></geometry></collision></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper arm"/>
    <origin xyz="0 0 0.1" rpy="0.1 -0.2 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="wrist" type="prismatic">
    <parent link="upper arm"/><child link="hand"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 2 0"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/>
    <mimic joint="shoulder" multiplier="2" offset="0.03"/>
  </joint>
  <joint name="knuckle" type="fixed">
    <parent link="hand"/><child link="finger"/><origin xyz="0.1 0 0"/>
  </joint>
</robot>
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    meshes = tmp_path / "arm_description" / "meshes"
    meshes.mkdir(parents=True)
    (meshes / "hand.obj").write_text(OBJ)
    path = tmp_path / "arm_description" / "urdf" / "arm.urdf"
    path.parent.mkdir()
    path.write_text(ROBOT)
    return path


def test_links_and_joints_at_zero_are_links_and_poses(robot: Path) -> None:
    scene = imported(robot)
    parents = {link.name: link.parent for link in scene.links}
    assert parents == {"base": None, "upper arm": "base", "hand": "upper arm", "finger": "hand"}
    roll, pitch, yaw = 0.1, -0.2, 0.3
    turn = about(2, yaw) @ about(1, pitch) @ about(0, roll)
    arm = scene.transform_of_link("upper arm")
    assert arm.rotation == pytest.approx(turn, abs=1e-15)
    assert arm.translation == pytest.approx([0, 0, 0.1])
    # The wrist mimics the shoulder, which is at 0, with an offset along its axis.
    hand = scene.transform_of_link("hand")
    assert hand.translation == pytest.approx(np.array([0, 0, 0.1]) + turn @ [0.5, 0.03, 0])


def test_collision_geometries_are_objects_on_their_links(robot: Path) -> None:
    objects = {body.name: body for body in imported(robot).objects}
    assert list(objects) == ["base", "upper arm", "upper arm 2", "hand", "finger"]
    assert objects["base"].shape == Cuboid((0.4, 0.3, 0.2))
    assert objects["upper arm"].shape == Cylinder(0.05, 0.5)
    assert objects["upper arm 2"].shape == Sphere(0.07)
    assert {name: body.link for name, body in objects.items()} == {
        name: name.removesuffix(" 2") for name in objects
    }
    pose = objects["upper arm"].pose.transform()
    assert pose.translation == pytest.approx([0, 0, 0.25])
    assert pose.rotation @ [0, 0, 1] == pytest.approx([1, 0, 0], abs=1e-15)


def test_a_mesh_is_scaled_and_stays_anticlockwise_when_it_is_reflected(robot: Path) -> None:
    shape = next(body.shape for body in imported(robot).objects if body.name == "hand")
    assert isinstance(shape, MeshShape)
    expected = (TRIANGLES * [0.001, 0.001, -0.002])[:, [0, 2, 1]]
    assert shape.triangles() == pytest.approx(expected, rel=SINGLE_PRECISION)
    assert Path(shape.file).parent == robot.parent / "scene_meshes"


def test_visual_geometries_are_taken_when_asked_for(robot: Path) -> None:
    (body,) = imported(robot, "--geometry", "visual").objects
    assert (body.name, body.shape) == ("base", Sphere(1.0))


def test_packages_are_found_by_a_path(robot: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    moved = robot.rename(elsewhere / "arm.urdf")
    assert fringe_import(moved, elsewhere / "a.toml").returncode == 0
    other = tmp_path / "packages"
    other.mkdir()
    (tmp_path / "arm_description").rename(other / "arm_description")
    done = fringe_import(moved, elsewhere / "b.toml")
    assert done.returncode == 2
    assert 'link "hand": mesh: package://arm_description/meshes/hand.obj was not found' in done.stderr
    assert len(imported(moved, "--package-path", other).objects) == 5


def test_a_sensor_added_as_the_comment_says_makes_a_scene(robot: Path) -> None:
    imported(robot)
    path = robot.with_name("scene.toml")
    text = path.read_text()
    example = text[text.index("# [[sensor]]") :].split("\n\n")[0]
    pasted = example.replace("# ", "")
    another = pasted.replace("front", "back")
    for changed, names in (
        (text.replace(example, pasted), ["front"]),
        (text + "\n" + pasted + "\n" + another, ["front", "back"]),
        (text.replace(example, pasted) + "\n" + another, ["front", "back"]),
    ):
        path.write_text(changed)
        sensors = reader.load(path).sensors
        assert [sensor.name for sensor in sensors] == names
        assert {sensor.link for sensor in sensors} == {"finger"}
        done = subprocess.run([ROOT / "build/bin/fringe", "info", path], capture_output=True, check=False)
        assert done.returncode == 0


WRONG_ROBOTS = {
    "no XML": ("robot", "arm.urdf: "),
    "no robot": ("<scene/>", "Could not find the 'robot' element"),
    "no links": ('<robot name="r"/>', "No link elements found in urdf file"),
    "no geometry": ('<robot name="r"><link name="a"/></robot>', "robot: no link has a collision geometry"),
    "two roots": ('<robot name="r"><link name="a"/><link name="b"/></robot>', "Two root links found: [a] and [b]"),
    "box inside out": (ROBOT.replace("0.4 0.3 0.2", "0.4 0.3 -1"), 'link "base": box: a size must not be less than zero'),
    "sphere inside out": (ROBOT.replace('radius="0.07"', 'radius="-1"'), 'link "upper arm": sphere: a size'),
    "unknown shape": (ROBOT.replace("<sphere radius=", "<capsule radius="), "capsule"),
    "no number": (ROBOT.replace("0.4 0.3 0.2", "0.4 0.3 big"), "big"),
    "nan": (ROBOT.replace("0.5 0 0", "nan 0 0"), "nan"),
    "no scale": (ROBOT.replace("-0.002", "0"), 'link "hand": mesh: the scale must not be zero'),
    "no such link": (ROBOT.replace('<child link="hand"/>', '<child link="foot"/>'), "foot"),
    "moved nowhere": (ROBOT.replace('axis xyz="0 2 0"', 'axis xyz="0 0 0"'), 'joint "wrist": its axis must not be zero'),
    "no geometry given": (ROBOT.replace('<sphere radius="0.07"/>', ""), "arm.urdf: "),
    "more links than any robot": (
        '<robot name="r"><link name="a"/>' + "".join(
            f'<link name="l{i}"/><joint name="j{i}" type="fixed"><parent link="a"/><child link="l{i}"/></joint>'
            for i in range(10000)
        ) + "</robot>",
        "robot: has more than 10000 links",
    ),
    "moved beyond all numbers": (
        ROBOT.replace('mimic joint="shoulder" multiplier="2"', 'mimic joint="elbow" multiplier="1e308"').replace(
            "</robot>",
            '<link name="nail"/><joint name="elbow" type="revolute"><limit effort="1" velocity="1"/><parent link="finger"/>'
            '<child link="nail"/><mimic joint="shoulder" offset="1e308"/></joint></robot>',
        ),
        'joint "wrist": its position must be finite',
    ),
    "farther than a scene reaches": (ROBOT.replace("0.5 0 0", "1e40 0 0"), 'arm.urdf makes no scene: link "hand": translation'),
    "mimics itself": (ROBOT.replace('mimic joint="shoulder"', 'mimic joint="wrist"'), "mimics itself"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "told"), WRONG_ROBOTS.values(), ids=WRONG_ROBOTS)
def test_robots_that_are_none_are_refused_and_leave_nothing(robot: Path, text: str, told: str) -> None:
    robot.write_text(text)
    assert_refused(robot, told)


def test_meshes_are_found_beside_the_robot_and_by_their_full_path(robot: Path) -> None:
    expected = imported(robot).conductors()["hand"]
    full = (robot.parents[1] / "meshes" / "hand.obj").as_posix()
    for name in ("../meshes/hand.obj", "file://" + full):
        robot.write_text(ROBOT.replace("package://arm_description/meshes/hand.obj", name))
        assert imported(robot).conductors()["hand"] == pytest.approx(expected, abs=0)


def test_what_cannot_be_imported_leaves_what_was_imported_before(robot: Path) -> None:
    """The second robot's mesh has the first one's name, and a box that no scene may have."""
    imported(robot)
    target = robot.with_name("scene.toml")
    before = {path: path.read_bytes() for path in robot.parent.rglob("*") if path.is_file() and path != robot}
    robot.write_text(ROBOT.replace("0.01 0.02 0.03", "1e40 1 1").replace("-0.002", "0.001"))
    done = fringe_import(robot, target)
    assert done.returncode == 2 and done.stderr
    assert {path: path.read_bytes() for path in before} == before
    assert set(robot.parent.rglob("*")) == {*before, robot, robot.with_name("scene_meshes")}


def test_a_new_import_takes_the_place_of_the_old_one(robot: Path) -> None:
    first = imported(robot).conductors()
    robot.write_text(ROBOT.replace("-0.002", "0.001"))
    changed = imported(robot).conductors()
    assert changed["hand"] != pytest.approx(first["hand"], abs=1e-6)
    robot.write_text(ROBOT)
    assert imported(robot).conductors()["hand"] == pytest.approx(first["hand"], abs=0)
    assert {path.name for path in robot.parent.iterdir()} == {"arm.urdf", "scene.toml", "scene_meshes"}


def model(nodes: list[dict[str, Any]], **changes: Any) -> dict[str, Any]:
    """A glTF model of nodes; its mesh 0 is indexed triangles, 1 a strip, 2 a fan, 3 points."""
    points = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3)
    data = points + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    primitives = [
        {"attributes": {"POSITION": 0}, "indices": 1},
        {"attributes": {"POSITION": 0}, "mode": 5},
        {"attributes": {"POSITION": 0}, "mode": 6},
        {"attributes": {"POSITION": 0}, "mode": 0},
    ]
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "meshes": [{"primitives": [primitive]} for primitive in primitives],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6},
        ],
    } | changes


def written(tmp_path: Path, document: dict[str, Any]) -> Path:
    path = tmp_path / "model.gltf"
    path.write_text(json.dumps(document))
    return path


HALF = math.sqrt(0.5)
MESH: list[dict[str, Any]] = [{"mesh": 0}]
NODES: list[dict[str, Any]] = [
    {"name": "base", "children": [1, 3], "translation": [1, 2, 3], "rotation": [0, 0, HALF, HALF]},
    {"name": "arm", "children": [2], "scale": [2, 3, -1], "translation": [0.5, 0, 0], "mesh": 0},
    {"name": "hand", "rotation": [HALF, 0, 0, HALF], "translation": [0.1, 0.2, 0.3], "mesh": 0},
    {"matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1], "mesh": 0},
]


def test_nodes_are_links_and_their_triangles_are_where_the_matrices_put_them(tmp_path: Path) -> None:
    """Also those below a node that scales unevenly and reflects, which no rigid link does."""
    scene = imported(written(tmp_path, model(NODES)))
    assert {link.name: link.parent for link in scene.links} == {
        "base": None,
        "arm": "base",
        "hand": "arm",
        "node 3": "base",
    }
    base = affine([1, 2, 3], about(2, math.pi / 2))
    arm = base @ affine([0.5, 0, 0], np.diag([2.0, 3.0, -1.0]))
    hand = arm @ affine([0.1, 0.2, 0.3], about(0, math.pi / 2))
    last = base @ np.array(NODES[3]["matrix"], dtype=float).reshape(4, 4).T
    found = scene.conductors()
    for name, matrix in (("arm", arm), ("hand", hand), ("node 3", last)):
        expected = TRIANGLES @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) < 0:
            expected = expected[:, [0, 2, 1]]
        assert found[name] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("mesh", "turned"), [(1, [[0, 1, 2], [1, 3, 2]]), (2, [[0, 1, 2], [0, 2, 3]])])
def test_strips_and_fans_are_triangles(tmp_path: Path, mesh: int, turned: list[list[int]]) -> None:
    scene = imported(written(tmp_path, model([{"mesh": mesh}])))
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], dtype=float)
    assert scene.conductors()["node 0"] == pytest.approx(points[turned])


def test_a_binary_model_is_read_as_a_text_is(tmp_path: Path) -> None:
    document = model(NODES)
    uri = document["buffers"][0].pop("uri")
    data = base64.b64decode(uri.split(",")[1])
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    path = tmp_path / "model.glb"
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data))
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(data), b"BIN\0")
        + data
    )
    expected = imported(written(tmp_path, model(NODES))).conductors()
    for name, triangles in imported(path).conductors().items():
        assert triangles == pytest.approx(expected[name], abs=0)


@pytest.mark.parametrize(("component", "letter"), [(5121, "B"), (5123, "H"), (5125, "I")])
def test_indices_are_whole_numbers_of_any_width(tmp_path: Path, component: int, letter: str) -> None:
    document = model(MESH)
    data = base64.b64decode(document["buffers"][0]["uri"].split(",")[1])[:48] + struct.pack(
        f"<6{letter}", 0, 1, 2, 0, 2, 3
    )
    document["buffers"] = [
        {
            "byteLength": len(data),
            "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
        }
    ]
    document["bufferViews"][1]["byteLength"] = len(data) - 48
    document["accessors"][1]["componentType"] = component
    assert imported(written(tmp_path, document)).conductors()["node 0"] == pytest.approx(TRIANGLES)


def test_extensions_for_looks_are_not_needed(tmp_path: Path) -> None:
    names = ["KHR_materials_unlit", "KHR_texture_transform", "KHR_lights_punctual"]
    document = model(MESH, extensionsRequired=names, extensionsUsed=names)
    assert imported(written(tmp_path, document)).conductors()["node 0"] == pytest.approx(TRIANGLES)


def test_names_of_any_letters_come_through(tmp_path: Path) -> None:
    name = 'left "arm" \\ 1\t\x7fé'
    scene = imported(written(tmp_path, model([{"name": name, "mesh": 0}])))
    assert [link.name for link in scene.links] == [name] == list(scene.conductors())


def test_folders_that_are_not_there_are_made(tmp_path: Path) -> None:
    done = fringe_import(written(tmp_path, model([{"mesh": 0}])), tmp_path / "new" / "deep" / "scene.toml")
    assert done.returncode == 0 and reader.load(tmp_path / "new" / "deep" / "scene.toml").objects


def test_a_scene_that_cannot_be_written_is_told_by_its_name(tmp_path: Path) -> None:
    target = tmp_path / "scene.toml"
    target.mkdir()
    done = fringe_import(written(tmp_path, model([{"mesh": 0}])), target)
    assert done.returncode == 1 and done.stderr == f"fringe: {target}: cannot be written\n"


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = fringe_import(written(tmp_path, model([{"mesh": 0}])), tmp_path / "file" / "scene.toml")
    assert done.returncode == 1 and "cannot be made" in done.stderr


def _accessor(number: int, **changes: Any) -> list[dict[str, Any]]:
    accessors: list[dict[str, Any]] = model([])["accessors"]
    accessors[number] |= changes
    return accessors


def _primitive(**changes: Any) -> list[dict[str, Any]]:
    return [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1} | changes]}]


def _not_finite() -> list[dict[str, Any]]:
    data = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, math.nan, 0, 0, 0, 3) + struct.pack(
        "<6H", 0, 1, 2, 0, 2, 3
    )
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return [{"byteLength": len(data), "uri": uri}]


WRONG_MODELS = {
    "signed indices": (model(MESH, accessors=_accessor(1, componentType=5122)), "accessor 1: indices must be whole"),
    "sparse": (
        model(MESH, accessors=_accessor(0, sparse={
            "count": 1,
            "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 0},
        })),
        "accessor 0: is sparse",
    ),
    "no such accessor": (model(MESH, meshes=_primitive(indices=7)), "indices accessor out of bounds"),
    "no buffer": (model(MESH, bufferViews=[{"buffer": 3, "byteLength": 48}] * 2), "model.gltf"),
    "no vertices": (model(MESH, accessors=_accessor(0, count=0)), "model.gltf"),
    "vertex that is not finite": (model(MESH, buffers=_not_finite()), "accessor 0: vertex 2 is not finite"),
    "morph targets": (model(MESH, meshes=_primitive(targets=[{"POSITION": 0}])), "has morph targets"),
    "no positions": (model(MESH, meshes=_primitive(attributes={"NORMAL": 0})), "has no positions"),
    "endless matrix": (model([{"mesh": 0, "matrix": [1e308 * 10] * 16}]), "model.gltf"),
    "endless place": (model([{"mesh": 0, "scale": [1e300, 1e300, 1e300], "translation": [1e308, 0, 0]}]), "node 0"),
    "too deep": (
        model([*({"children": [i + 1]} for i in range(1100)), {"mesh": 0}]),
        "node 1001: is below more than 1000 others",
    ),
    "no triangles": (model([{"mesh": 3}]), "holds no triangles"),
    "below itself": (model([{"children": [0]}]), "node 0: is below two nodes, or below itself"),
    "no such node": (model([{"children": [7]}]), "node 7: does not exist"),
    "no such mesh": (model([{"mesh": 9}]), "mesh 9: does not exist"),
    "skin": (model([{"mesh": 0, "skin": 0}]), "node 0: has a skin"),
    "no rotation": (model([{"mesh": 0, "rotation": [0, 0, 0, 0]}]), "node 0: its rotation must not be zero"),
    "no scene": (model(MESH, scenes=[]), "holds no scene"),
    "no such scene": (model(MESH, scene=3), "scene 3: does not exist"),
    "needs an extension": (
        model(MESH, extensionsRequired=["KHR_draco_mesh_compression"], extensionsUsed=["KHR_draco_mesh_compression"]),
        "needs the extension KHR_draco_mesh_compression",
    ),
    "needs an extension for its data": (
        model(MESH, accessors=[{"componentType": 5126, "count": 3, "type": "VEC3"}] * 2, extensionsRequired=["KHR_draco_mesh_compression"]),
        "needs the extension KHR_draco_mesh_compression",
    ),
    "beyond the buffer": (model(MESH, accessors=_accessor(0, count=5)), "accessor 0: reaches beyond its buffer"),
    "far beyond": (model(MESH, accessors=_accessor(0, byteOffset=4294967292)), "accessor 0: reaches beyond its buffer"),
    "index too large": (
        model(MESH, accessors=_accessor(1, bufferView=0, count=24)),
        "accessor 1: names vertex",
    ),
    "positions of bytes": (model(MESH, accessors=_accessor(0, componentType=5121)), "vectors of three floats"),
    "no buffer view": (model(MESH, accessors=_accessor(0, bufferView=4)), "accessor 0: has no buffer view"),
    "positions before the first accessor": (
        model(MESH, meshes=_primitive(attributes={"POSITION": -2})), "accessor -2: does not exist",
    ),
    "vertices beyond single precision": (
        model([{"mesh": 0, "scale": [1e300, 1, 1]}]),
        'model.gltf makes no scene: object "node 0": shape.file: the mesh file node_0.stl cannot be read: vertex',
    ),
    "two vertices left": (model(MESH, accessors=_accessor(1, count=5)), "mesh 0: the number of its vertices"),
}  # fmt: skip


@pytest.mark.parametrize(("document", "told"), WRONG_MODELS.values(), ids=WRONG_MODELS)
def test_models_that_are_none_are_refused_and_leave_nothing(
    tmp_path: Path, document: dict[str, Any], told: str
) -> None:
    assert_refused(written(tmp_path, document), told)


@pytest.mark.parametrize("name", ["model.gltf", "model.glb", "robot.urdf"])
def test_files_that_are_damaged_or_missing_are_refused(tmp_path: Path, name: str) -> None:
    assert_refused(tmp_path / name, "exist")
    (tmp_path / name).write_bytes(b"\x00\xff{")
    assert_refused(tmp_path / name, name)


def test_a_file_of_another_kind_is_refused(robot: Path) -> None:
    assert_refused(
        robot.rename(robot.with_suffix(".xml")),
        "must end in .urdf, .gltf, .glb, .dae, .obj, .3mf, .step, .stp, .lst or .qui",
    )


def test_options_that_would_change_nothing_and_wrong_ones_are_refused(tmp_path: Path, robot: Path) -> None:
    path = written(tmp_path, model(MESH))
    for option in (("--geometry", "visual"), ("--missing", "refuse"), ("--package-path", tmp_path)):
        done = fringe_import(path, tmp_path / "scene.toml", *option)
        assert done.returncode == 2 and "options for URDF" in done.stderr
    for wrong, told in (
        (("--geometry", "inner"), "must be collision or visual"),
        (("--missing", "maybe"), "--missing: must be refuse or leave-out, not maybe"),
    ):
        done = fringe_import(robot, tmp_path / "scene.toml", *wrong)
        assert done.returncode == 2 and told in done.stderr
