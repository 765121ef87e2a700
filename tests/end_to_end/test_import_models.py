"""`fringe import` of COLLADA, OBJ and 3MF: nodes become links, their triangles bodies in metres; what is damaged is refused."""

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from tests.end_to_end.importing import area, assert_refused, imported, volume, written

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
    scene = imported(written(tmp_path / "model.dae", collada(unit=unit)))
    assert {link.name: link.parent for link in scene.links} == {"model": None, "base": "model", "arm": "base"}
    found = scene.conductors()
    assert found["base"] == pytest.approx(metres * (SOLID + [10, 0, 0]), rel=1e-6, abs=1e-6)
    assert found["arm"] == pytest.approx(metres * (SECOND + [10, 0, 0]), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("up", ["Z_UP", "Y_UP", "X_UP"])
def test_what_is_up_in_collada_is_z(tmp_path: Path, up: str) -> None:
    """By a rotation, which leaves x as it is unless that is up."""
    found = imported(written(tmp_path / "model.dae", collada(up=up))).conductors()["base"]
    base = SOLID + [10, 0, 0]
    assert found[..., 2] == pytest.approx(base[..., "XYZ".index(up[0])], abs=1e-6)
    assert up == "X_UP" or found[..., 0] == pytest.approx(base[..., 0], abs=1e-6)
    assert volume(found) == pytest.approx(volume(base))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_what_bounds_no_body_does_not_matter_in_collada(tmp_path: Path, encoding: str) -> None:
    """Colours and lights with blanks or without numbers, cameras of one name, and extras of other programs."""
    looks = (
        '<library_effects><effect id="e"><profile_COMMON><technique sid="c"><phong><diffuse><color>  0 0 0 1  </color></diffuse>'
        "<emission><color></color></emission></phong></technique></profile_COMMON></effect></library_effects>"
        '<library_lights><light id="l"><technique_common><ambient><color>  1 1 </color></ambient></technique_common></light></library_lights>'
        '<library_cameras><camera id="c" name="Cam"><optics/></camera></library_cameras><extra><technique profile="x">?</technique></extra>'
    )
    nodes = "".join(
        f'<node id="c{k}" name="Cam"><instance_camera url="#c"/><instance_light url="#l"/></node>'
        for k in (1, 2)
    )
    text = collada().replace("<library_geometries>", looks + "<library_geometries>")
    text = text.replace('<node id="n1"', nodes + '<node id="n1"').replace(
        'encoding="utf-8"', f'encoding="{encoding}"'
    )
    found = imported(written(tmp_path / "model.dae", text, encoding=encoding)).conductors()
    assert list(found) == ["base", "arm"]
    assert found["base"] == pytest.approx(SOLID + [10, 0, 0], rel=1e-6, abs=1e-6)


def test_polygons_of_collada_are_divided_as_those_of_meshes_are(tmp_path: Path) -> None:
    polygon = '<polylist count="1"><input semantic="VERTEX" source="#corners" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>'
    text = collada(vertices="2 0 0 1 .2 0 1 2 0 0 0 0")
    path = written(tmp_path / "model.dae", re.sub("<triangles.*</triangles>", polygon, text))
    assert area(imported(path).conductors()["base"]) == pytest.approx(1.1, rel=1e-6)


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
    "lights only": (re.sub("<instance_geometry[^>]*>", "", collada()), "holds no triangles"),
}


@pytest.mark.parametrize(("text", "told"), WRONG_COLLADA.values(), ids=WRONG_COLLADA)
def test_damaged_collada_is_refused(tmp_path: Path, text: str, told: str) -> None:
    assert_refused(written(tmp_path / "model.dae", text), told)


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
    """Also if their file is missing."""
    path = written(tmp_path / "model.obj", OBJ)
    assert list(imported(path).conductors()) == ["housing", "plate"]
    (tmp_path / "colours.mtl").write_text("newmtl steel\nKd 1 1 1\nnewmtl paint\nKd 0 0 1\n")
    found = imported(path).conductors()
    assert list(found) == ["housing", "plate"]
    assert found["housing"].shape == (4, 3, 3) and volume(found["housing"]) == pytest.approx(1)
    assert found["plate"].shape == (2, 3, 3)


CORNERS = "v 2 0 0\nv 1 .2 0 1\nv 1 2 0\nv 0 0 0\n"


