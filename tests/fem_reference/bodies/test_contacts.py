"""Grounded bodies that touch are one conductor; between bodies of different potential contact is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem_reference.bodies.conductors import Assembly, assembly, conductors
from fem_reference.bodies.contacts import groups
from fem_reference.bodies.wrapping import Geometry
from geometries.common.errors import InputError
from geometries.scene import meshes, shapes
from geometries.scene.reader import loads
from tests import scenes
from tests.scenes import SENSOR

CUBE = shapes.Cuboid((0.04, 0.04, 0.04)).triangles()
UNCLEAN = np.concatenate([CUBE, CUBE[:1]])


def box(name: str, *at: float, **keys: Any) -> str:
    return scenes.body(name, "cuboid", size=[0.04, 0.04, 0.04], translation=[*at], **keys)


def ball(name: str, *at: float, **keys: Any) -> str:
    return scenes.body(name, "sphere", radius=0.02, translation=[*at], **keys)


def test_groups_follow_their_first_bodies() -> None:
    assert groups(5, [(1, 4), (2, 3), (3, 1)]) == [0, 1, 1, 1, 1]
    assert groups(3, []) == [0, 1, 2]


@pytest.mark.parametrize(
    "top",
    [
        pytest.param(box("top", 0.04, 0.01, 0.05), id="face to face"),
        pytest.param(box("top", 0.02, 0.01, 0.06), id="overlapping"),
        pytest.param(ball("top", 0.04, 0, 0.05), id="a ball at a face"),
        pytest.param(scenes.body("top", "sphere", radius=0.01, translation=[0, 0, 0.05]), id="inside"),
        pytest.param(
            scenes.body("top", "plate", size=[0.04, 0.04], translation=[0.03, 0, 0.05]), id="a plate"
        ),
        pytest.param(
            scenes.body("top", "cylinder", radius=0.01, height=0.05, translation=[0, 0, 0.09]), id="sunk in"
        ),
    ],
)
def test_grounded_bodies_that_touch_are_one_conductor(top: str) -> None:
    """It is named after the first of them in the file, and does not take in a body that is apart."""
    found = conductors(loads(SENSOR + ball("alone", -0.1, 0, 0.05) + box("base", 0, 0, 0.05) + top))
    assert found.names == ("front", "alone", "base")
    assert found.members == (("front",), ("alone",), ("base", "top"))
    assert found.owner == (0, 1, 2, 2)


def test_a_chain_of_links_is_one_conductor_whatever_its_order() -> None:
    text = SENSOR + "".join(box(f"link{k}", 0.03 * k, 0, 0.05) for k in (2, 0, 3, 1))
    found = conductors(loads(text))
    assert found.names == ("front", "link2") and len(found.members[1]) == 4


def test_objects_with_one_conductor_key_are_one_conductor_wherever_they_are() -> None:
    """The name that is given wins; grounded bodies that touch one of them join it."""
    text = SENSOR + box("base", 0, 0, 0.05) + box("top", 0.04, 0, 0.05, conductor="arm")
    found = conductors(loads(text + ball("far", 0.3, 0, 0.05, conductor="arm")))
    assert found.names == ("front", "arm") and found.members[1] == ("base", "top", "far")
    more = {"potential": "floating", "conductor": "hand"}
    found = conductors(loads(SENSOR + box("palm", 0, 0, 0.05, **more) + ball("thumb", 0.03, 0, 0.05, **more)))
    assert found.floating == ("hand",) and found.parts == [[0], [1, 2]]


GUARD = box("guard", 0, 0, 0.05, potential="electrode")


def test_electrodes_have_rows() -> None:
    found = conductors(loads(SENSOR + GUARD + ball("hand", 0.1, 0, 0.05)))
    assert found.names == ("front", "guard", "hand") and found.sensors == 1


@pytest.mark.parametrize(
    "text, words",
    [
        (GUARD + ball("hand", 0.03, 0, 0.05), 'touch or cross.*same key "conductor" may touch'),
        (box("base", 0, 0, 0.02), r'"front" and "base": .*touch or cross.* at least 4e-05 m apart'),
        (
            box("base", 0, 0, 0.05) + box("hand", 0.04, 0, 0.05, potential="floating"),
            '"base" and "hand": .*touch or cross',
        ),
        (
            box("a", 0, 0, 0.05, potential="floating") + box("b", 0.02, 0, 0.05, potential="floating"),
            '"a" and "b": .*touch or cross',
        ),
        (box("base", 0, 0, 0.05) + box("top", 0.04001, 0, 0.05), "at least 4e-05 m are needed"),
    ],
    ids=["an electrode", "a sensor", "floating and grounded", "both floating", "a narrow gap"],
)
def test_contact_of_what_may_have_different_potentials_is_refused_with_both_names(
    text: str, words: str
) -> None:
    with pytest.raises(InputError, match=words) as refused:
        conductors(loads(SENSOR + text), "scene.toml")
    assert str(refused.value).startswith("scene.toml: ")


def mesh(folder: Path, name: str, *at: float, triangles: np.ndarray = UNCLEAN, **keys: Any) -> str:
    """A body of triangles, by default one that cannot be meshed as it is."""
    meshes.write(triangles, folder / "part.ply")
    return scenes.body(name, "mesh", file=str(folder / "part.ply"), translation=[*at], **keys)


def put_together(text: str, columns: tuple[str, ...] = ()) -> Assembly:
    """The parts of a scene before they are wrapped."""
    return assembly(loads(text), "scene", columns, Geometry(rtol=2e-2))


@pytest.mark.night
def test_only_conductors_that_need_it_are_wrapped(tmp_path: Path) -> None:
    """A mesh with a triangle twice is wrapped together with the ball that it touches; the box keeps its plane faces."""
    text = SENSOR + box("alone", -0.1, 0, 0.05) + mesh(tmp_path, "link", 0, 0, 0.05)
    found = conductors(loads(text + ball("tool", 0.04, 0, 0.05)), geometry=Geometry(rtol=2e-2))
    assert found.members == (("front",), ("alone",), ("link", "tool"))
    assert [type(own).__name__ for own in found.bodies] == ["Rectangle", "Cuboid", "Wrap"]
    assert found.wraps[0].members == ("link", "tool") and found.wraps[0].name == "link"


def links(folder: Path, gap: float, **keys: Any) -> str:
    """Two links of an arm, unclean meshes with a gap between them."""
    return SENSOR + mesh(folder, "upper", 0, 0, 0.05) + mesh(folder, "lower", 0.04 + gap, 0, 0.05, **keys)


def test_links_that_nearly_touch_are_wrapped_together(tmp_path: Path) -> None:
    """Once each was wrapped as finely as the gap between them, and the wraps of a whole arm did not end."""
    found = conductors(loads(links(tmp_path, 1.5e-4)), geometry=Geometry(rtol=2e-2))
    (wrap,) = found.wraps
    assert found.names == ("front", "upper") and wrap.members == ("upper", "lower")
    assert len(wrap.parts) == 1 and wrap.alpha > 1e-3 and len(wrap.triangles) < 400
    assert put_together(links(tmp_path, 4e-3)).asked == ("front", "upper", "lower")


def test_links_without_columns_are_wrapped_together_where_alpha_bridges_their_gap(tmp_path: Path) -> None:
    """Three links, 2.5 mm apart, are grounded whatever is asked; each was a conductor of its own, wrapped as finely as its gap."""
    text = links(tmp_path, 2.5e-3) + mesh(tmp_path, "last", 0.085, 0, 0.05)
    found = put_together(text + ball("hand", 0, 0.1, 0.05, target=True), ("front",))
    assert found.asked == ("front",) and found.others == ("upper", "hand") and found.targets == {"hand"}
    assert [part.cluster for part in found.parts] == ["front", "upper", "upper", "upper", "hand"]


def test_a_target_that_nearly_touches_the_machine_is_no_part_of_it(tmp_path: Path) -> None:
    """At this gap two links of the machine are wrapped together."""
    found = put_together(links(tmp_path, 2.5e-3, target=True))
    assert found.asked == ("front", "upper", "lower") and found.targets == {"lower"}


def test_a_clean_mesh_is_wrapped_only_where_that_is_asked_for(tmp_path: Path) -> None:
    prism = shapes.Cylinder(0.02, 0.04, 6).triangles()
    text = SENSOR + mesh(tmp_path, "link", 0, 0, 0.05, triangles=prism)
    assert conductors(loads(text)).wraps == ()
    assert len(conductors(loads(text), geometry=Geometry("wrapped", rtol=2e-2, alpha=0.08)).wraps) == 1


def test_a_dielectric_mesh_is_never_wrapped(tmp_path: Path) -> None:
    text = SENSOR + mesh(tmp_path, "block", 0, 0, 0.05, material={"relative_permittivity": 3})
    with pytest.raises(InputError, match='object "block": shape.file: .*part.ply has'):
        conductors(loads(text), geometry=Geometry("wrapped"))


@pytest.mark.parametrize("thickness", [1e-4, 5e-4, 2e-3, 2e-2])
def test_a_dielectric_layer_may_lie_on_a_plate_however_thin(thickness: float) -> None:
    def layer(height: float) -> str:
        keys = {"size": [0.1, 0.1, thickness], "material": {"relative_permittivity": 3}}
        return SENSOR + scenes.body("layer", "cuboid", translation=[0, 0, height], **keys)

    assert [own.name for own in conductors(loads(layer(thickness / 2))).dielectrics] == ["layer"]
    with pytest.raises(InputError, match='"front" is inside "layer"'):
        conductors(loads(layer(0.4 * thickness)))


def test_the_cover_of_a_sensor_is_a_dielectric_body_that_stays() -> None:
    covered = SENSOR + "cover = { thickness = 1e-3, relative_permittivity = 3 }\n"
    found = conductors(loads(covered + box("hand", 0, 0, 0.05)))
    assert [own.name for own in found.dielectrics] == ["front cover"]
    assert found.targets == {"hand"}
