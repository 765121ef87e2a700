"""What the `fringe` program prints, where, and with which exit code."""

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

Command = Callable[..., "subprocess.CompletedProcess[str]"]

VACUUM_PERMITTIVITY = 8.8541878128e-12

PLATES = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]

[[object]]
name = "target"
shape = { type = "plate", size = [0.1, 0.1] }
translation = [0, 0, HEIGHT]
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A 10 cm sensor with a plate of the same size 2 cm in front of it."""
    path = tmp_path / "a scene.toml"
    path.write_text(PLATES.replace("HEIGHT", "0.02"))
    return path


@pytest.fixture
def touching(tmp_path: Path) -> Path:
    path = tmp_path / "touching.toml"
    path.write_text(PLATES.replace("HEIGHT", "0"))
    return path


def test_capacitance_as_json(fringe_command: Command, scene: Path) -> None:
    done = fringe_command("capacitance", scene, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    answer = json.loads(done.stdout)
    expected = VACUUM_PERMITTIVITY * 0.01 / 0.02  # epsilon A / d
    voltage = 5e-12 / (5e-12 + expected) * 2.5
    assert list(answer) == [
        *("format", "options", "answered_by", "reached", "seconds", "expected_seconds", "counts"),
        *("sensors", "readings", "remarks"),
    ]
    assert answer["options"] == {"method": "exact", "tolerance": 0}
    assert answer["counts"] == {
        "triangles_evaluated": 2,
        "triangles_lumped": 0,
        "triangles_skipped": 0,
        "triangles_reused": 0,
        "nodes_lumped": 0,
        "objects_evaluated": 1,
        "objects_skipped": 0,
        "objects_reused": 0,
    }
    assert answer["seconds"] > 0
    (sensor,) = answer["sensors"]
    assert set(sensor) == {"name", "total", "voltage", "delta_voltage", "contact", "objects"}
    assert sensor["name"] == "front"
    assert sensor["total"] == pytest.approx(expected, rel=1e-15)
    assert sensor["voltage"] == pytest.approx(voltage, rel=1e-15)
    assert sensor["delta_voltage"] == pytest.approx(2.5 - voltage, rel=1e-15)
    assert sensor["contact"] is False
    assert sensor["objects"] == [
        {
            "name": "target",
            "capacitance": sensor["total"],
            "error": None,
            "answered_by": "exact",
            "bound": 0,
            "skipped": False,
        }
    ]


def test_capacitance_as_table(fringe_command: Command, scene: Path) -> None:
    done = fringe_command("capacitance", scene)
    assert (done.returncode, done.stderr) == (0, "")
    assert "mutual" in done.stdout.splitlines()[0]
    assert "4.42709 pF" in done.stdout
    assert "1.32597 V" in done.stdout
    assert "method exact, tolerance 0, 2 triangles evaluated" in done.stdout


@pytest.mark.parametrize("method", ["exact", "split:0", "split:4", "gauss:8"])
def test_method(fringe_command: Command, scene: Path, method: str) -> None:
    answer = json.loads(fringe_command("capacitance", "--method", method, scene, "--json").stdout)
    assert answer["options"]["method"] == method
    # A parallel plate in front of the sensor has the same distance everywhere: every method is exact.
    assert answer["sensors"][0]["total"] == pytest.approx(VACUUM_PERMITTIVITY * 0.5, rel=1e-14)


def test_contact_is_an_infinite_number_in_json(fringe_command: Command, touching: Path) -> None:
    done = fringe_command("capacitance", touching, "--json")
    assert done.returncode == 0
    (sensor,) = json.loads(done.stdout)["sensors"]
    assert sensor["total"] == math.inf
    assert sensor["objects"][0]["capacitance"] == math.inf
    assert (sensor["contact"], sensor["voltage"], sensor["delta_voltage"]) == (True, 0, 2.5)
    table = fringe_command("capacitance", touching).stdout
    assert "sensor front (contact)" in table
    assert "inf pF  contact" in table


@pytest.fixture
def two_plates(tmp_path: Path) -> Path:
    """Two 5 cm × 10 cm plates at an angle, and an open sheet above them that shows them its back."""
    path = tmp_path / "two.toml"
    path.write_text(
        """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.05, 0, 0], edge_v = [0, 0.1, 0] },
           { corner = [0, -0.05, 0], edge_u = [0.04, 0, 0.03], edge_v = [0, 0.1, 0] } ]