@pytest.mark.parametrize(
    ("text", "names"),
    [
        (CORNERS + "f 1 2 3 4\n", ["model"]),
        (CORNERS + "g left side\nf 2 3 4\ng\nf 4 1 2\n", ["model", "left side"]),
        (CORNERS + "o a\nf 2 3 4\no b\no a\nf 4 1 2\n", ["a"]),
        ("\ufeff" + CORNERS + "f 1 2 3 4\n", ["model"]),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_obj_is_read_as_the_mesh_of_a_scene_is(
    tmp_path: Path, text: str, names: list[str], encoding: str
) -> None:
    """Also an arrowhead, which a fan from its first corner leaves, weights of 1, and numbers that begin with their point."""
    found = imported(written(tmp_path / "model.obj", text, encoding=encoding)).conductors()
    assert list(found) == names
    assert sum(map(area, found.values())) == pytest.approx(1.1, rel=1e-6)


def test_faces_that_are_bent_are_told(tmp_path: Path) -> None:
    roof = "o roof\n" + CORNERS.replace("1 2 0", "1 2 1") + "f 1 2 3 4\n"
    told = '"roof": faces whose corners are not in one plane: 1, by up to'
    imported(written(tmp_path / "model.obj", roof), warnings=told)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (OBJ.replace("f 2 3 4", "f 2 3 44"), "refers to vertex 44"),
        (OBJ.replace("v 0 0 3", "v 0 0 nan"), "holds 'nan' instead of a finite number in line 6"),
        (OBJ.replace("v 0 0 3", "v 0 0 3 2"), "has a vertex of the weight '2'; only 1 is read in line 6"),
        (OBJ.replace("v 0 0 3", "v 0 0"), "has a vertex of 2 coordinates"),
        ("# nothing\n", "model.obj"),
    ],
)
def test_damaged_obj_is_refused(tmp_path: Path, text: str, told: str) -> None:
    assert_refused(written(tmp_path / "model.obj", text), told)


RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>"""


CORE = 'xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'
PRODUCTION = (
    'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" requiredextensions="p"'
)


def model_3mf(resources: str, build: str, more: str = "") -> str:
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><model {more} {CORE}><resources>{resources}</resources>'
        f"<build>{build}</build></model>"
    )


def object_3mf(number: int = 1, kind: str = "model", vertices: str = "", index: int = 3) -> str:
    """A tetrahedron."""
    points = vertices or "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in VERTICES)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in FACES[:3])
    return (
        f'<object id="{number}" type="{kind}" name="part {number}"><mesh><vertices>{points}</vertices>'
        f'<triangles>{faces}<triangle v1="1" v2="2" v3="{index}"/></triangles></mesh></object>'
    )


def archive_3mf(path: Path, parts: dict[str, str | bytes], *, wide: bool = False) -> Path:
    """Writes an archive; `wide`: with sizes of 64 bits in its entries, as some programs always have them."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "[Content_Types].xml",
            '<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
            '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
            '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
        )
        archive.writestr("_rels/.rels", RELATIONS)
        for name, content in parts.items():
            with archive.open(name, "w", force_zip64=wide) as part:
                part.write(content.encode() if isinstance(content, str) else content)
    return path


def write_3mf(path: Path, unit: str | None) -> Path:
    """A tetrahedron at (10, 0, 0)."""
    item = '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0"/>'
    model = model_3mf(object_3mf(), item, f'unit="{unit}"' if unit else "")
    return archive_3mf(path, {"3D/3dmodel.model": model})


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("millimeter", 1e-3), (None, 1e-3), ("inch", 0.0254), ("meter", 1.0), ("micron", 1e-6)],
)
def test_3mf_has_its_own_unit(tmp_path: Path, unit: str | None, metres: float) -> None:
    (found,) = imported(write_3mf(tmp_path / "model.3mf", unit)).conductors().values()
    assert found == pytest.approx(metres * (SOLID + [10, 0, 0]), rel=1e-6, abs=1e-6 * metres)


def test_an_archive_of_3mf_may_have_a_thumbnail_and_sizes_of_64_bits(tmp_path: Path) -> None:
    path = tmp_path / "model.3mf"
    model = model_3mf(object_3mf(), '<item objectid="1"/>')
    for wide in (False, True):
        archive_3mf(
            path, {"Metadata/thumbnail.png": b"\x89PNG" + bytes(400), "3D/3dmodel.model": model}, wide=wide
        )
        assert imported(path).conductors()["part 1"] == pytest.approx(1e-3 * SOLID, rel=1e-6)


def test_parts_of_3mf_are_links_with_their_places_also_from_other_models(tmp_path: Path) -> None:
    """A turn by a quarter about z; x is mapped to y."""
    components = (
        '<object id="2"><components><component p:path="/3D/Objects/a.model" objectid="1"/>'
        '<component objectid="1" transform="0 1 0 -1 0 0 0 0 1 5 0 0"/></components></object>'
    )
    root = model_3mf(
        object_3mf() + components, '<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 1"/>', PRODUCTION
    )
    other = model_3mf(
        object_3mf(vertices="".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in 2 * VERTICES)), ""
    )
    path = archive_3mf(tmp_path / "model.3mf", {"3D/3dmodel.model": root, "3D/Objects/a.model": other})
    scene = imported(path)
    assert {link.name: link.parent for link in scene.links} == {
        "model": None, "object 2": "model", "part 1": "object 2", "part 1 2": "object 2",
    }  # fmt: skip
    found = scene.conductors()
    assert found["part 1"] == pytest.approx(1e-3 * (4 * SOLID + [0, 0, 1]), rel=1e-6)
    turned = SOLID @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])
    assert found["part 1 2"] == pytest.approx(1e-3 * (2 * turned + [10, 0, 1]), rel=1e-6, abs=1e-9)


