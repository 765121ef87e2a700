"""`fringe import` of glTF, whose nodes become links that both readers read alike, and what holds for every format."""

import base64
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometries.scene import reader
from tests.end_to_end.importing import (
    TRIANGLES,
    about,
    affine,
    assert_refused,
    fringe_import,
    imported,
    written,
)


POINTS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3)
INDICES = (0, 1, 2, 0, 2, 3)


def buffer(data: bytes) -> list[dict[str, Any]]:
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return [{"byteLength": len(data), "uri": uri}]


def model(nodes: list[dict[str, Any]], **changes: Any) -> dict[str, Any]:
    """A glTF model of nodes; its mesh 0 is indexed triangles, 1 a strip, 2 a fan, 3 points."""
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
        "buffers": buffer(POINTS + struct.pack("<6H", *INDICES)),
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6},
        ],
    } | changes


def gltf(folder: Path, document: dict[str, Any]) -> Path:
    return written(folder / "model.gltf", json.dumps(document))


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
    scene = imported(gltf(tmp_path, model(NODES)))
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
    scene = imported(gltf(tmp_path, model([{"mesh": mesh}])))
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
    expected = imported(gltf(tmp_path, model(NODES))).conductors()
    for name, triangles in imported(path).conductors().items():
        assert triangles == pytest.approx(expected[name], abs=0)


@pytest.mark.parametrize(("component", "letter"), [(5121, "B"), (5123, "H"), (5125, "I")])
def test_indices_are_whole_numbers_of_any_width(tmp_path: Path, component: int, letter: str) -> None:
    indices = struct.pack(f"<6{letter}", *INDICES)
    document = model(MESH, buffers=buffer(POINTS + indices))
    document["bufferViews"][1]["byteLength"] = len(indices)
    document["accessors"][1]["componentType"] = component
    assert imported(gltf(tmp_path, document)).conductors()["node 0"] == pytest.approx(TRIANGLES)


def test_extensions_for_looks_are_not_needed(tmp_path: Path) -> None:
    names = ["KHR_materials_unlit", "KHR_texture_transform", "KHR_lights_punctual"]
    document = model(MESH, extensionsRequired=names, extensionsUsed=names)
    assert imported(gltf(tmp_path, document)).conductors()["node 0"] == pytest.approx(TRIANGLES)


def test_names_of_any_letters_come_through(tmp_path: Path) -> None:
    name = 'left "arm" \\ 1\t\x7fé'
    scene = imported(gltf(tmp_path, model([{"name": name, "mesh": 0}])))
    assert [link.name for link in scene.links] == [name] == list(scene.conductors())


def test_folders_that_are_not_there_are_made_and_those_that_cannot_be_are_told(tmp_path: Path) -> None:
    source, target = gltf(tmp_path, model(MESH)), tmp_path / "new" / "deep" / "scene.toml"
    assert fringe_import(source, target).returncode == 0 and reader.load(target).objects
    done = fringe_import(source, target.parent)
    assert done.returncode == 1 and done.stderr == f"fringe: {target.parent}: cannot be written\n"
    done = fringe_import(source, target / "scene.toml")
    assert done.returncode == 1 and "cannot be made" in done.stderr


def _accessor(number: int, **changes: Any) -> list[dict[str, Any]]:
    accessors: list[dict[str, Any]] = model([])["accessors"]
    accessors[number] |= changes
    return accessors


def _primitive(**changes: Any) -> list[dict[str, Any]]:
    return [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1} | changes]}]


NOT_FINITE = POINTS[:28] + struct.pack("<f", math.nan) + POINTS[32:] + struct.pack("<6H", *INDICES)
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
    "vertex that is not finite": (model(MESH, buffers=buffer(NOT_FINITE)), "accessor 0: vertex 2 is not finite"),
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
    assert_refused(gltf(tmp_path, document), told)


POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:0000\nsize 684\n"


@pytest.mark.parametrize("ending", "urdf dae obj 3mf glb gltf step lst".split())
def test_files_that_are_missing_or_without_their_content_are_told(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"model.{ending}"
    assert_refused(path, "exist")
    path.write_text(POINTER)
    assert_refused(path, f"{path.name}: it is a pointer of Git LFS, whose content has to be fetched")


@pytest.mark.parametrize(
    ("ending", "content", "told"), [("gltf", "\0{", ""), ("glb", "\0{", ""), ("glb", "", "it is empty")]
)
def test_files_that_are_damaged_are_refused(tmp_path: Path, ending: str, content: str, told: str) -> None:
    assert_refused(written(tmp_path / f"model.{ending}", content), f"model.{ending}: {told}")


def test_a_file_of_another_kind_is_refused(tmp_path: Path) -> None:
    assert_refused(
        written(tmp_path / "model.xml", "<model/>"),
        "must end in .urdf, .gltf, .glb, .dae, .obj, .3mf, .step, .stp, .lst or .qui",
    )


@pytest.mark.parametrize(
    "option",
    [("--geometry", "visual"), ("--missing", "refuse"), ("--package-path", "."), ("--joints", "a=1")],
)
def test_options_that_would_change_nothing_are_refused(tmp_path: Path, option: tuple[str, str]) -> None:
    done = fringe_import(gltf(tmp_path, model(MESH)), tmp_path / "scene.toml", *option)
    assert done.returncode == 2 and "options for URDF" in done.stderr
