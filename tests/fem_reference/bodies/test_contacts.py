"""Grounded bodies that touch are one conductor; between bodies of different potential contact is refused."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from fem_reference.bodies.conductors import conductors
from fem_reference.bodies.contacts import groups
from fem_reference.bodies.wrapping import Geometry, Wrap
from geometries.common.errors import InputError
from geometries.scene import shapes
from geometries.scene.reader import loads
from tests.scenes import SENSOR


def body(name: str, shape: str, at: tuple[float, float, float], more: str = "") -> str:
    return f'[[object]]\nname = "{name}"\nshape = {shape}\ntranslation = {list(at)}\n{more}\n'


BOX = '{ type = "cuboid", size = [0.04, 0.04, 0.04] }'
BALL = '{ type = "sphere", radius = 0.02 }'
PLATE = '{ type = "plate", size = [0.04, 0.04] }'
CUBE = shapes.Cuboid((0.04, 0.04, 0.04)).triangles()
UNCLEAN = np.concatenate([CUBE, CUBE[:1]])


def test_groups_follow_their_first_bodies() -> None:
    assert groups(5, [(1, 4), (2, 3), (3, 1)]) == [0, 1, 1, 1, 1]
    assert groups(3, []) == [0, 1, 2]


@pytest.mark.parametrize(
    "shape, at",
    [
        (BOX, (0.04, 0.01, 0.05)),
        (BOX, (0.02, 0.01, 0.06)),
        (BALL, (0.04, 0.0, 0.05)),
        ('{ type = "sphere", radius = 0.01 }', (0.0, 0.0, 0.05)),
        (PLATE, (0.03, 0.0, 0.05)),
        ('{ type = "cylinder", radius = 0.01, height = 0.05 }', (0.0, 0.0, 0.09)),
    ],
    ids=["face to face", "overlapping", "a ball at a face", "inside", "a plate", "sunk in"],
)
def test_grounded_bodies_that_touch_are_one_conductor(shape: str, at: tuple[float, float, float]) -> None:
    """It is named after the first of them in the file, and does not take in a body that is apart."""
    text = (
        SENSOR
        + body("alone", BALL, (-0.1, 0, 0.05))
        + body("base", BOX, (0, 0, 0.05))
        + body("top", shape, at)
    )
    found = conductors(loads(text))
    assert found.names == ("front", "alone", "base")
    assert found.members == (("front",), ("alone",), ("base", "top"))
    assert found.owner == (0, 1, 2, 2)


def test_a_chain_of_links_is_one_conductor_whatever_its_order() -> None:
    text = SENSOR + "".join(body(f"link{k}", BOX, (0.03 * k, 0, 0.05)) for k in (2, 0, 3, 1))
    found = conductors(loads(text))
    assert found.names == ("front", "link2") and len(found.members[1]) == 4


def test_objects_with_one_conductor_key_are_one_conductor_wherever_they_are() -> None:
    """The name that is given wins; grounded bodies that touch one of them join it."""
    text = SENSOR + body("base", BOX, (0, 0, 0.05)) + body("top", BOX, (0.04, 0, 0.05), 'conductor = "arm"')
    text += body("far", BALL, (0.3, 0, 0.05), 'conductor = "arm"')
    found = conductors(loads(text))
    assert found.names == ("front", "arm") and found.members[1] == ("base", "top", "far")
    more = 'potential = "floating"\nconductor = "hand"'
    text = SENSOR + body("palm", BOX, (0, 0, 0.05), more) + body("thumb", BALL, (0.03, 0, 0.05), more)
    found = conductors(loads(text))
    assert found.floating == ("hand",) and found.parts == [[0], [1, 2]]


def test_electrodes_have_rows_and_touch_nothing_else() -> None:
    text = SENSOR + body("guard", BOX, (0, 0, 0.05), 'potential = "electrode"')
    found = conductors(loads(text + body("hand", BALL, (0.1, 0, 0.05))))
    assert found.names == ("front", "guard", "hand") and found.sensors == 1
    with pytest.raises(
        InputError, match='"guard" and "hand": .*touch or cross.*same key "conductor" may touch'
    ):
        conductors(loads(text + body("hand", BALL, (0.03, 0, 0.05))))


@pytest.mark.parametrize(
    "text, words",
    [
        (body("base", BOX, (0, 0, 0.02)), r'"front" and "base": .*touch or cross.* at least 4e-05 m apart'),
        (
            body("base", BOX, (0, 0, 0.05)) + body("hand", BOX, (0.04, 0, 0.05), 'potential = "floating"'),
            '"base" and "hand": .*touch or cross',
        ),
        (
            body("a", BOX, (0, 0, 0.05), 'potential = "floating"')
            + body("b", BOX, (0.02, 0, 0.05), 'potential = "floating"'),
            '"a" and "b": .*touch or cross',
        ),
        (
            body("base", BOX, (0, 0, 0.05)) + body("top", BOX, (0.04001, 0, 0.05)),
            "at least 4e-05 m are needed",
        ),
    ],
    ids=["a sensor", "floating and grounded", "both floating", "a narrow gap"],
)
def test_contact_of_what_may_have_different_potentials_is_refused_with_both_names(
    text: str, words: str
) -> None:
    with pytest.raises(InputError, match=words) as refused:
        conductors(loads(SENSOR + text), "scene.toml")
    assert str(refused.value).startswith("scene.toml: ")


def mesh_scene(folder: Path, triangles: np.ndarray) -> str:
    points = triangles.reshape(-1, 3)
    meshio.write(
        folder / "part.ply",
        meshio.Mesh(points, [("triangle", np.arange(len(points), dtype=np.int32).reshape(-1, 3))]),
    )
    return f'{{ type = "mesh", file = "{folder / "part.ply"}" }}'


@pytest.mark.night
def test_only_conductors_that_need_it_are_wrapped(tmp_path: Path) -> None:
    """A mesh with a triangle twice is wrapped together with the box that it touches; the other box keeps its plane faces."""
    dirty = mesh_scene(tmp_path, UNCLEAN)
    text = SENSOR + body("alone", BOX, (-0.1, 0, 0.05)) + body("link", dirty, (0, 0, 0.05))
    found = conductors(loads(text + body("tool", BALL, (0.04, 0, 0.05))), geometry=Geometry(rtol=2e-2))
    assert found.members == (("front",), ("alone",), ("link", "tool"))
    (wrap,) = found.wraps
    assert [type(own).__name__ for own in found.bodies] == ["Rectangle", "Cuboid", "Wrap"]
    assert isinstance(wrap, Wrap) and wrap.members == ("link", "tool") and wrap.name == "link"


def links(folder: Path, gap: float) -> str:
    """Two links of an arm, unclean meshes with a gap between them."""
    dirty = mesh_scene(folder, UNCLEAN)
    return SENSOR + body("upper", dirty, (0, 0, 0.05)) + body("lower", dirty, (0.04 + gap, 0, 0.05))


def test_links_that_nearly_touch_are_wrapped_together(tmp_path: Path) -> None:
    """Once each was wrapped as finely as the gap between them, and the wraps of a whole arm did not end."""
    found = conductors(loads(links(tmp_path, 1.5e-4)), geometry=Geometry(rtol=2e-2))
    (wrap,) = found.wraps
    assert found.names == ("front", "upper") and wrap.members == ("upper", "lower")
    assert len(wrap.parts) == 1 and wrap.alpha > 1e-3 and len(wrap.triangles) < 400
    assert conductors(loads(links(tmp_path, 4e-3)), geometry=Geometry(rtol=2e-2)).names[1:] == (
        "upper",
        "lower",
    )


@pytest.mark.night
def test_links_without_columns_are_wrapped_together_where_alpha_bridges_their_gap(tmp_path: Path) -> None:
    """Three links, 2.5 mm apart, are grounded whatever is asked; each was a conductor of its own, wrapped as finely as its gap."""
    text = links(tmp_path, 2.5e-3) + body("last", mesh_scene(tmp_path, UNCLEAN), (0.085, 0, 0.05))
    text += body("hand", BALL, (0, 0.1, 0.05), "target = true")
    found = conductors(loads(text), columns=["front"], geometry=Geometry(rtol=2e-2))
    (wrap,) = found.wraps
    assert found.names == ("front",) and found.grounded == ("upper", "hand")
    assert wrap.members == ("upper", "lower", "last") and found.is_target == (False, False, True)


def test_a_target_that_nearly_touches_the_machine_is_no_part_of_it(tmp_path: Path) -> None:
    """At this gap two links of the machine are wrapped together."""
    text = links(tmp_path, 2.5e-3) + "target = true\n"
    found = conductors(loads(text), geometry=Geometry(rtol=2e-2))
    assert found.names == ("front", "upper", "lower") and found.targets == {"lower"}


def test_a_clean_mesh_is_wrapped_only_where_that_is_asked_for(tmp_path: Path) -> None:
    prism = mesh_scene(tmp_path, shapes.Cylinder(0.02, 0.04, 6).triangles())
    text = SENSOR + body("link", prism, (0, 0, 0.05))
    assert conductors(loads(text)).wraps == ()
    assert len(conductors(loads(text), geometry=Geometry("wrapped", rtol=2e-2)).wraps) == 1


def test_a_dielectric_mesh_is_never_wrapped(tmp_path: Path) -> None:
    dirty = mesh_scene(tmp_path, UNCLEAN)
    text = SENSOR + body("block", dirty, (0, 0, 0.05), "material = { relative_permittivity = 3 }")
    with pytest.raises(InputError, match='object "block": shape.file: .*part.ply has'):
        conductors(loads(text), geometry=Geometry("wrapped"))


@pytest.mark.parametrize("thickness", [1e-4, 5e-4, 2e-3, 2e-2])
def test_a_dielectric_layer_may_lie_on_a_plate_however_thin(thickness: float) -> None:
    layer = f'{{ type = "cuboid", size = [0.1, 0.1, {thickness}] }}'
    material = "material = { relative_permittivity = 3 }"
    found = conductors(loads(SENSOR + body("layer", layer, (0, 0, thickness / 2), material)))
    assert [own.name for own in found.dielectrics] == ["layer"]
    sunk = SENSOR + body("layer", layer, (0, 0, 0.4 * thickness), material)
    with pytest.raises(InputError, match='"front" is inside "layer"'):
        conductors(loads(sunk))


def test_the_cover_of_a_sensor_is_a_dielectric_body_that_stays() -> None:
    covered = (
        SENSOR + "cover = { thickness = 1e-3, relative_permittivity = 3 }\n" + body("hand", BOX, (0, 0, 0.05))
    )
    found = conductors(loads(covered))
    assert [own.name for own in found.dielectrics] == ["front cover"]
    assert found.targets == {"hand"}
