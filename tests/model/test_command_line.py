"""What the `fringe` program prints, where, and with which exit code."""

import csv
import json
import math
import os
import resource
import subprocess
from pathlib import Path

import fringe
import numpy as np
import pytest

from geometries.scene.shapes import Cuboid
from tests import scenes
from tests.programs import FRINGE, ROOT, fringe_command


STATING = ("reduced", "boundary-elements", "auto")

# A 10 cm sensor with a plate of the same size 2 cm in front of it.
SCENE = scenes.SENSOR + scenes.body("target", "plate", size=[0.1, 0.1], translation=[0, 0, 0.02])


def test_capacitance_as_table(scene: Path) -> None:
    done = fringe_command("capacitance", scene)
    assert (done.returncode, done.stderr) == (0, "")
    assert "mutual" in done.stdout.splitlines()[0]
    assert "4.42709 pF" in done.stdout
    assert "1.32597 V" in done.stdout
    assert "method exact, tolerance 0, 2 triangles evaluated" in done.stdout


@pytest.mark.parametrize("method", ["exact", "formula", "auto"])
def test_contact_is_told_in_one_way(scene: Path, method: str) -> None:
    scene.write_text(SCENE.replace("0.02", "0"))
    asked = ("capacitance", scene, "--method", method)
    document = json.loads(fringe_command(*asked, "--json").stdout)
    (reading,), (sensor,) = document["readings"], document["sensors"]
    assert (reading["change"], reading["error"]["change"]) == (math.inf, 0)
    assert (sensor["total"], sensor["contact"], sensor["voltage"]) == (math.inf, True, 0)
    table = fringe_command(*asked).stdout
    assert "sensor front (contact)" in table and table.split()[-1] == "inf"
    scene.with_suffix(".motion.toml").write_text('[[frame]]\nname = "there"\n')
    (row,) = csv.DictReader(fringe_command("sweep", *asked[1:]).stdout.splitlines())
    assert (row["change_F"], row["change_error_F"]) == ("inf", "0")
    assert "change inf pF, by" in repr(fringe.Scene.load(scene).readings(method)["front"])


def test_a_tolerance_is_said_and_what_it_costs(tmp_path: Path) -> None:
    """Of two 5 cm × 10 cm plates at an angle, and an open sheet above them that shows them its back."""
    plates = [[-0.05, -0.05, 0], [0.05, 0, 0], [0, 0.1, 0]], [[0, -0.05, 0], [0.04, 0, 0.03], [0, 0.1, 0]]
    sheet = scenes.body("sheet", "plate", size=[0.1, 0.1], translation=[-0.02, 0.01, 0.06])
    path = tmp_path / "two.toml"
    path.write_text(scenes.sensor("front", *plates) + sheet)
    words = ("capacitance", path, "--method", "exact+nearest", "--tolerance", "1e-2")
    document = json.loads(fringe_command(*words, "--json").stdout)
    assert document["options"]["tolerance"] == 1e-2
    (sheet,) = document["sensors"][0]["objects"]
    assert 0 < sheet["bound"] <= 1e-2 * sheet["capacitance"]
    assert "wrong by at most" in fringe_command(*words).stdout


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--tolerance", "nan"), "must be finite and not negative"),
        (("--tolerance", "small"), "tolerance"),
        (("--tolerance", "1e-6", "--method", "split:4"), "needs the method exact"),
    ],
)
def test_wrong_options(scene: Path, options: tuple[str, ...], reason: str) -> None:
    done = fringe_command("capacitance", scene, "--json", *options)
    assert (done.returncode, done.stdout) == (2, "")
    assert reason in done.stderr


def test_auto_is_asked_where_an_accuracy_is_and_else_the_model(scene: Path) -> None:
    for options, method in (((), "exact"), (("--rtol", "0.05"), "auto")):
        document = json.loads(fringe_command("capacitance", scene, "--json", *options).stdout)
        assert document["options"]["method"] == method
    loaded = fringe.Scene.load(scene)
    assert loaded.capacitance()["options"]["method"] == "exact"
    assert loaded.capacitance(rtol=0.05)["options"] == {"method": "auto", "rtol": 0.05}
    (reading,) = loaded.readings().values()
    assert reading.answered_by in STATING and reading.error["change"] <= 1e-2 * reading.change


def test_an_unknown_method_is_refused_with_the_choices(scene: Path) -> None:
    answer = fringe_command("capacitance", scene, "--method", "magic")
    assert answer.returncode == 2 and answer.stdout == ""
    assert all(name in answer.stderr for name in ("split:N", "gauss:K", "formula", *STATING))
    with pytest.raises(fringe.InputError, match="formula"):
        fringe.Scene.load(scene).capacitance("magic")
    with pytest.raises(TypeError, match='no keyword "magic"'):
        fringe.Scene.load(scene).capacitance(magic=1)


