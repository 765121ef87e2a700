"""`fringe import` of robots (URDF) as they are found: what no scene needs does not matter, and one bad mesh need not stop the rest."""

from pathlib import Path

import numpy as np
import pytest

from geometries.scene import reader
from geometries.scene.shapes import Cuboid, Cylinder, Disc, MeshShape, PlateShape, Sphere
from tests.end_to_end.importing import (
    MESH,
    OBJ,
    ROBOT,
    SINGLE_PRECISION,
    TRIANGLES,
    assert_refused,
    fringe_import,
    imported,
    robot_in,
    written,
)
from tests.programs import fringe_command


def test_collision_geometries_are_objects_on_their_links(tmp_path: Path) -> None:
    objects = {body.name: body for body in imported(robot_in(tmp_path)).objects}
    shapes = {name: body.shape for name, body in objects.items()}
    mesh = shapes.pop("hand")
    assert shapes == {
        "base": Cuboid((0.4, 0.3, 0.2)),
        "upper arm": Cylinder(0.05, 0.5),
        "upper arm 2": Sphere(0.07),
        "thumb": Cuboid((0.01, 0.02, 0.03)),
        "nail": Cuboid((0.01, 0.01, 0.01)),
    }
    assert all(body.link == name.removesuffix(" 2") for name, body in objects.items())
    pose = objects["upper arm"].pose.transform()
    assert pose.translation == pytest.approx([0, 0, 0.25])
    assert pose.rotation @ [0, 0, 1] == pytest.approx([1, 0, 0], abs=1e-15)
    # A mesh is scaled, and stays anticlockwise when it is reflected.
    assert isinstance(mesh, MeshShape) and Path(mesh.file).parent.name == "scene_meshes"
    expected = (TRIANGLES * [0.001, 0.001, -0.002])[:, [0, 2, 1]]
    assert mesh.triangles() == pytest.approx(expected, rel=SINGLE_PRECISION)


def test_visual_geometries_are_taken_when_asked_for(tmp_path: Path) -> None:
    (body,) = imported(robot_in(tmp_path), "--geometry", "visual").objects
    assert (body.name, body.shape) == ("base", Sphere(1.0))


def test_a_sensor_added_as_the_comment_says_makes_a_scene(tmp_path: Path) -> None:
    robot = robot_in(tmp_path)
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
        assert {sensor.link for sensor in sensors} == {"nail"}
        assert fringe_command("info", path).returncode == 0


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
    "nan": (ROBOT.replace("0 0 0.6", "nan 0 0"), "nan"),
    "no scale": (ROBOT.replace("-0.002", "0"), 'link "hand": mesh: the scale must not be zero'),
    "no such link": (ROBOT.replace('<child link="hand"/>', '<child link="foot"/>'), "foot"),
    "moved nowhere": (ROBOT.replace('axis xyz="1 0 0"', 'axis xyz="0 0 0"', 1), 'joint "lift": its axis must not be zero'),
    "no geometry given": (ROBOT.replace('<sphere radius="0.07"/>', ""), "arm.urdf: "),
    "more links than any robot": (
        '<robot name="r"><link name="a"/>' + "".join(
            f'<link name="l{i}"/><joint name="j{i}" type="fixed"><parent link="a"/><child link="l{i}"/></joint>'
            for i in range(10000)
        ) + "</robot>",
        "robot: has more than 10000 links",
    ),
    "moved beyond all numbers": (
        ROBOT.replace('offset="0.1"', 'offset="1e308"').replace('multiplier="0.5"', 'multiplier="1e308"'),
        'joint "tip": its position must be finite',
    ),
    "farther than a scene reaches": (ROBOT.replace("0 0 0.6", "1e40 0 0"), 'arm.urdf makes no scene: link "hand": translation'),
    "mimics itself": (ROBOT.replace('mimic joint="shoulder"', 'mimic joint="grip"'), "mimics itself"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "told"), WRONG_ROBOTS.values(), ids=WRONG_ROBOTS)
def test_robots_that_are_none_are_refused_and_leave_nothing(tmp_path: Path, text: str, told: str) -> None:
    assert_refused(robot_in(tmp_path, text), told)