def test_supports_of_3mf_are_left_out_with_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "model.3mf"
    items = "".join(f'<item objectid="{k}"/>' for k in (1, 2, 2))
    archive_3mf(path, {"3D/3dmodel.model": model_3mf(object_3mf() + object_3mf(2, "support"), items)})
    scene = imported(
        path, warnings='object "part 2": is of the type support, no part of the model, and is left out'
    )
    assert list(scene.conductors()) == ["part 1"]


WRONG_3MF = {
    "an unknown extension": (
        model_3mf(object_3mf(), '<item objectid="1"/>', 'xmlns:b="http://x/beamlattice/2017/02" requiredextensions="b"'),
        "needs the extension b (http://x/beamlattice/2017/02), which is not read",
    ),
    "no such object": (model_3mf(object_3mf(), '<item objectid="7"/>'), "object 7: does not exist"),
    "no such model": (
        model_3mf('<object id="2"><components><component p:path="/a.model" objectid="1"/></components></object>',
                  '<item objectid="2"/>', PRODUCTION),
        'object "object 2": holds no model /a.model',
    ),
    "within itself": (
        model_3mf('<object id="2"><components><component objectid="2"/></components></object>', '<item objectid="2"/>'),
        "is below more than 1000 others",
    ),
    "more than any": (
        model_3mf("".join(
            f'<object id="{k}"><components><component objectid="{k + 1}"/><component objectid="{k + 1}"/></components></object>'
            for k in range(40)) + object_3mf(40), '<item objectid="0"/>'),
        "there are more than 10000 parts",
    ),
    "nothing to build": (model_3mf(object_3mf(), ""), "holds no triangles"),
    "no XML": ("<model><resources>", "3D/3dmodel.model: is damaged XML"),
    "a place of few numbers": (model_3mf(object_3mf(), '<item objectid="1" transform="1 0 0"/>'), "instead of a finite number"),
    "an unknown unit": (model_3mf(object_3mf(), '<item objectid="1"/>', 'unit="mile"'), 'unit "mile"'),
    "no such vertex": (model_3mf(object_3mf(index=9), '<item objectid="1"/>'), ""),
    "no number": (model_3mf(object_3mf(vertices='<vertex x="0" y="0" z="nan"/>' * 4), '<item objectid="1"/>'), "holds 'nan' instead of a finite number"),
}  # fmt: skip


@pytest.mark.parametrize(("model", "told"), WRONG_3MF.values(), ids=WRONG_3MF)
def test_wrong_models_of_3mf_are_refused(tmp_path: Path, model: str, told: str) -> None:
    assert_refused(archive_3mf(tmp_path / "model.3mf", {"3D/3dmodel.model": model}), told)


def test_an_archive_that_is_cut_off_is_refused(tmp_path: Path) -> None:
    path = write_3mf(tmp_path / "model.3mf", None)
    path.write_bytes(path.read_bytes()[:-300])
    assert_refused(path, "model.3mf: ")


def robot_with(mesh: str, scale: str = "1 1 1") -> str:
    return (
        f'<robot name="r"><link name="a"><collision><geometry><mesh filename="{mesh}" scale="{scale}"/>'
        "</geometry></collision></link></robot>"
    )


@pytest.mark.parametrize("up", ["Z_UP", "Y_UP", "X_UP"])
def test_meshes_of_a_robot_keep_their_axes_and_have_their_unit_and_scale(tmp_path: Path, up: str) -> None:
    (tmp_path / "part.dae").write_text(collada(unit='<unit name="centimeter" meter="0.01"/>', up=up))
    path = written(tmp_path / "robot.urdf", robot_with("part.dae", "1 2 -3"))
    (found,) = imported(path).conductors().values()
    both = np.concatenate([SOLID, SECOND]) + [10, 0, 0]
    assert found == pytest.approx((0.01 * both * [1, 2, -3])[:, [0, 2, 1]], rel=1e-6, abs=1e-6)


def test_a_robot_has_meshes_of_3mf(tmp_path: Path) -> None:
    write_3mf(tmp_path / "part.3mf", None)
    assert len(imported(written(tmp_path / "robot.urdf", robot_with("part.3mf"))).conductors()["a"]) == 4