def test_info(tmp_path: Path) -> None:
    path = tmp_path / "box.toml"
    path.write_text(scenes.body("box", "cuboid", size=[1, 2, 3], translation=[1, 0, 0]))
    done = fringe_command("info", path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "22 m2" in done.stdout and "6 m3" in done.stdout


HAND = np.array(Cuboid((0.08, 0.1, 0.02)).triangles())


def with_hand(scene: Path, triangles: np.ndarray) -> Path:
    """A scene of the sensor and a mesh of these triangles before it."""
    scene.with_name("hand.obj").write_text(scenes.obj(triangles))
    path = scene.with_name("hand.toml")
    path.write_text(scenes.SENSOR + scenes.body("hand", "mesh", file="hand.obj", translation=[0, 0, 0.06]))
    return path


def test_info_tells_what_a_mesh_is_not(scene: Path) -> None:
    told = fringe_command("info", with_hand(scene, np.concatenate([HAND, HAND + (0.04, 0.05, 0.01)]))).stdout
    assert "pairs of triangles that cross or touch" in told
    assert "2 separate parts: they are one conductor" in told
    open_and_twice = with_hand(scene, np.concatenate([HAND[:-1], HAND[:1], HAND[:1, [0, 0, 1]]]))
    told = fringe_command("info", open_and_twice).stdout
    assert "volume     none: open surface" in told and "3 open edges" in told
    assert "1 duplicate triangles: each triangle counts once" in told
    (hand,) = json.loads(fringe_command("info", open_and_twice, "--json").stdout)["objects"]
    found = {defect: count for defect, count in hand["defects"].items() if count > 0}
    assert found == {"without_area": 1, "duplicates": 1, "open_edges": 3, "shells": 1}


BODIES = (
    scenes.link("arm")
    + scenes.body("ball", "sphere", radius=0.1, segments=16, link="arm")
    + scenes.body("box", "cuboid", size=[0.1, 0.1, 0.1], translation=[0.14, 0, 0])
    + scenes.body("ring", "arc", inner_radius=0.3, outer_radius=0.4, height=0.1, degrees=300, segments=30)
    + scenes.body("air", "cube", size=1, collides=False)
)


def test_collide(tmp_path: Path) -> None:
    path = tmp_path / "bodies.toml"
    path.write_text(BODIES)
    done = fringe_command("collide", path)
    assert done.returncode == 0
    assert done.stderr.startswith('fringe: remark: object "air" contains "ball", "box" and "ring": ')
    assert "collision  ball and box" in done.stdout
    assert "bounds     ball and ring" in done.stdout


def test_collide_says_why_there_is_nothing_to_check(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    links = scenes.link("upper") + scenes.link("lower", parent="upper")
    path.write_text(
        links + "".join(scenes.body(name, "cube", size=1, link=name) for name in ("upper", "lower"))
    )
    done = fringe_command("collide", path)
    assert done.stdout.startswith("nothing to check among 2 objects: not looked at are objects of one link")
    path.write_text(path.read_text() + "collides_with_parent = true\n")
    assert "collision  upper and lower" in fringe_command("collide", path).stdout


def test_remarks_are_printed_once_and_stand_in_every_answer(tmp_path: Path, scene: Path) -> None:
    path = tmp_path / "long.toml"
    path.write_text(
        scene.read_text() + scenes.body("long", "cuboid", size=[50, 1, 1], translation=[0, 0, -9])
    )
    path.with_suffix(".motion.toml").write_text("[[frame]]\n[[frame]]\n")
    for command in ("capacitance", "collide", "sense", "info", "sweep"):
        done = fringe_command(command, path, *(["--json"] if command != "sweep" else []))
        assert done.returncode == 0
        assert done.stderr.count('fringe: remark: object "long" is 50 m long: is it in millimetres?') == 1
        if command != "sweep":
            assert json.loads(done.stdout)["remarks"][0].startswith('object "long" is 50 m long')


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("collapse",),
        ("capacitance",),
        ("capacitance", "SCENE", "--tolerance"),
        ("info", "SCENE", "--entries"),
        ("capacitance", "SCENE", "SCENE"),
        ("capacitance", "SCENE", "--method"),
        ("info", "SCENE", "--method", "exact"),
        ("collide",),
        ("sense",),
        ("sense", "SCENE", "--tolerance", "0"),
    ],
)
def test_wrong_usage(scene: Path, arguments: tuple[str, ...]) -> None:
    done = fringe_command(*(scene if argument == "SCENE" else argument for argument in arguments))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr


@pytest.mark.parametrize("ending", [".dae", ".step", ".3mf"])
def test_meshes_of_other_programs_are_refused_with_what_to_use(scene: Path, ending: str) -> None:
    path = with_hand(scene, HAND)
    path.write_text(path.read_text().replace("hand.obj", f"hand{ending}"))
    told = fringe_command("capacitance", path).stderr
    assert "must be .stl, .obj or .ply" in told and "fringe import" in told


def test_names_in_any_language_stay_apart_in_tables(scene: Path) -> None:
    scene.write_text(scene.read_text().replace('"target"', "'Hand \"links\", 左手'"))
    table = fringe_command("capacitance", scene, "--method", "boundary-elements", "--rtol", "1e-2").stdout
    (head,) = [line for line in table.splitlines() if "左手" in line and "±" not in line]
    assert head.split()[0] == "front" and "front " in head


def test_a_closed_pipe_ends_the_command_silently(scene: Path) -> None:
    script = f'"{FRINGE}" capacitance "{scene}" --json | true; echo "${{PIPESTATUS[0]}}"'
    ended = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert ended.stderr == "" and ended.stdout.strip() in ("0", "141")


def test_an_answer_that_cannot_be_written_is_a_failure(scene: Path) -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run([FRINGE, "info", scene], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1
    assert "written" in done.stderr


def one_core_with_little_memory() -> None:
    """Limits this process; each thread on another core would reserve an address space of its own."""
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    resource.setrlimit(resource.RLIMIT_AS, (120 * 2**20, 120 * 2**20))


def test_too_little_memory_is_told() -> None:
    scene = ROOT / "geometries" / "scenes" / "x_ray_arm.toml"
    words = [FRINGE, "capacitance", scene, "--method", "boundary-elements"]
    done = subprocess.run(words, capture_output=True, text=True, preexec_fn=one_core_with_little_memory)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "fringe: there is not enough memory\n"
