"""`fringe export`: a scene's conductors as a list of FastCap, its Maxwell matrix as a SPICE subcircuit and as a table."""

import csv
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.pipeline import model_stage
from tests import scenes
from tests.end_to_end.importing import fringe_import
from tests.programs import fringe_command
from tests.scenes import GUARDED_SENSOR

# A sensor of two plates before a guard, a hand of two bodies that touch, and a floating foil.
SCENE = (
    "medium = { relative_permittivity = 1.5 }\n"
    + scenes.sensor(
        "front", [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.04, 0]], [[-0.05, 0.01, 0], [0.1, 0, 0], [0, 0.04, 0]]
    )
    + scenes.body("guard, left", "plate", size=[0.12, 0.12], translation=[0, 0, -0.01], potential="electrode")
    + scenes.link("arm", translation=[0, 0, 0.06])
    + scenes.body("palm", "cuboid", size=[0.08, 0.1, 0.02], link="arm")
    + scenes.body("finger", "cuboid", size=[0.02, 0.06, 0.02], link="arm", translation=[0, 0.08, 0])
    + scenes.body("tip", "cone", radius=0.01, height=0.02, segments=3, translation=[0.2, 0, 0])
)
FOIL = scenes.body("foil", "plate", size=[0.05, 0.05], translation=[0, 0, -0.05], potential="floating")
# Of plates and boxes, whose matrix takes milliseconds.
PLAIN = GUARDED_SENSOR.replace("guard", "guard, left") + (
    scenes.body("palm", "cuboid", size=[0.08, 0.1, 0.02], translation=[0, 0, 0.06])
)


@pytest.fixture
def plain(tmp_path: Path) -> Path:
    path = tmp_path / "plain.toml"
    path.write_text(PLAIN + FOIL)
    return path


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE + FOIL)
    return path


def matrix_of(scene: Path) -> dict[str, Any]:
    return dict(model_stage.model_module().Scene.load(str(scene)).maxwell(rtol=1e-2))


def test_a_list_has_a_file_for_every_body_and_a_group_for_every_conductor(scene: Path) -> None:
    done = fringe_command("export", scene, scene.with_name("machine.lst"))
    assert (done.returncode, done.stderr) == (0, ""), done
    assert "5 conductors, 22 panels in 6 files beside it" in done.stdout
    assert scene.with_name("machine.lst").read_text().splitlines()[1:] == [
        "* front: sensor",
        "C machine_front.qui 1.5 0 0 0",
        "* guard, left: electrode",
        "C machine_guard__left.qui 1.5 0 0 0",
        "* palm: grounded",
        "C machine_palm.qui 1.5 0 0 0 +",
        "C machine_finger.qui 1.5 0 0 0",
        "* tip: grounded",
        "C machine_tip.qui 1.5 0 0 0",
        "* foil: floating",
        "C machine_foil.qui 1.5 0 0 0",
    ]
    assert scene.with_name("machine_front.qui").read_text().splitlines() == [
        "0 front, in m",
        "Q front -0.05 -0.05 0 0.05 -0.05 0 0.05 -0.010000000000000002 0 -0.05 -0.010000000000000002 0",
        "Q front -0.05 0.01 0 0.05 0.01 0 0.05 0.05 0 -0.05 0.05 0",
    ]
    # Both bodies have the name of their conductor, in the frame of the world.
    finger = scene.with_name("machine_finger.qui").read_text().splitlines()
    assert len(finger) == 7 and all(line.startswith("Q palm ") for line in finger[1:])
    assert [float(word) for word in finger[1].split()[2:5]] == pytest.approx([-0.01, 0.05, 0.05])
    assert [line.split()[:2] for line in scene.with_name("machine_tip.qui").read_text().splitlines()[1:]] == [
        ["T", "tip"]
    ] * 6


