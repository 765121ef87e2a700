"""`fringe import` of COLLADA, OBJ and 3MF: nodes become links, their triangles bodies in metres; what is damaged is refused."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from tests.end_to_end.importing import assert_refused, imported

# A tetrahedron; its faces look outwards.
VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], dtype=float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
SOLID = VERTICES[FACES]


def collada(
    *,
    unit: str = '<unit name="meter" meter="1"/>',
    up: str = "Z_UP",
    vertices: str = "0 0 0 1 0 0 0 2 0 0 0 3",
    faces: str = "0 2 1 0 1 3 0 3 2 1 2 3",
    count: int = 4,
    geometry: str = "tetrahedron",
) -> str:
    """A body on a link that is shifted by (10, 0, 0), and one below it, turned by a quarter about z and shifted by (0, 0, 5)."""
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>{unit}<up_axis>{up}</up_axis></asset>
  <library_geometries><geometry id="tetrahedron"><mesh>
    <source id="points">
      <float_array id="numbers" count="12">{vertices}</float_array>
      <technique_common><accessor source="#numbers" count="4" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common>
    </source>
    <vertices id="corners"><input semantic="POSITION" source="#points"/></vertices>
    <triangles count="{count}"><input semantic="VERTEX" source="#corners" offset="0"/><p>{faces}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="all">
    <node id="n1" name="base"><translate>10 0 0</translate><instance_geometry url="#{geometry}"/>
      <node id="n2" name="arm"><translate>0 0 5</translate><rotate>0 0 1 90</rotate><scale>1 1 -2</scale>
        <instance_geometry url="#tetrahedron"/></node>
    </node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#all"/></scene>
</COLLADA>
"""


# The second body in the frame of the first, without the shift of both.
SECOND = (SOLID * [1, 1, -2])[:, [0, 2, 1]] @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]]) + [0, 0, 5]


