"""What a new user tries on the first day, mistakes included: the right answer, or a message by which one knows what to do next."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from geometries.scene.shapes import Cuboid
from tests.waiting import DEADLINE

ROOT = Path(__file__).parents[2]
FRINGE = ROOT / "build" / "bin" / "fringe"
PLATE = "{ corner = [-0.02, -0.03, 0], edge_u = [0.04, 0, 0], edge_v = [0, 0.06, 0] }"
SENSOR = f"""[[sensor]]
name = "s"
plates = [ {PLATE} ]
"""
HAND = """[[object]]
name = "hand"
shape = { type = "cuboid", size = [0.08, 0.1, 0.02] }
translation = [0, 0, 0.06]
"""
MESH_HAND = HAND.replace('type = "cuboid", size = [0.08, 0.1, 0.02]', 'type = "mesh", file = "hand.stl"')
BLOCK = np.array(Cuboid((0.08, 0.1, 0.02)).triangles())
TRUTH = ("--method", "boundary-elements", "--rtol", "1e-2")


class Place:
    """A folder of one's own, in which the command is run."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def run(self, *words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [FRINGE, *words], cwd=self.folder, capture_output=True, text=True, check=False, timeout=DEADLINE
        )

    def write(self, scene: str, name: str = "scene.toml") -> str:
        (self.folder / name).write_text(scene, encoding="utf-8")
        return name

    def stl(self, triangles: np.ndarray, name: str = "hand.stl") -> None:
        facets = [
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in triangle)
            + "endloop\nendfacet\n"
            for triangle in triangles
        ]
        (self.folder / name).write_text("solid hand\n" + "".join(facets) + "endsolid hand\n")

    def remarks(self, scene: str, *words: str) -> str:
        """Runs `fringe capacitance`, which must answer, and returns its remarks as one text; standard error has each of them once."""
        answer = self.run("capacitance", self.write(scene), "--json", *words)
        assert answer.returncode == 0, answer.stderr
        found = json.loads(answer.stdout)["remarks"]
        for remark in found:
            assert answer.stderr.count(remark) == 1
        return "\n".join(found)

    def total(self, scene: str, *words: str) -> float:
        """Returns the model's capacitance of the first sensor (pF)."""
        answer = self.run("capacitance", self.write(scene), "--json", *words)
        assert answer.returncode == 0, answer.stderr
        return 1e12 * float(json.loads(answer.stdout)["sensors"][0]["total"])

    def own(self, scene: str) -> float:
        """Returns the sensor's own capacitance (pF) by boundary elements."""
        answer = self.run("capacitance", self.write(scene), "--json", *TRUTH)
        assert answer.returncode == 0, answer.stderr
        return 1e12 * float(json.loads(answer.stdout)["maxwell"][0][0])

    def refusal(self, scene: str, *words: str) -> str:
        """Runs `fringe capacitance`, which must refuse the scene by name, and returns why."""
        answer = self.run("capacitance", self.write(scene), *words)
        assert answer.returncode == 2 and answer.stdout == ""
        assert answer.stderr.startswith("fringe: scene.toml")
        return answer.stderr


@pytest.fixture
def place(tmp_path: Path) -> Place:
    return Place(tmp_path)


def test_a_mesh_in_millimetres_is_remarked_on(place: Place) -> None:
    place.stl(1000 * BLOCK + (0, 0, 100))
    assert 'is it in millimetres? Then write units = "mm"' in place.remarks(SENSOR + MESH_HAND)
    scaled = MESH_HAND.replace('"hand.stl"', '"hand.stl", scale = 0.001').replace("0.06]", "-0.04]")
    assert place.remarks(SENSOR + scaled) == ""
    assert place.total(SENSOR + scaled) == pytest.approx(place.total(SENSOR + HAND), rel=1e-6)


def test_plates_in_millimetres_are_remarked_on_and_a_key_says_so(place: Place) -> None:
    plate = "{ corner = [-20, -30, 0], edge_u = [40, 0, 0], edge_v = [0, 60, 0] }"
    hand = HAND.replace("[0.08, 0.1, 0.02]", "[80, 100, 20]").replace("0.06]", "60]")
    scene = SENSOR.replace(PLATE, plate) + hand
    assert "millimetres" in place.remarks(scene)
    assert place.remarks('units = "mm"\n' + scene) == ""
    assert place.total('units = "mm"\n' + scene) == pytest.approx(place.total(SENSOR + HAND), rel=1e-12)