def test_names_in_a_list_are_plain_and_differ(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    body = '[[object]]\nname = "{}"\nshape = {{ type = "sphere", radius = 0.1, segments = 3 }}\ntranslation = [{}, 0, 0]\n'
    names = ("left arm", "Left_arm", "left-arm", "é", "n" * 600)
    scene.write_text("".join(body.format(name, k) for k, name in enumerate(names)))
    assert fringe_command("export", scene, tmp_path / "my list.lst").returncode == 0
    lines = (tmp_path / "my list.lst").read_text().splitlines()
    files = [line.split()[1] for line in lines if line.startswith("C ")]
    assert files[:4] == [
        "my_list_left_arm.qui",
        "my_list_Left_arm_2.qui",
        "my_list_left-arm.qui",
        "my_list___.qui",
    ]
    conductors = [(tmp_path / file).read_text().splitlines()[1].split()[1] for file in files]
    assert conductors[:4] == ["left_arm", "Left_arm_2", "left-arm", "__"]
    # FasterCap reads lines of 512 letters.
    assert all(len(line) < 512 for file in files for line in (tmp_path / file).read_text().splitlines()[1:])


def test_a_mesh_is_without_duplicates_and_triangles_without_area(tmp_path: Path) -> None:
    """They would make the matrix of a solver singular."""
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    (tmp_path / "soup.obj").write_text(corners + "f 1 2 3\nf 1 2 2\nf 3 1 2\nf 1 2 4\n")
    scene = tmp_path / "scene.toml"
    scene.write_text('[[object]]\nname = "soup"\nshape = { type = "mesh", file = "soup.obj", scale = 0.1 }\n')
    assert "1 conductors, 2 panels in 1 files" in fringe_command("export", scene, tmp_path / "x.lst").stdout
    panels = (tmp_path / "x_soup.qui").read_text().splitlines()[1:]
    assert panels == ["T soup 0 0 0 0.1 0 0 0 0.1 0", "T soup 0 0 0 0.1 0 0 0 0 0.1"]


def test_what_is_exported_and_imported_has_the_same_matrix(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(PLAIN)
    assert fringe_command("export", scene, tmp_path / "list/scene.lst").returncode == 0
    assert fringe_import(tmp_path / "list/scene.lst", tmp_path / "again.toml").returncode == 0
    before, after = matrix_of(scene), matrix_of(tmp_path / "again.toml")
    assert after["conductors"] == ["front", "guard__left", "palm"]
    difference = np.abs(np.subtract(before["maxwell"], after["maxwell"]))
    assert (difference <= np.add(before["error"], after["error"])).all()


def capacitors_of(file: Path) -> tuple[list[str], Any]:
    """The nodes of a subcircuit, and the matrix of its capacitances: row and column 0 are the ground's."""
    lines = [line.split() for line in file.read_text().splitlines() if not line.startswith("*")]
    assert lines[0][0] == ".subckt" and lines[-1] == [".ends"]
    nodes = ["0", *lines[0][2:]]
    matrix = np.zeros((len(nodes), len(nodes)))
    for name, a, b, capacitance in lines[1:-1]:
        assert name.startswith("C")
        i, j, value = nodes.index(a), nodes.index(b), float(capacitance)
        matrix[[i, j], [i, j]] += value
        matrix[[i, j], [j, i]] -= value
    return nodes, matrix


def test_the_capacitors_of_a_circuit_are_the_matrix(plain: Path) -> None:
    """That ngspice agrees with it is shown by the tests of the function that writes it."""
    target = plain.with_name("machine.cir")
    done = fringe_command("export", plain, target, "--rtol", "1e-2")
    assert (done.returncode, done.stderr) == (0, ""), done
    nodes, capacitances = capacitors_of(target)
    assert nodes == ["0", "front", "guard__left"]
    text = target.read_text()
    assert ".subckt machine front guard__left\n" in text
    for comment in ("floating: foil", "node 0: palm", "node guard__left: guard, left"):
        assert f"* {comment}\n" in text
    assert "* front and palm, stated error " in text
    assert capacitances[1:, 1:] == pytest.approx(np.array(matrix_of(plain)["maxwell"])[:2, :2], rel=1e-12)


def test_the_table_is_the_matrix_with_its_errors(plain: Path) -> None:
    assert fringe_command("export", plain, plain.with_name("machine.csv"), "--rtol", "1e-2").returncode == 0
    with plain.with_name("machine.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    answer = matrix_of(plain)
    names = answer["conductors"]
    assert [(row["row"], row["column"]) for row in rows] == [(a, b) for a in names for b in names]
    assert [float(row["value_F"]) for row in rows] == list(np.ravel(answer["maxwell"]))
    assert [float(row["error_F"]) for row in rows] == list(np.ravel(answer["error"]))


def test_the_method_and_the_error_asked_for_are_the_users(plain: Path) -> None:
    """An error that is not reached ends with status 3, and with the file that says so."""
    near = plain.with_name("near.toml")
    near.write_text(PLAIN.replace("-0.03]", "-0.001]"))
    target = plain.with_name("x.cir")
    for scene, options, status, told in (
        (plain, ["--method", "reduced", "--rtol", "1e-3"], 0, "reduced, rtol 0.001 reached"),
        (plain, ["--rtol", "0.03"], 0, "boundary-elements, rtol 0.03 reached"),
        (near, ["--method", "reduced", "--rtol", "1e-4"], 3, "reduced, rtol 0.0001 NOT reached"),
    ):
        done = fringe_command("export", scene, target, *options)
        assert done.returncode == status and ("was not reached" in done.stderr) == (status == 3), done
        assert target.read_text().startswith(f"* Maxwell matrix by {told}\n")


DIELECTRIC = FOIL.replace('potential = "floating"', "material = { relative_permittivity = 3 }")
ROOM = "[room]\nsize = [4, 4, 4]\n"


@pytest.mark.parametrize(
    ("more", "target", "options", "told"),
    [
        ("", "x.txt", [], "x.txt: must end in .lst, .cir or .csv"),
        ("", "x", [], "x: must end in .lst, .cir or .csv"),
        (DIELECTRIC, "x.lst", [], 'scene.toml: object "foil" is dielectric'),
        (DIELECTRIC, "x.cir", [], 'scene.toml: object "foil" is dielectric'),
        (ROOM, "x.lst", [], "scene.toml: has a room"),
        (ROOM, "x.csv", [], "scene.toml: "),
        (FOIL.replace("-0.05]", "-0.01]"), "x.lst", [], 'object "foil"'),
        (FOIL.replace("foil", "tip"), "x.lst", [], '"tip"'),
        ("", "x.lst", ["--rtol", "1e-2"], "--method and --rtol are options for .cir and .csv"),
        ("", "x.cir", ["--method", "exact"], "exact finds no Maxwell matrix: boundary-elements, reduced and auto do"),
        ("", "x.cir", ["--method", "magic"], "magic"),
        ("", "x.csv", ["--rtol", "7"], "rtol"),
    ],
)  # fmt: skip
def test_what_cannot_be_exported_is_refused(
    tmp_path: Path, more: str, target: str, options: list[str], told: str
) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE + more)
    done = fringe_command("export", scene, tmp_path / "new" / target, *options)
    assert (done.returncode, done.stdout) == (2, "") and told in done.stderr, done
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == [scene]


def test_a_scene_of_grounded_conductors_is_no_circuit(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text('[[object]]\nname = "ball"\nshape = { type = "cube", size = 0.1 }\n')
    done = fringe_command("export", scene, tmp_path / "x.cir")
    assert done.returncode == 2 and "scene.toml: all conductors are grounded" in done.stderr
    # The command tries the file before it computes, so that this error comes first.
    done = fringe_command("export", scene, Path("/proc/x.cir"))
    assert done.returncode == 1 and "/proc/x.cir: cannot be written" in done.stderr


def test_files_are_written_whole_or_not_at_all(scene: Path) -> None:
    """Files of before are replaced; where one cannot be, none is."""
    target = scene.with_name("machine.lst")
    target.write_text("of before")
    blocked = scene.with_name("machine_foil.qui")
    blocked.mkdir()
    before = sorted(scene.parent.iterdir())
    done = fringe_command("export", scene, target)
    assert done.returncode == 1 and f"{blocked}: cannot be written" in done.stderr
    assert sorted(scene.parent.iterdir()) == before and target.read_text() == "of before"
    blocked.rmdir()
    assert fringe_command("export", scene, target).returncode == 0
    assert target.read_text() != "of before"


def test_a_folder_that_cannot_be_made_is_told(scene: Path) -> None:
    scene.with_name("taken").write_text("")
    done = fringe_command("export", scene, scene.with_name("taken") / "x.lst")
    assert done.returncode == 1 and "the folder cannot be made" in done.stderr
    assert sorted(os.listdir(scene.parent)) == ["scene.toml", "taken"]
