"""`fringe import` of robots as they are found: what no scene needs does not matter, and one bad mesh need not stop the rest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from geometries.scene.shapes import Cuboid, Disc, PlateShape
from tests.end_to_end.importing import assert_refused, fringe_import, imported

BOX = '<geometry><box size="0.1 0.1 0.1"/></geometry>'
LINKS = "".join(f'<link name="{name}"><collision>{BOX}</collision></link>' for name in "ab")


def robot(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "arm.urdf"
    path.write_text(
        f'<?xml version="1.0" encoding="{encoding}"?>\n<robot name="r">{text}</robot>', encoding=encoding
    )
    return path


def joint(more: str, kind: str = "revolute") -> str:
    return (
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>{more}</joint>'
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
    "mass without inertia": (f'<link name="a"><inertial><mass value="0"/></inertial><collision>{BOX}</collision></link>', ""),
    "line ends between numbers": (link('<box size="0.1\n0.1\t0.1"/>'), ""),
}  # fmt: skip


@pytest.mark.parametrize(("text", "told"), UNNEEDED.values(), ids=UNNEEDED)
def test_what_no_scene_needs_does_not_matter(tmp_path: Path, text: str, told: str) -> None:
    scene = imported(robot(tmp_path, text), warnings=told)
    assert [body.shape for body in scene.objects] == [Cuboid((0.1, 0.1, 0.1))] * text.count("<box")


def test_limits_of_positions_stay(tmp_path: Path) -> None:
    def limits(more: str) -> tuple[float | None, float | None]:
        moved = imported(robot(tmp_path, LINKS + joint(more))).links[1].joint
        assert moved is not None
        return moved.lower, moved.upper

    assert limits('<limit lower="-1" upper="2"/>') == (-1, 2)
    assert limits("") == (None, None)


def test_the_version_of_the_format_and_its_encoding_do_not_matter(tmp_path: Path) -> None:
    path = robot(tmp_path, LINKS + joint(""), "utf-16")
    assert len(imported(path).objects) == 2
    path.write_text(f'<robot name="r" version="2.5">{LINKS}{joint("")}</robot>')
    assert len(imported(path).objects) == 2


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
    path = robot(tmp_path, link('<box size="1 2 3"/>') + link(body, "b") + joint("", "fixed"))
    scene = imported(path, warnings=f'link "b": {body[1:].split()[0]}: has no size, and is left out')
    assert [link.name for link in scene.links] == ["a", "b"]
    assert [body.name for body in scene.objects] == ["a"]


@pytest.mark.parametrize(("size", "span"), [("2 3 0", (2, 3, 0)), ("2 0 3", (2, 0, 3)), ("0 2 3", (0, 2, 3))])
def test_a_box_without_thickness_is_a_plate(tmp_path: Path, size: str, span: tuple[float, ...]) -> None:
    body = f'<link name="a"><collision><origin xyz="5 6 7"/><geometry><box size="{size}"/></geometry></collision></link>'
    scene = imported(robot(tmp_path, body))
    assert isinstance(scene.objects[0].shape, PlateShape)
    (found,) = scene.conductors().values()
    assert np.ptp(found, axis=(0, 1)) == pytest.approx(span, abs=1e-15)
    assert (found.min(axis=(0, 1)) + found.max(axis=(0, 1))) / 2 == pytest.approx([5, 6, 7])


def test_a_cylinder_without_height_is_a_disc(tmp_path: Path) -> None:
    scene = imported(robot(tmp_path, link('<cylinder radius="0.2" length="0"/>')))
    assert scene.objects[0].shape == Disc(0.2)


OBJ = b"v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"
POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:0000\nsize 684\n"
# The mesh that a robot names, its content, and what the matter is.
BAD_MESHES = {
    "missing": ("bad.stl", None, "there is no file"),
    "empty": ("bad.stl", b"", "it is empty"),
    "zeros": ("bad.stl", bytes(80), "it holds nothing but zeros"),
    "pointer instead of STL": ("bad.stl", POINTER, "it is a pointer of Git LFS"),
    "pointer instead of OBJ": ("bad.obj", POINTER, "it is a pointer of Git LFS"),
    "pointer instead of COLLADA": ("bad.dae", POINTER, "it is a pointer of Git LFS"),
    "pointer instead of 3MF": ("bad.3mf", POINTER, "it is a pointer of Git LFS"),
    "pointer instead of glTF": ("bad.glb", POINTER, "it is a pointer of Git LFS"),
    "damaged": ("bad.obj", OBJ[:-4], "fewer than three vertices"),
    "of a package": ("package://other/bad.stl", None, "was not found"),
    "on the web": ("https://example.com/a.stl", None, "is on the web; only files of this computer are read"),
    "of another address": ("model://arm/a.stl", None, "none of the addresses that are read"),
    "of another format": ("bad.fbx", b"Kaydara", "must end in .stl"),
}


@pytest.mark.parametrize(("name", "content", "told"), BAD_MESHES.values(), ids=BAD_MESHES)
def test_one_bad_mesh_is_told_and_stops_the_rest_only_if_it_shall(
    tmp_path: Path, name: str, content: bytes | None, told: str
) -> None:
    (tmp_path / "good.obj").write_bytes(OBJ)
    if content is not None:
        (tmp_path / name).write_bytes(content)
    path = robot(
        tmp_path,
        link('<mesh filename="good.obj"/>') + link(f'<mesh filename="{name}"/>', "b") + joint("", "fixed"),
    )
    assert_refused(path, told)
    assert_refused(path, "; --missing leave-out imports the robot without it", "--missing", "refuse")
    done = fringe_import(path, tmp_path / "scene.toml", "--missing", "leave-out")
    assert done.returncode == 0 and told in done.stderr
    scene = imported(path, "--missing", "leave-out", warnings='arm.urdf: link "b": mesh: ')
    assert [body.name for body in scene.objects] == ["a"] and len(scene.links) == 2


def test_a_robot_of_which_nothing_is_left_is_refused(tmp_path: Path) -> None:
    path = robot(tmp_path, link('<mesh filename="bad.stl"/>'))
    assert_refused(path, "no link has a collision geometry", "--missing", "leave-out")


@pytest.mark.parametrize("suffix", [".urdf", ".dae", ".obj", ".3mf", ".glb", ".gltf", ".step", ".lst"])
def test_files_without_their_content_are_told(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"model{suffix}"
    for content, told in (
        (b"", "it is empty"),
        (POINTER, "it is a pointer of Git LFS, whose content has to be fetched"),
    ):
        path.write_bytes(content)
        assert_refused(path, f"model{suffix}: {told}")


XACRO = {
    "a name": LINKS.replace('"a"', '"${ns}a"'),
    "a number": link('<box size="${w} 0.1 0.1"/>'),
    "a path": link('<mesh filename="$(find arm)/a.stl"/>'),
    "a macro": LINKS + '<xacro:arm prefix="left"/>',
    "a macro in a link": '<link name="a"><xacro:body/></link>',
    "a property": '<xacro:property name="ns" value=""/>' + LINKS,
}


@pytest.mark.parametrize("text", XACRO.values(), ids=XACRO)
def test_what_xacro_has_to_expand_is_told(tmp_path: Path, text: str) -> None:
    path = robot(tmp_path, text)
    path.write_text(path.read_text().replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'))
    assert_refused(path, "it is written in xacro and has to be expanded first: xacro arm.urdf > robot.urdf")
    assert_refused(path.rename(tmp_path / "arm.urdf.xacro"), "xacro makes URDF of it")


def test_what_xacro_has_expanded_is_read(tmp_path: Path) -> None:
    """Its namespace stays, and so may its forms in what no scene needs."""
    path = robot(tmp_path, LINKS + joint("") + '<gazebo><plugin file="$(find x)/${y}"/></gazebo>')
    path.write_text(path.read_text().replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'))
    assert len(imported(path).objects) == 2


def joints(*pairs: str) -> str:
    return "".join(
        f'<joint name="{a}{b}" type="fixed"><parent link="{a}"/><child link="{b}"/></joint>' for a, b in pairs
    )


def test_links_that_are_no_tree_are_named(tmp_path: Path) -> None:
    links = LINKS + f'<link name="c"><collision>{BOX}</collision></link>'
    assert_refused(
        robot(tmp_path, links + joints("ac", "bc", "ab")),
        'link "c": has two parents, "a" by joint "ac" and "b" by joint "bc"',
    )
    assert_refused(
        robot(tmp_path, links + joints("ab", "bc", "ca")),
        'the links "a", "c", "b" are each other\'s parents, in a circle',
    )
    beside = f'<link name="x"><collision>{BOX}</collision></link><link name="y"/>'
    assert_refused(
        robot(tmp_path, LINKS + beside + joints("ab", "xy", "yx")),
        'the links "x", "y" are each other\'s parents, in a circle',
    )