def test_a_mesh_inside_out_is_remarked_on(place: Place) -> None:
    place.stl(BLOCK[:, ::-1])
    assert "its triangles face inwards" in place.remarks(SENSOR + MESH_HAND)
    assert place.total(SENSOR + MESH_HAND) == pytest.approx(place.total(SENSOR + HAND), rel=1e-6)


def test_shells_that_cross_are_counted(place: Place) -> None:
    place.stl(np.concatenate([BLOCK, BLOCK + (0.04, 0.05, 0.01)]))
    told = place.run("info", place.write(SENSOR + MESH_HAND)).stdout
    assert (
        "pairs of triangles that cross or touch" in told
        and "2 separate parts: they are one conductor" in told
    )
    assert place.own(SENSOR + MESH_HAND) > place.own(SENSOR + HAND)


def test_an_open_surface_is_told_and_answered(place: Place) -> None:
    place.stl(BLOCK[:-1])
    told = place.run("info", place.write(SENSOR + MESH_HAND)).stdout
    assert "volume     none: open surface" in told and "3 open edges" in told
    assert place.total(SENSOR + MESH_HAND) < place.total(SENSOR + HAND)


@pytest.mark.parametrize(
    ("extra", "remark"),
    [(BLOCK[0], "triangles that repeat others: 1"), (BLOCK[0][[0, 0, 1]], "triangles without area: 1")],
    ids=["a_triangle_twice", "a_triangle_without_area"],
)
def test_needless_triangles_are_left_out(place: Place, extra: np.ndarray, remark: str) -> None:
    place.stl(BLOCK)
    clean = place.total(SENSOR + MESH_HAND), place.own(SENSOR + MESH_HAND)
    place.stl(np.concatenate([BLOCK, extra[None]]))
    assert remark in place.remarks(SENSOR + MESH_HAND)
    assert (place.total(SENSOR + MESH_HAND), place.own(SENSOR + MESH_HAND)) == pytest.approx(clean, rel=1e-12)


@pytest.mark.parametrize("ending", [".dae", ".step", ".3mf"])
def test_files_of_other_programs_are_refused_with_what_to_use(place: Place, ending: str) -> None:
    told = place.refusal(SENSOR + MESH_HAND.replace("hand.stl", f"hand{ending}"))
    assert "must be .stl, .obj or .ply" in told and "fringe import" in told


def test_an_obj_file_with_all_that_programs_write_is_read(place: Place) -> None:
    vertices = "".join(f"v {x} {y} {z} 0.5 0.5 0.5\n" for x, y, z in BLOCK.reshape(-1, 3))
    faces = "".join(f"f {3 * n + 1}//1 {3 * n + 2}//1 {3 * n + 3}//1\n" for n in range(len(BLOCK)))
    (place.folder / "hand.obj").write_text(
        f"mtllib hand.mtl\no hand\n{vertices}vn 0 0 1\nusemtl skin\n{faces}l 1 2\n"
    )
    scene = SENSOR + MESH_HAND.replace("hand.stl", "hand.obj")
    assert place.total(scene) == pytest.approx(place.total(SENSOR + HAND), rel=1e-12)


def test_capitals_and_other_systems_lines_are_read(place: Place) -> None:
    place.stl(BLOCK)
    text = (place.folder / "hand.stl").read_bytes().replace(b"\n", b"\r\n")
    (place.folder / "HAND.STL").write_bytes(text)
    scene = (SENSOR + MESH_HAND.replace("hand.stl", "HAND.STL")).replace("\n", "\r\n")
    (place.folder / "scene.toml").write_bytes(scene.encode())
    answer = place.run("capacitance", "scene.toml", "--json")
    assert answer.returncode == 0, answer.stderr


def test_a_round_plate_is_told_that_plates_are_rectangles(place: Place) -> None:
    told = place.refusal(SENSOR.replace(PLATE, "{ centre = [0, 0, 0], radius = 0.02 }") + HAND)
    assert "a plate is a rectangle with corner, edge_u and edge_v" in told


def test_rectangles_of_six_digits_are_squared(place: Place) -> None:
    cad = (
        "{ corner = [-0.02, -0.03, 0], edge_u = [0.034287, 0.020602, 0], edge_v = [-0.030902, 0.051431, 0] }"
    )
    assert "off the right angle and are squared" in place.remarks(SENSOR.replace(PLATE, cad) + HAND)
    told = place.refusal(SENSOR.replace("[0.04, 0, 0]", "[0.04, 0.0001, 0]") + HAND)
    assert "89.8568 degrees" in told and "0.0001" in told


