"""Files for other programs: the triangles with their capacitances, and the charges of surfaces."""

import json
import math
from pathlib import Path

import meshio
import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from tests import scenes
from tests.programs import fringe_command


# Everything is moved, so that a frame that is mistaken for another one shows.
SCENE = (
    scenes.link("arm", translation=[0.3, 0.1, 0.2], rotation={"axis": [1, 1, 0], "degrees": 40})
    + scenes.sensor(
        'a "quoted" <name> & more',
        [[-0.05, -0.05, 0], [0.05, 0, 0], [0, 0.1, 0]],
        [[0, -0.05, 0], [0.04, 0, 0.03], [0, 0.1, 0]],
        link="arm",
    )
    + scenes.sensor("back", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.body("ball", "sphere", radius=0.03, segments=9, link="arm", translation=[0, 0, 0.1])
    + scenes.body(
        "box",
        "cuboid",
        size=[0.1, 0.2, 0.05],
        translation=[0.1, 0.3, 0.4],
        rotation={"axis": [0, 0, 1], "degrees": 20},
    )
)
SENSORS = ['a "quoted" <name> & more', "back"]


@pytest.mark.parametrize(
    "options", [[], ["--method", "split:2"], ["--method", "exact+nearest"], ["--method", "exact+facing"]]
)
def test_the_triangles_of_an_object_add_up_to_its_capacitance(scene: Path, options: list[str]) -> None:
    target = scene.with_name("shares.vtu")
    done = fringe_command("capacitance", scene, "--json", *options, "--output", target)
    assert done.returncode == 0
    found = meshio.read(target)
    (block,) = found.cells
    (body,) = found.cell_data["body"]
    assert block.type == "triangle" and set(found.cell_data) == {
        "body",
        *(f"capacitance {n}" for n in SENSORS),
    }
    for sensor in json.loads(done.stdout)["sensors"]:
        (shares,) = found.cell_data[f"capacitance {sensor['name']}"]
        assert not shares[body <= len(SENSORS)].any()
        for number, part in enumerate(sensor["objects"], len(SENSORS) + 1):
            assert shares[body == number].sum() == pytest.approx(part["capacitance"], rel=1e-12)
    assert not list(scene.parent.glob(".*"))


def test_the_triangles_are_where_the_conductors_are(scene: Path) -> None:
    import fringe

    target = scene.with_name("shares.vtu")
    assert fringe_command("capacitance", scene, "--output", target).returncode == 0
    found = meshio.read(target)
    corners, (body,) = found.points[found.cells_dict["triangle"]], found.cell_data["body"]
    for number, triangles in enumerate(fringe.Scene.load(str(scene)).conductors().values(), 1):
        np.testing.assert_array_equal(corners[body == number], triangles)


def test_a_triangle_in_contact_is_infinite_and_the_others_are_not(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    back = scenes.sensor("back", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    path.write_text(back + scenes.body("box", "cube", size=0.02, translation=[0.02, 0.02, 0.01]))
    assert fringe_command("capacitance", path, "--output", tmp_path / "shares.vtu").returncode == 0
    ((shares,),) = [meshio.read(tmp_path / "shares.vtu").cell_data["capacitance back"]]
    # The base, and the sides' lower triangles, which have an edge on the plate.
    assert np.isinf(shares).sum() == 2 + 4 and (shares[~np.isinf(shares)] >= 0).all()
    assert shares.max() == math.inf


def test_more_triangles_than_are_evaluated_at_once_come_in_their_order(scene: Path) -> None:
    scene.write_text(SCENE.replace("segments = 9", "segments = 150"))
    target = scene.with_name("shares.vtu")
    done = fringe_command("capacitance", scene, "--json", "--output", target)
    found = meshio.read(target)
    (body,), (shares,) = found.cell_data["body"], found.cell_data["capacitance back"]
    assert (body == 3).sum() > 2 * 4096
    ball = json.loads(done.stdout)["sensors"][1]["objects"][0]["capacitance"]
    assert shares[body == 3].sum() == pytest.approx(ball, rel=1e-12)
    # ε∫dA/d of a small triangle is ε times its area over its distance.
    corners = found.points[found.cells_dict["triangle"]][body == 3]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    middles = corners.mean(axis=1)
    distance = np.linalg.norm(middles - np.clip(middles, 0, [0.1, 0.1, 0]), axis=1)
    np.testing.assert_allclose(shares[body == 3], 8.8541878128e-12 * area / distance, rtol=1e-3)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--tolerance", "1e-3"], "--output cannot be combined with a tolerance"),
        (["--method", "formula"], "--output is an option of exact, split:N and gauss:K, not of formula"),
        (["--method", "boundary-elements"], "--output is an option of exact, split:N and gauss:K"),
        (["--output", "shares.txt"], "'shares.txt' does not end in .vtu"),
    ],
)
def test_what_would_have_no_meaning_is_refused(scene: Path, options: list[str], told: str) -> None:
    output = [] if "--output" in options else ["--output", scene.with_name("shares.vtu")]
    done = fringe_command("capacitance", scene, *options, *output)
    assert (done.returncode, done.stdout) == (2, "") and told in done.stderr
    assert list(scene.parent.iterdir()) == [scene]


def test_a_file_that_cannot_be_written_is_told_and_leaves_nothing(scene: Path) -> None:
    (scene.parent / "taken.vtu").mkdir()
    for target in (scene.parent / "missing" / "shares.vtu", scene.parent / "taken.vtu"):
        done = fringe_command("capacitance", scene, "--output", target)
        assert (done.returncode, done.stdout) == (1, "")
        assert done.stderr == f"fringe: {target}: cannot be written\n"
    assert {path.name for path in scene.parent.iterdir()} == {scene.name, "taken.vtu"}


TWO = scenes.body("ball", "sphere", radius=0.1, segments=24, potential="electrode") + scenes.body(
    "wall", "cube", size=0.05, translation=[0.3, 0, 0]
)


def test_the_potential_is_that_of_the_conductors_on_them_and_of_their_charge_far_away() -> None:
    fringe = model_module()
    found = fringe.Scene.loads(TWO).surface_charges(rtol=0.003, most_panels=3000)
    assert found["conductors"] == ["ball", "wall"] and found["error"] < 0.02
    charges = found["charges"][:, 0]
    points = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 50.0, 0.0]])
    means = fringe.triangle_potentials(points, found["panels"])
    assert means.dtype == np.float32
    potentials = means @ charges
    assert potentials[:2] == pytest.approx([1, 0], abs=6e-3)
    assert potentials[2] == pytest.approx(charges.sum() / 50, rel=1e-3)


def test_the_charges_have_the_potentials_asked_for_far_more_exactly_than_their_energies_need(
    sensor_before_a_housing: str,
) -> None:
    """The energies' error is the square of the charges', which decide about potentials far away."""
    fringe = model_module()
    rtol = 0.01
    found = fringe.Scene.loads(sensor_before_a_housing).surface_charges(rtol=rtol)
    potentials = fringe.single_layer(found["panels"], 1e-6) @ found["charges"][:, 0]
    errors = potentials - (np.array(found["conductor_of"]) == found["conductors"].index("front"))
    assert np.sqrt((errors**2).mean()) < 0.02 * rtol