def test_what_cannot_be_imported_leaves_what_was_imported_before(tmp_path: Path) -> None:
    """The second robot's mesh has the first one's name, and a box that no scene may have."""
    robot = robot_in(tmp_path)
    imported(robot)
    before = {path: path.read_bytes() for path in robot.parent.rglob("*") if path.is_file() and path != robot}
    robot.write_text(ROBOT.replace("0.01 0.02 0.03", "1e40 1 1").replace("-0.002", "0.001"))
    done = fringe_import(robot, robot.with_name("scene.toml"))
    assert done.returncode == 2 and done.stderr
    assert {path: path.read_bytes() for path in before} == before
    assert set(robot.parent.rglob("*")) == {*before, robot, robot.with_name("scene_meshes")}


def test_a_new_import_takes_the_place_of_the_old_one(tmp_path: Path) -> None:
    robot = robot_in(tmp_path)
    first = imported(robot).conductors()["hand"]
    robot.write_text(ROBOT.replace("-0.002", "0.001"))
    changed = imported(robot).conductors()["hand"]
    assert changed != pytest.approx(first, abs=1e-6)
    assert {path.name for path in robot.parent.iterdir()} == {"arm.urdf", "scene.toml", "scene_meshes"}


@pytest.mark.parametrize(
    ("name", "place", "options", "warning"),
    [
        (MESH, "arm_description", [], ""),
        ("package:///arm_description/meshes/hand.obj", "arm_description", [], ""),
        ("package://another_name/meshes/hand.obj", "arm_description", [], "is taken from"),
        ("../meshes/hand.obj", "arm_description", [], ""),
        ("file://FOLDER/arm_description/meshes/hand.obj", "arm_description", [], ""),
        (MESH, "elsewhere", [], None),
        (MESH, "elsewhere/arm_description", ["--package-path", "FOLDER/elsewhere"], ""),
    ],
)
def test_meshes_are_found_beside_the_robot_and_by_their_paths(
    tmp_path: Path, name: str, place: str, options: list[str], warning: str | None
) -> None:
    robot = robot_in(tmp_path, ROBOT.replace(MESH, name.replace("FOLDER", str(tmp_path))))
    (tmp_path / place).mkdir(parents=True, exist_ok=True)
    (tmp_path / "arm_description/meshes").rename(tmp_path / place / "meshes")
    if warning is None:
        assert_refused(robot, f'link "hand": mesh: {name} was not found')
    else:
        found = [option.replace("FOLDER", str(tmp_path)) for option in options]
        assert len(imported(robot, *found, warnings=warning).objects) == 6


BOX = '<geometry><box size="0.1 0.1 0.1"/></geometry>'
LINKS = "".join(f'<link name="{name}"><collision>{BOX}</collision></link>' for name in "ab")