@pytest.mark.parametrize("rotation", ["{ rpy = [0, 0, 1] }", "{ axis = [0, 0, 1], radians = 1 }"])
def test_other_forms_of_a_rotation_are_named_with_those_that_are_known(place: Place, rotation: str) -> None:
    told = place.refusal(SENSOR + HAND + f"rotation = {rotation}\n")
    wrong = "rpy" if "rpy" in rotation else "radians"
    assert f"rotation.{wrong}: is not a known key" in told and "axis" in told and "degrees" in told


def test_names_in_any_language_stay_apart_in_tables(place: Place) -> None:
    scene = SENSOR + HAND.replace('"hand"', "'Hand \"links\", 左手'")
    table = place.run("capacitance", place.write(scene), *TRUTH).stdout
    (head,) = [line for line in table.splitlines() if "左手" in line and "±" not in line]
    assert head.split()[0] == "s" and "s " in head


def test_a_mesh_of_many_triangles_is_simplified(place: Place) -> None:
    own = {}
    for segments in (24, 200):
        ball = HAND.replace(
            '"cuboid", size = [0.08, 0.1, 0.02]', f'"sphere", radius = 0.05, segments = {segments}'
        )
        scene = place.write(SENSOR + ball.replace("0.06]", "0.1]"))
        answer = place.run("capacitance", scene, "--json", *TRUTH)
        own[segments] = np.array(json.loads(answer.stdout)["maxwell"])
    # The coarse ball is an inscribed polyhedron, 1 % smaller; 40,000 triangles are more than boundary elements take as they are.
    assert np.abs(own[200] / own[24] - 1).max() < 0.03


def test_scenes_in_which_something_is_missing(place: Place) -> None:
    assert place.total(SENSOR) == 0
    assert "the scene has no sensor" in place.remarks(HAND)
    assert "a scene needs at least one sensor or object" in place.refusal("")


def test_contact_is_told(place: Place) -> None:
    touching = SENSOR + HAND.replace("0.06]", "0.01]")
    answer = place.run("capacitance", place.write(touching))
    assert answer.returncode == 0 and "contact" in answer.stdout
    assert "touch or cross" in place.refusal(touching, *TRUTH)


def test_a_target_inside_another_body_is_remarked_on(place: Place) -> None:
    arm = (
        HAND.replace('"hand"', '"arm"')
        .replace("[0.08, 0.1, 0.02]", "[0.3, 0.3, 0.3]")
        .replace("0.06]", "0.2]")
    )
    hand = HAND.replace("0.06]", "0.2]") + "target = true\n"
    assert '"hand"' in place.remarks(SENSOR + arm + hand) and '"arm"' in place.remarks(SENSOR + arm + hand)


def test_folders_with_spaces_and_other_letters_are_read(place: Place) -> None:
    inner = Place(place.folder / "mes scènes 左")
    inner.folder.mkdir()
    inner.stl(BLOCK)
    inner.write(SENSOR + MESH_HAND)
    answer = place.run("capacitance", f"{inner.folder.name}/scene.toml", "--json")
    assert answer.returncode == 0 and json.loads(answer.stdout)["sensors"]


def test_a_closed_pipe_ends_the_command_silently(place: Place) -> None:
    name = place.write(SENSOR + HAND)
    script = f'"{FRINGE}" capacitance {name} --json | true; echo "${{PIPESTATUS[0]}}"'
    ended = subprocess.run(
        ["bash", "-c", script], cwd=place.folder, capture_output=True, text=True, check=True
    )
    assert ended.stderr == "" and ended.stdout.strip() in ("0", "141")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("capacitance", "scene.toml", "--methd", "exact"), "--methd"),
        (("capacitance", "scene.toml", "--method", "bem"), "boundary-elements"),
        (("capacitance", "scene.toml", "--method", "best"), "auto"),
        (("capacity", "scene.toml"), "capacity"),
    ],
)
def test_typing_errors_are_told_with_the_choices(place: Place, words: tuple[str, ...], told: str) -> None:
    place.write(SENSOR + HAND)
    answer = place.run(*words)
    assert answer.returncode != 0 and answer.stdout == "" and told in answer.stderr