@pytest.mark.parametrize(
    ("unit", "metres"),
    [('<unit name="meter" meter="1"/>', 1.0), ('<unit name="centimeter" meter="0.01"/>', 0.01), ("", 1.0)],
)
def test_collada_is_in_metres_and_its_nodes_are_links(tmp_path: Path, unit: str, metres: float) -> None:
    path = tmp_path / "model.dae"
    path.write_text(collada(unit=unit))
    scene = imported(path)
    assert {link.name: link.parent for link in scene.links} == {"model": None, "base": "model", "arm": "base"}
    found = scene.conductors()
    assert found["base"] == pytest.approx(metres * (SOLID + [10, 0, 0]), rel=1e-6, abs=1e-6)
    assert found["arm"] == pytest.approx(metres * (SECOND + [10, 0, 0]), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("up", "column"),
    [
        ("Z_UP", [[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        ("Y_UP", [[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
        ("X_UP", [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]),
    ],
)
def test_what_is_up_in_collada_is_z(tmp_path: Path, up: str, column: list[list[int]]) -> None:
    """The rows are the images of x, y and z; of X_UP only the image of x matters, and that it is a rotation."""
    path = tmp_path / "model.dae"
    path.write_text(collada(up=up))
    found = imported(path).conductors()["base"]
    base = SOLID + [10, 0, 0]
    if up == "X_UP":
        assert found[..., 2] == pytest.approx(base[..., 0], abs=1e-6)
        assert volume(found) == pytest.approx(volume(base))
    else:
        assert found == pytest.approx(base @ np.array(column), abs=1e-6)


def volume(triangles: np.ndarray) -> float:
    return float(np.linalg.det(triangles).sum() / 6)


WRONG_COLLADA = {
    "cut off": (collada()[:900], "model.dae: "),
    "no XML": ("solid", "model.dae: "),
    "no such vertex": (collada(faces="0 2 1 0 1 3 0 3 2 1 2 9"), "model.dae: "),
    "fewer indices than told": (collada(count=5), "model.dae: "),
    "fewer numbers than told": (collada(vertices="0 0 0 1 0 0"), "model.dae: "),
    "not a number": (collada(vertices="0 0 0 1 0 0 0 2 0 0 0 nan"), "is not finite"),
    "endless": (collada(vertices="0 0 0 1 0 0 0 2 0 0 0 1e999"), "is not finite"),
    "no such geometry": (collada(geometry="sphere"), 'geometry for ID "sphere"'),
    "nothing": (collada(faces="", count=0), "model.dae: "),
}


@pytest.mark.parametrize(("text", "told"), WRONG_COLLADA.values(), ids=WRONG_COLLADA)
def test_damaged_collada_is_refused(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "model.dae"
    path.write_text(text)
    assert_refused(path, told)


OBJ = """mtllib colours.mtl
o housing
v 0 0 0
v 1 0 0
v 0 2 0
v 0 0 3
usemtl steel
f 1 3 2
f 1 2 4
usemtl paint
f 1 4 3
f 2 3 4
o plate
usemtl steel
v 5 0 0
v 6 0 0
v 6 1 0
v 5 1 0
f 5 6 7 8
"""


def test_objects_of_obj_are_bodies_whatever_their_materials(tmp_path: Path) -> None:
    path = tmp_path / "model.obj"
    path.write_text(OBJ)
    (tmp_path / "colours.mtl").write_text("newmtl steel\nKd 1 1 1\nnewmtl paint\nKd 0 0 1\n")
    found = imported(path).conductors()
    assert list(found) == ["housing", "plate"]
    assert found["housing"].shape == (4, 3, 3) and volume(found["housing"]) == pytest.approx(1)
    assert found["plate"].shape == (2, 3, 3)


def test_a_missing_file_of_materials_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "model.obj"
    path.write_text(OBJ)
    assert list(imported(path).conductors()) == ["housing", "plate"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (OBJ.replace("f 2 3 4", "f 2 3 44"), "refers to vertex 44"),
        (OBJ.replace("v 0 0 3", "v 0 0 nan"), "model.obj"),
        (OBJ.replace("v 0 0 3", "v 0 0"), "has a vertex of 2 coordinates"),
        ("# nothing\n", "model.obj"),
    ],
)
def test_damaged_obj_is_refused(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "model.obj"
    path.write_text(text)
    assert_refused(path, told)


RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>"""


def write_3mf(path: Path, unit: str | None, vertices: str = "", index: int = 3) -> None:
    """A tetrahedron at (10, 0, 0)."""
    points = vertices or "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in VERTICES)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in FACES[:3])
    model = f"""<?xml version="1.0" encoding="UTF-8"?>
<model {f'unit="{unit}"' if unit else ''} xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<resources><object id="1" type="model" name="part"><mesh><vertices>{points}</vertices>
<triangles>{faces}<triangle v1="1" v2="2" v3="{index}"/></triangles></mesh></object></resources>
<build><item objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0"/></build></model>"""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "[Content_Types].xml",
            '<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
            '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
            '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
        )
        archive.writestr("_rels/.rels", RELATIONS)
        archive.writestr("3D/3dmodel.model", model)


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("millimeter", 1e-3), (None, 1e-3), ("inch", 0.0254), ("meter", 1.0), ("micron", 1e-6)],
)
def test_3mf_has_its_own_unit(tmp_path: Path, unit: str | None, metres: float) -> None:
    path = tmp_path / "model.3mf"
    write_3mf(path, unit)
    (found,) = imported(path).conductors().values()
    assert found == pytest.approx(metres * (SOLID + [10, 0, 0]), rel=1e-6, abs=1e-6 * metres)


def test_damaged_3mf_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.3mf"
    write_3mf(path, "mile")
    assert_refused(path, 'unit "mile"')
    write_3mf(path, None, index=9)
    assert_refused(path, "model.3mf")
    write_3mf(path, None, vertices='<vertex x="0" y="0" z="nan"/>' * 4)
    assert_refused(path, "not finite")
    write_3mf(path, None)
    path.write_bytes(path.read_bytes()[:-300])
    assert_refused(path, "model.3mf")
    path.write_bytes(b"")
    assert_refused(path, "model.3mf")


def robot_with(mesh: str, scale: str = "1 1 1") -> str:
    return (
        f'<robot name="r"><link name="a"><collision><geometry><mesh filename="{mesh}" scale="{scale}"/>'
        "</geometry></collision></link></robot>"
    )


@pytest.mark.parametrize("up", ["Z_UP", "Y_UP", "X_UP"])
def test_meshes_of_a_robot_keep_their_axes_and_have_their_unit_and_scale(tmp_path: Path, up: str) -> None:
    (tmp_path / "part.dae").write_text(collada(unit='<unit name="centimeter" meter="0.01"/>', up=up))
    path = tmp_path / "robot.urdf"
    path.write_text(robot_with("part.dae", "1 2 -3"))
    (found,) = imported(path).conductors().values()
    both = np.concatenate([SOLID, SECOND]) + [10, 0, 0]
    assert found == pytest.approx((0.01 * both * [1, 2, -3])[:, [0, 2, 1]], rel=1e-6, abs=1e-6)


def test_a_robot_has_meshes_of_3mf_and_obj(tmp_path: Path) -> None:
    write_3mf(tmp_path / "part.3mf", None)
    (tmp_path / "part.obj").write_text(OBJ)
    path = tmp_path / "robot.urdf"
    for name, count in (("part.3mf", 4), ("part.obj", 6)):
        path.write_text(robot_with(name))
        assert len(imported(path).conductors()["a"]) == count


def test_a_mesh_that_a_robot_cannot_have_is_told_with_its_link(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    (tmp_path / "part.dae").write_text(collada()[:900])
    path.write_text(robot_with("part.dae"))
    assert_refused(path, 'link "a": mesh: ')
    (tmp_path / "part.fbx").write_text("Kaydara")
    path.write_text(robot_with("part.fbx"))
    assert_refused(path, "part.fbx: must end in .stl, .obj, .ply, .dae, .3mf, .gltf or .glb")