def robot_of(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    head = f'<?xml version="1.0" encoding="{encoding}"?>\n'
    return written(folder / "arm.urdf", f'{head}<robot name="r">{text}</robot>', encoding)


def joint(more: str, kind: str = "revolute") -> str:
    return (
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>{more}</joint>'
    )


def joints(*pairs: str) -> str:
    return "".join(
        f'<joint name="{a}{b}" type="fixed"><parent link="{a}"/><child link="{b}"/></joint>' for a, b in pairs
    )


def link(body: str, name: str = "a") -> str:
    return f'<link name="{name}"><collision><geometry>{body}</geometry></collision></link>'


# What no scene needs, and the warning, if there is one.
UNNEEDED = {
    "limit without effort": (LINKS + joint('<limit lower="-1" upper="1"/>'), ""),
    "limit whose effort is no number": (LINKS + joint('<limit lower="-1" upper="1" effort="inf" velocity="fast"/>'), ""),
    "no limit of a joint that turns": (LINKS + joint(""), ""),
    "no limit of a joint that slides": (LINKS + joint("", "prismatic"), ""),
    "limit of a fixed joint": (LINKS + joint('<limit lower="-1" upper="1"/>', "fixed"), ""),
    "limit that is no number": (LINKS + joint('<limit lower="low" upper="1"/>'), 'joint "j": its limits are left out: \'low\' is no number'),
    "safety": (LINKS + joint('<safety_controller k_position="1"/>'), ""),
    "dynamics": (LINKS + joint('<dynamics damping="x"/>', "continuous"), ""),
    "calibration": (LINKS + joint('<calibration rising="x"/>'), ""),
    "mimic without a joint": (LINKS + joint('<mimic multiplier="2"/>', "continuous"), 'joint "j": mimics no joint'),
    "empty visual": (f'<link name="a"><visual/><collision>{BOX}</collision></link>', ""),
    "unknown material": (LINKS + joint("") + f'<link name="c"><visual>{BOX}<material name="unknown"/></visual></link>' + joints("ac"), ""),
    "mass without inertia": (f'<link name="a"><inertial><mass value="0"/></inertial><collision>{BOX}</collision></link>', ""),
    "line ends between numbers": (link('<box size="0.1\n0.1\t0.1"/>'), ""),
}  # fmt: skip


@pytest.mark.parametrize(("text", "told"), UNNEEDED.values(), ids=UNNEEDED)
def test_what_no_scene_needs_does_not_matter(tmp_path: Path, text: str, told: str) -> None:
    scene = imported(robot_of(tmp_path, text), warnings=told)
    assert {body.shape for body in scene.objects} == {Cuboid((0.1, 0.1, 0.1))}
    assert len(scene.objects) == text.count("<collision>")


def test_the_name_the_version_of_the_format_and_its_encoding_do_not_matter(tmp_path: Path) -> None:
    path = robot_of(tmp_path, LINKS + joint(""), "utf-16")
    assert len(imported(path).objects) == 2
    path.write_text(f'<robot version="2.5">{LINKS}{joint("")}</robot>')
    assert len(imported(path, warnings="robot: has no name").objects) == 2


@pytest.mark.parametrize(
    "body",
    [
        '<box size="0 0 0"/>',
        '<box size="0 0.1 0"/>',
        '<sphere radius="0"/>',
        '<cylinder radius="0" length="1"/>',
    ],
)
def test_what_has_no_size_is_left_out_with_a_warning(tmp_path: Path, body: str) -> None:
    path = robot_of(tmp_path, link('<box size="1 2 3"/>') + link(body, "b") + joint("", "fixed"))
    scene = imported(path, warnings=f'link "b": {body[1:].split()[0]}: has no size, and is left out')
    assert [link.name for link in scene.links] == ["a", "b"]
    assert [body.name for body in scene.objects] == ["a"]


@pytest.mark.parametrize(("size", "span"), [("2 3 0", (2, 3, 0)), ("2 0 3", (2, 0, 3)), ("0 2 3", (0, 2, 3))])
def test_a_box_without_thickness_is_a_plate(tmp_path: Path, size: str, span: tuple[float, ...]) -> None:
    body = f'<link name="a"><collision><origin xyz="5 6 7"/><geometry><box size="{size}"/></geometry></collision></link>'
    scene = imported(robot_of(tmp_path, body))
    assert isinstance(scene.objects[0].shape, PlateShape)
    (found,) = scene.conductors().values()
    assert np.ptp(found, axis=(0, 1)) == pytest.approx(span, abs=1e-15)
    assert (found.min(axis=(0, 1)) + found.max(axis=(0, 1))) / 2 == pytest.approx([5, 6, 7])


def test_a_cylinder_without_height_is_a_disc(tmp_path: Path) -> None:
    scene = imported(robot_of(tmp_path, link('<cylinder radius="0.2" length="0"/>')))
    assert scene.objects[0].shape == Disc(0.2)


POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:0000\nsize 684\n"
# The mesh that a robot names, its content, and what the matter is.
BAD_MESHES = {
    "missing": ("bad.stl", None, "there is no file"),
    "empty": ("bad.stl", "", "it is empty"),
    "zeros": ("bad.stl", "\0" * 80, "it holds nothing but zeros"),
    "pointer instead of STL": ("bad.stl", POINTER, "it is a pointer of Git LFS"),
    "pointer instead of COLLADA": ("bad.dae", POINTER, "it is a pointer of Git LFS"),
    "pointer instead of glTF": ("bad.glb", POINTER, "it is a pointer of Git LFS"),
    "damaged": ("bad.obj", OBJ[:-4], "fewer than three vertices"),
    "of a package": ("package://other/bad.stl", None, "was not found"),
    "on the web": ("https://example.com/a.stl", None, "is on the web; only files of this computer are read"),
    "of another address": ("model://arm/a.stl", None, "none of the addresses that are read"),
    "of another format": ("bad.fbx", "Kaydara", "must end in .stl"),
}


@pytest.mark.parametrize(("name", "content", "told"), BAD_MESHES.values(), ids=BAD_MESHES)
def test_one_bad_mesh_is_told_and_stops_the_rest_only_if_it_shall(
    tmp_path: Path, name: str, content: str | None, told: str
) -> None:
    (tmp_path / "good.obj").write_text(OBJ)
    if content is not None:
        (tmp_path / name).write_text(content)
    bodies = link('<mesh filename="good.obj"/>') + link(f'<mesh filename="{name}"/>', "b")
    path = robot_of(tmp_path, bodies + joint("", "fixed"))
    assert "; --missing leave-out imports the robot without it" in assert_refused(path, told)
    scene = imported(path, "--missing", "leave-out", warnings=told)
    assert [body.name for body in scene.objects] == ["a"] and len(scene.links) == 2


def test_a_robot_of_which_nothing_is_left_is_refused(tmp_path: Path) -> None:
    path = robot_of(tmp_path, link('<mesh filename="bad.stl"/>'))
    assert_refused(path, "no link has a collision geometry", "--missing", "leave-out")


XACRO = {
    "a name": LINKS.replace('"a"', '"${ns}a"'),
    "a number": link('<box size="${w} 0.1 0.1"/>'),
    "a path": link('<mesh filename="$(find arm)/a.stl"/>'),
    "a macro": LINKS + '<xacro:arm prefix="left"/>',
    "a macro in a link": '<link name="a"><xacro:body/></link>',
    "a property": '<xacro:property name="ns" value=""/>' + LINKS,
}


def with_xacro(folder: Path, text: str) -> Path:
    path = robot_of(folder, text)
    path.write_text(path.read_text().replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'))
    return path


@pytest.mark.parametrize("text", XACRO.values(), ids=XACRO)
def test_what_xacro_has_to_expand_is_told(tmp_path: Path, text: str) -> None:
    told = "it is written in xacro and has to be expanded first: xacro arm.urdf > robot.urdf"
    assert_refused(with_xacro(tmp_path, text), told)


def test_what_xacro_has_expanded_is_read(tmp_path: Path) -> None:
    """Its namespace stays, and so may its forms in what no scene needs. A file of another ending is told to be expanded."""
    path = with_xacro(tmp_path, LINKS + joint("") + '<gazebo><plugin file="$(find x)/${y}"/></gazebo>')
    assert len(imported(path).objects) == 2
    assert_refused(path.rename(tmp_path / "arm.urdf.xacro"), "xacro makes URDF of it")


THIRD = f'<link name="c"><collision>{BOX}</collision></link>'
BESIDE = f'<link name="x"><collision>{BOX}</collision></link><link name="y"/>'


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (THIRD + joints("ac", "bc", "ab"), '"c": has two parents, "a" by joint "ac" and "b" by joint "bc"'),
        (THIRD + joints("ab", "bc", "ca"), 'the links "a", "c", "b" are each other\'s parents, in a circle'),
        (BESIDE + joints("ab", "xy", "yx"), 'the links "x", "y" are each other\'s parents, in a circle'),
    ],
)
def test_links_that_are_no_tree_are_named(tmp_path: Path, text: str, told: str) -> None:
    assert_refused(robot_of(tmp_path, LINKS + text), told)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        *(
            (("--joints", given), "--joints: ")
            for given in ("shoulder", "shoulder=", "shoulder=far", "=1", "shoulder=nan", "lift=0,lift=0", "lift=0,")
        ),
        (("--geometry", "inner"), "must be collision or visual"),
        (("--missing", "maybe"), "--missing: must be refuse or leave-out, not maybe"),
    ],
)  # fmt: skip
def test_wrong_options_are_refused(tmp_path: Path, options: tuple[str, str], told: str) -> None:
    robot = robot_in(tmp_path)
    done = fringe_import(robot, tmp_path / "scene.toml", *options)
    assert done.returncode == 2 and told in done.stderr and not (tmp_path / "scene.toml").exists()
