"""From which distance a probe is noticed: the changes against boundary elements, the distances, and what the command writes."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from analysis import __main__ as command_line
from analysis.coverage import claims, findings, response as responses, survey as surveys, tables
from analysis.coverage.distances import Curves
from analysis.coverage.machine import Reading
from analysis.coverage.places import Places, spread
from analysis.coverage.probes import DEFAULT, probe
from analysis.pipeline.model_stage import model_module
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.shapes import Cuboid

MACHINE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
[[object]]
name = "housing"
shape = { type = "cuboid", size = [0.12, 0.12, 0.1] }
translation = [0, 0, -0.07]
[[object]]
name = "cable"
shape = { type = "cube", size = 0.02 }
translation = [0.1, 0, 0]
potential = "floating"
[[object]]
name = "hand"
shape = { type = "cube", size = 0.05 }
translation = [0, 0, 0.1]
target = true
[[reading]]
name = "self"
sense = "front"
drive = ["front"]
threshold = 20e-15
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("coverage") / "machine.toml"
    file.write_text(MACHINE)
    return file


@pytest.mark.parametrize("to_ground", [None, 0.0, 3e-12], ids=["grounded", "floating", "through 3 pF"])
def test_the_change_by_a_probe_is_that_of_boundary_elements(path: Path, to_ground: float | None) -> None:
    model, scene = model_module(), reader.load(path)
    live = surveys.at_rest(path, scene, model)
    machine = surveys.machine_of(live, scene, model, surveys.Options())
    translation = np.array([0.01, 0.02, 0.09])
    machine.prepare(translation + np.random.default_rng(1).uniform(-0.06, 0.06, size=(400, 3)) * [1, 1, 0.5])
    held = probe("box:0.06:0.04:0.03")
    level = responses.respond(held, model).level(0.05)
    found, clears = responses.changes(machine, level, np.eye(3)[None], translation[None], to_ground)
    live.add(surveys.text_of(held, to_ground))
    live.set_pose(surveys.LINK, translation)
    true = live.readings(method="boundary-elements", rtol=1e-3)["self"]
    assert clears.all() and true.error["change"] < 2e-3 * true.change
    assert found[0, 0] == pytest.approx(true.change, rel=1e-2)


def test_a_body_around_the_probe_changes_the_reading_more(path: Path) -> None:
    model, scene = model_module(), reader.load(path)
    machine = surveys.machine_of(surveys.at_rest(path, scene, model), scene, model, surveys.Options())
    at = np.array([[0.0, 0.0, 0.08]])
    machine.prepare(at)
    changes = [
        responses.changes(
            machine, responses.respond(probe(name), model).level(0.04), np.eye(3)[None], at, None
        )[0]
        for name in ("sphere:0.02", "box:0.042:0.042:0.042", "sphere:0.04")
    ]
    assert changes[0] < changes[1] < changes[2]


def test_a_power_law_is_met_where_it_is() -> None:
    distances = np.geomspace(0.01, 1, 9)
    changes = 1e-15 * np.array([[d**-2] * 1 for d in distances]).T.repeat(3, axis=0)
    changes[1] *= 1e-6
    changes[2, 4:] = np.nan
    curves = Curves(distances, changes)
    found, is_last = curves.noticed(1e-15 * 0.3**-2)
    np.testing.assert_allclose(found, [0.3, 0, distances[3]], rtol=1e-12)
    np.testing.assert_array_equal(is_last, [False, False, True])
    blocked, _ = Curves(distances, np.full((1, 9), np.nan)).noticed(1.0)
    assert np.isnan(blocked).all()


def test_a_smooth_curve_is_met_between_the_distances_of_a_survey() -> None:
    """From one power law to another, as before a sensor on a housing: within 0.5 % of the distance."""
    distances = np.geomspace(surveys.NEAREST, surveys.FARTHEST, surveys.COUNT)

    def change(distance: Any) -> Any:
        return 1e-17 / ((distance + 0.02) * (distance + 0.1) ** 3)

    curves = Curves(distances, change(distances)[None])
    cut = Curves(distances, np.where(distances > 0.3, np.nan, change(distances))[None])
    for distance in (0.007, 0.013, 0.05, 0.12, 0.24, 0.6):
        assert curves.noticed(change(distance))[0][0] == pytest.approx(distance, rel=5e-3)
        if distance < 0.2:
            assert cut.noticed(change(distance))[0][0] == pytest.approx(distance, rel=2e-2)


def test_a_curve_that_does_not_fall_stays_between_its_points() -> None:
    distances = np.geomspace(surveys.NEAREST, surveys.FARTHEST, surveys.COUNT)
    changes = np.full((1, surveys.COUNT), 1e-14)
    changes[0, 4:] = 1e-16
    found, _ = Curves(distances, changes).noticed(0.99e-14)
    assert distances[3] <= found[0] <= distances[4]


def test_places_lie_outside_with_the_way_that_is_free() -> None:
    lower = Cuboid((1.0, 1.0, 1.0)).triangles()
    conductors = {"lower": lower, "upper": lower + [0.3, 0.0, 0.9], "ceiling": lower + [0.3, 0.0, 3.0]}
    places = spread(conductors, frozenset(), 0.1)
    x, y, z = places.points.T
    inside_upper = (abs(x - 0.3) < 0.499) & (abs(y) < 0.499) & (abs(z - 0.9) < 0.499)
    inside_lower = (abs(x) < 0.499) & (abs(y) < 0.499) & (abs(z) < 0.499)
    assert not (inside_upper | inside_lower).any()
    up = (places.normals[:, 2] > 0.5) & np.isclose(z, 1.4)
    assert up.sum() > 80
    np.testing.assert_allclose(places.free[up], 1.1, atol=1e-5)
    turned = places.rotations()
    np.testing.assert_allclose(np.linalg.det(turned), 1)
    np.testing.assert_allclose(turned[:, :, 2], places.normals)


def test_a_probe_that_would_reach_into_a_wall_does_not_fit_whatever_is_free_before_its_place() -> None:
    """A box of 4 cm on a floor, 1 cm and 5 cm from a wall of 10 cm."""
    floor, wall = (
        f'[[object]]\nname = "{name}"\nshape = {{ type = "cuboid", size = {size} }}\ntranslation = {at}\n'
        for name, size, at in (
            ("floor", [0.4, 0.4, 0.02], [0, 0, -0.01]),
            ("wall", [0.02, 0.4, 0.1], [0.01, 0, 0.05]),
        )
    )
    two = Places(
        np.array([[-0.01, 0, 0], [-0.05, 0, 0]]),
        np.tile([0.0, 0, 1], (2, 1)),
        ("floor",) * 2,
        np.full(2, np.inf),
    )
    distances = np.array([0.01, 0.05, 0.2])
    live = model_module().Scene.loads(floor + wall)
    np.testing.assert_array_equal(
        surveys.clear(probe("box:0.04:0.04:0.04"), two, distances, live), [[False] * 3, [True] * 3]
    )


@pytest.mark.parametrize(
    "text", ["sphere", "sphere:-1", "box:1:2", "capsule:a:1", "nose", "mesh:nowhere.stl"]
)
def test_a_probe_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        probe(text)


@pytest.mark.parametrize("name", DEFAULT)
def test_named_probes_stand_for_themselves_by_few_points(name: str) -> None:
    """Far away a single capacitance is left, and it is that of the solution with all panels."""
    response = responses.respond(probe(name), model_module())
    own = [float(np.linalg.inv(level.inverse).sum()) for level in response.levels]
    # Solid harmonics up to the quadrupoles are nine.
    assert len(response.levels[-1].points) <= 9
    assert own[-1] == pytest.approx(own[1], rel=5e-3)


@pytest.mark.night
def test_the_command_makes_page_table_and_file_from_its_options(
    path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "page.html"
    asked = [
        "coverage",
        str(path),
        "--probe",
        "sphere:0.02",
        "--probe",
        "fist",
        "--grid",
        "0.06",
        "--reading",
        "self",
    ]
    assert command_line.main([*asked, "--method", "small-probe", "--output", str(target)]) == 0
    assert "fist: noticed at" in capsys.readouterr().out
    text = target.read_text()
    assert "small-probe" in text and "https://" not in text.split("<script", maxsplit=1)[0]
    rows = list(csv.DictReader(target.with_suffix(".csv").open()))
    assert tuple(rows[0]) == tables.COLUMNS
    assert {row["reading"] for row in rows} == {"self", "any"} and {row["probe"] for row in rows} == {
        "sphere:0.02",
        "fist",
    }
    mesh = meshio.read(target.with_suffix(".vtu"))
    assert len(mesh.points) * 4 == len(rows) and "fist any" in mesh.point_data
    front = [float(row["distance_m"]) for row in rows if row["on"] == "front" and row["kind"] == "noticed"]
    for option, value in (("--threshold", "5e-15"), ("--potential", "floating")):
        assert command_line.main([*asked, "--method", "none", option, value, "--output", str(target)]) == 0
        others = csv.DictReader(target.with_suffix(".csv").open())
        changed = [
            float(row["distance_m"]) for row in others if row["on"] == "front" and row["kind"] == "noticed"
        ]
        assert (sum(changed) > sum(front)) == (option == "--threshold")


def test_an_unknown_reading_is_refused(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command_line.main(["coverage", str(path), "--reading", "other"]) == 2
    assert "'other' is none of self" in capsys.readouterr().err


def test_what_the_model_refuses_is_told_with_the_scene(
    path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    touching = tmp_path / "touching.toml"
    touching.write_text(path.read_text().replace("-0.07", "-0.05"))
    assert command_line.main(["coverage", str(touching), "--probe", "sphere:0.02"]) == 2
    assert f"analysis: {touching}: sensor" in capsys.readouterr().err


def test_findings_count_places_and_compare_methods() -> None:
    """Three places: noticed, blind, blocked."""
    distances = np.geomspace(0.01, 1, 5)
    changes = np.stack([1e-14 / distances, 1e-18 / distances, np.full(5, np.nan)])[..., None]
    survey: Any = surveys.Survey(
        (), (1e-13,), spread({"box": Cuboid((1.0, 1.0, 1.0)).triangles()}, frozenset(), 1.5), distances,
        (probe("fist"),), (changes,), np.arange(3), {"double": (2 * changes,)}, 0, 0.0,
    )  # fmt: skip
    (told,) = findings.summaries(survey)
    assert (told.held, told.noticed) == (2, 1) and told.median == pytest.approx(0.1)
    (compared,) = findings.comparisons(survey)
    assert (
        compared.excess == pytest.approx(0.1) and compared.ratio == pytest.approx(2) and compared.false == 0
    )


def test_claims_count_places_on_sensors_nearby_and_before_the_middle_of_plates(path: Path) -> None:
    scene = reader.load(path)
    conductors = scene.conductors()
    places = spread({name: conductors[name] for name in ("front", "housing")}, frozenset(["front"]), 0.01)
    distances = np.geomspace(0.01, 1, 5)
    x, y, _ = np.abs(places.points.T)
    on_plate = np.array(places.owners) == "front"
    is_middle = on_plate & (np.maximum(x, y) < 0.05 / 3)
    changes = np.where(is_middle[:, None], 1e-18, 1e-14) / distances
    reading = Reading("self", 1.0, None, True)
    survey: Any = surveys.Survey(
        (reading,), (2e-14,), places, distances, (probe("fist"),), (changes[..., None],), np.arange(0), {}, 0, 0.0,
    )  # fmt: skip
    middle, margin = claims.on_plates(scene, survey, 0)
    assert (middle.held, middle.noticed) == (is_middle.sum(), 0) and margin.share == 1
    assert "the blind spot is there" in claims.centre_sentence(scene, survey)
    before, beside, farther = claims.around(scene, survey, 0)
    assert before.held == on_plate.sum() and before.noticed == on_plate.sum() - is_middle.sum()
    assert beside.held + farther.held == (~on_plate).sum() and beside.share == 1
    assert "it does not hold for fist" in claims.nearby_sentence(scene, survey)
    even: Any = surveys.Survey(
        (reading,), (2e-14,), places, distances, (probe("fist"),),
        ((np.ones((len(x), 1)) * 1e-14 / distances)[..., None],), np.arange(0), {}, 0, 0.0,
    )  # fmt: skip
    assert "no blind spot at the centre" in claims.centre_sentence(scene, even)
    assert "it holds for fist" in claims.nearby_sentence(scene, even)