[[object]]
name = "sheet"
shape = { type = "plate", size = [0.1, 0.1] }
translation = [-0.02, 0.01, 0.06]
"""
    )
    return path


def test_plates_count_every_point_or_the_nearest_ones(fringe_command: Command, two_plates: Path) -> None:
    def answer(*options: str) -> tuple[dict[str, object], float]:
        document = json.loads(fringe_command("capacitance", two_plates, "--json", *options).stdout)
        return document["options"], document["sensors"][0]["total"]

    options, nearest = answer("--method", "exact+nearest")
    assert options == {"method": "exact+nearest", "tolerance": 0}
    _, total = answer("--method", "exact")
    assert 0.5 * total < nearest < 0.9 * total
    _, by_centroids = answer("--method", "split:6+nearest")
    assert by_centroids == pytest.approx(nearest, rel=1e-4)


def test_faces(fringe_command: Command, two_plates: Path) -> None:
    command = ("capacitance", two_plates, "--json", "--method", "exact+facing")
    every = json.loads(fringe_command("capacitance", two_plates, "--json").stdout)["sensors"][0]["total"]
    assert (
        json.loads(fringe_command(*command).stdout)["sensors"][0]["total"] == every > 0
    ), "a plate has two sides"
    two_plates.with_name("sheet.obj").write_text("v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3 4\n")
    two_plates.write_text(
        two_plates.read_text().replace(
            'type = "plate", size = [0.1, 0.1]', 'type = "mesh", file = "sheet.obj"'
        )
    )
    ran = fringe_command(*command)
    done = json.loads(ran.stdout)
    assert done["options"]["method"] == "exact+facing"
    assert done["sensors"][0]["total"] == 0
    assert done["counts"]["triangles_evaluated"] == 0
    (remark,) = done["remarks"]
    assert ran.stderr == f"fringe: remark: {remark}\n"
    assert remark.startswith('sensor "front" sees only backs of the triangles of "sheet"')
    two_plates.write_text(two_plates.read_text() + "rotation = { axis = [1, 0, 0], degrees = 180 }\n")
    turned = json.loads(fringe_command(*command).stdout)["sensors"][0]["total"]
    every = json.loads(fringe_command("capacitance", two_plates, "--json").stdout)["sensors"][0]["total"]
    assert turned == every > 0


def test_tolerance_is_kept_and_said(fringe_command: Command, two_plates: Path) -> None:
    def sheet(tolerance: str) -> dict[str, float]:
        done = fringe_command(
            "capacitance", two_plates, "--json", "--method", "exact+nearest", "--tolerance", tolerance
        )
        document = json.loads(done.stdout)
        assert document["options"]["tolerance"] == float(tolerance)
        target: dict[str, float] = document["sensors"][0]["objects"][0]
        return target

    accurate, coarse = sheet("0"), sheet("1e-2")
    assert 0 < coarse["bound"] <= 1e-2 * accurate["capacitance"]
    assert abs(coarse["capacitance"] - accurate["capacitance"]) <= coarse["bound"]
    words = ("--method", "exact+nearest", "--tolerance", "1e-2")
    table = fringe_command("capacitance", two_plates, *words).stdout
    assert "wrong by at most" in table


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--method", "exact+all"), "method 'exact+all' is not known"),
        (("--tolerance", "nan"), "must be finite and not negative"),
        (("--tolerance", "small"), "tolerance"),
        (("--tolerance", "1e-6", "--method", "split:4"), "needs the method exact"),
    ],
)
def test_wrong_options(fringe_command: Command, scene: Path, options: tuple[str, ...], reason: str) -> None:
    done = fringe_command("capacitance", scene, "--json", *options)
    assert (done.returncode, done.stdout) == (2, "")
    assert reason in done.stderr


def test_info(fringe_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "box.toml"
    path.write_text(
        'object = [ { name = "box", shape = { type = "cuboid", size = [1, 2, 3] }, translation = [1, 0, 0] } ]'
    )
    done = fringe_command("info", path, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    answer = json.loads(done.stdout)
    assert answer["counts"] == {
        "links": 0,
        "sensors": 0,
        "distance_sensors": 0,
        "objects": 1,
        "triangles": 12,
    }
    (box,) = answer["objects"]
    assert box == {
        "name": "box",
        "triangles": 12,
        "area": pytest.approx(22, rel=1e-14),
        "volume": pytest.approx(6, rel=1e-14),
        "aabb": {"minimum": [0.5, -1, -1.5], "maximum": [1.5, 1, 1.5]},
        "defects": None,
    }
    assert "22 m2" in fringe_command("info", path).stdout


def test_info_counts_the_defects_of_a_mesh(fringe_command: Command, tmp_path: Path) -> None:
    (tmp_path / "sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\nf 1 1 2\n")
    path = tmp_path / "scene.toml"
    path.write_text('object = [ { name = "sheet", shape = { type = "mesh", file = "sheet.obj" } } ]')
    (sheet,) = json.loads(fringe_command("info", path, "--json").stdout)["objects"]
    found = {defect: count for defect, count in sheet["defects"].items() if count > 0}
    assert found == {"without_area": 1, "duplicates": 1, "open_edges": 3, "shells": 1}
    assert "1 duplicate triangles: each triangle counts once" in fringe_command("info", path).stdout


def test_info_knows_no_volume_of_an_open_surface(fringe_command: Command, scene: Path) -> None:
    assert json.loads(fringe_command("info", scene, "--json").stdout)["objects"][0]["volume"] is None


BODIES = """
[[link]]
name = "arm"
[[object]]
name = "ball"
link = "arm"
shape = { type = "sphere", radius = 0.1, segments = 16 }
[[object]]
name = "box"
shape = { type = "cuboid", size = [0.1, 0.1, 0.1] }
translation = [0.14, 0, 0]
[[object]]
name = "ring"
shape = { type = "arc", inner_radius = 0.3, outer_radius = 0.4, height = 0.1, degrees = 300, segments = 30 }
[[object]]
name = "air"
shape = { type = "cube", size = 1 }
collides = false
"""


def test_collide(fringe_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "bodies.toml"
    path.write_text(BODIES)
    done = fringe_command("collide", path, "--json")
    answer = json.loads(done.stdout)
    assert answer["remarks"][0].startswith('object "air" contains "ball", "box" and "ring": ')
    assert (done.returncode, done.stderr) == (0, f"fringe: remark: {answer['remarks'][0]}\n")
    assert answer["pairs"] == [
        {"a": "ball", "b": "box", "status": "collision"},
        {"a": "ball", "b": "ring", "status": "bounds"},
        {"a": "box", "b": "ring", "status": "bounds"},
    ]
    assert set(answer["tests"]) == {"broad", "narrow"}
    assert answer["tests"]["narrow"] >= 1
    table = fringe_command("collide", path).stdout
    assert "collision  ball and box" in table
    assert "bounds     ball and ring" in table


def test_collide_says_why_there_is_nothing_to_check(fringe_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    body = '[[link]]\nname = "{0}"\n{1}\n[[object]]\nname = "{0}"\nlink = "{0}"\nshape = {{ type = "cube", size = 1 }}\n'
    path.write_text(body.format("upper", "") + body.format("lower", 'parent = "upper"'))
    done = fringe_command("collide", path)
    assert done.stdout.startswith("nothing to check among 2 objects: not looked at are objects of one link")
    path.write_text(path.read_text() + "collides_with_parent = true\n")
    assert "collision  upper and lower" in fringe_command("collide", path).stdout


def test_remarks_are_printed_once_and_stand_in_every_answer(
    fringe_command: Command, tmp_path: Path, scene: Path
) -> None:
    path = tmp_path / "long.toml"
    path.write_text(
        scene.read_text() + '[[object]]\nname = "long"\nshape = { type = "cuboid", size = [50, 1, 1] }\n'
    )
    path.write_text(path.read_text() + "translation = [0, 0, -9]\n")
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
def test_wrong_usage(fringe_command: Command, scene: Path, arguments: tuple[str, ...]) -> None:
    done = fringe_command(*(scene if argument == "SCENE" else argument for argument in arguments))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr


def test_wrong_input_names_file_line_key_and_reason(fringe_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text('[[object]]\nname = "o"\nshape = { type = "plate", size = [nan, 1] }\n')
    for command in ("capacitance", "info"):
        done = fringe_command(command, path, "--json")
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr == f'fringe: {path}:3: object "o": shape.size: must be finite\n'


@pytest.mark.parametrize("role", ['potential = "floating"', "material = { relative_permittivity = 50 }"])
def test_objects_that_are_not_grounded_are_refused(fringe_command: Command, scene: Path, role: str) -> None:
    scene.write_text(scene.read_text() + role + "\n")
    done = fringe_command("capacitance", scene, "--json")
    assert (done.returncode, done.stdout) == (2, "")
    assert '"target"' in done.stderr
    assert fringe_command("info", scene).returncode == 0


def test_an_answer_that_cannot_be_written_is_a_failure(scene: Path) -> None:
    program = Path(__file__).resolve().parents[2] / "build" / "bin" / "fringe"
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(
            [program, "info", scene], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 1
    assert "written" in done.stderr
