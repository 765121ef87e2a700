"""From which distance a probe is noticed: the changes against boundary elements, the distances, and what the command writes."""

import csv
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from analysis.coverage import findings, survey as surveys
from analysis.coverage.distances import COLUMNS, Curves
from analysis.coverage.machine import Machine, Reading, respond
from analysis.coverage.places import DEFAULT, Places, probe, spread
from analysis.pipeline.model_stage import model_module
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.shapes import Cuboid
from tests import scenes
from tests.programs import analysis

MACHINE = (
    scenes.SENSOR
    + scenes.body("housing", "cuboid", size=[0.12, 0.12, 0.1], translation=[0, 0, -0.07])
    + scenes.body("cable", "cube", size=0.02, translation=[0.1, 0, 0], potential="floating")
    + scenes.body("hand", "cube", size=0.05, translation=[0, 0, 0.1], target=True)
    + scenes.table("reading", name="self", sense="front", drive=["front"], threshold=20e-15)
)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("coverage") / "machine.toml"
    file.write_text(MACHINE)
    return file


@pytest.fixture(scope="module")
def machine(path: Path) -> Machine:
    machine = Machine(surveys.at_rest(path, reader.load(path), model_module()), 1.0)
    chance = np.random.default_rng(1)
    machine.prepare([0.01, 0.02, 0.09] + chance.uniform(-0.06, 0.06, size=(400, 3)) * [1, 1, 0.5])
    return machine


def change(machine: Machine, name: str, at: list[float], to_ground: float | None = None) -> float:
    """The change of the reading by a probe at a place 4 cm or more from the machine, upright."""
    level = respond(probe(name), model_module()).level(0.04)
    found, clears = machine.changes(level, np.eye(3)[None], np.array([at]), to_ground)
    assert clears.all()
    return float(found[0, 0])


@pytest.mark.parametrize("to_ground", [None, 0.0, 3e-12], ids=["grounded", "floating", "through 3 pF"])
def test_the_change_by_a_probe_is_that_of_boundary_elements(
    path: Path, machine: Machine, to_ground: float | None
) -> None:
    name, at = "box:0.06:0.04:0.03", [0.01, 0.02, 0.09]
    live = surveys.at_rest(path, reader.load(path), model_module())
    live.add(surveys.described(probe(name), to_ground))
    live.set_pose(surveys.LINK, np.array(at))
    true = live.readings(method="boundary-elements", rtol=1e-3)["self"]
    assert true.error["change"] < 2e-3 * true.change
    assert change(machine, name, at, to_ground) == pytest.approx(true.change, rel=1e-2)


def test_a_body_around_the_probe_changes_the_reading_more(machine: Machine) -> None:
    names = ("sphere:0.02", "box:0.042:0.042:0.042", "sphere:0.04")
    inner, between, outer = (change(machine, name, [0.0, 0.0, 0.08]) for name in names)
    assert inner < between < outer


def test_a_power_law_is_met_where_it_is() -> None:
    distances = np.geomspace(0.01, 1, 9)
    changes = 1e-15 * np.tile(distances**-2, (3, 1))
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
    floor = scenes.body("floor", "cuboid", size=[0.4, 0.4, 0.02], translation=[0, 0, -0.01])
    wall = scenes.body("wall", "cuboid", size=[0.02, 0.4, 0.1], translation=[0.01, 0, 0.05])
    points = np.array([[-0.01, 0, 0], [-0.05, 0, 0]])
    two = Places(points, np.tile([0.0, 0, 1], (2, 1)), ("floor",) * 2, np.full(2, np.inf))
    response = respond(probe("box:0.04:0.04:0.04"), model_module())
    way = surveys.approach(
        response, two, np.array([0.01, 0.05, 0.2]), model_module().Scene.loads(floor + wall)
    )
    np.testing.assert_array_equal(way.fits, [[False] * 3, [True] * 3])


@pytest.mark.parametrize(
    "text", ["sphere", "sphere:-1", "box:1:2", "capsule:a:1", "nose", "mesh:nowhere.stl"]
)
def test_a_probe_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        probe(text)


@pytest.mark.parametrize("name", DEFAULT)
def test_named_probes_stand_for_themselves_by_few_points(name: str) -> None:
    """Far away a single capacitance is left, and it is that of the solution with all panels."""
    response = respond(probe(name), model_module())
    own = [float(np.linalg.inv(level.inverse).sum()) for level in response.levels]
    # Solid harmonics up to the quadrupoles are nine.
    assert len(response.levels[-1].points) <= 9
    assert own[-1] == pytest.approx(own[1], rel=5e-3)


@pytest.mark.night
def test_the_command_makes_page_table_and_file_from_its_options(path: Path, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    few = ["--probe", "sphere:0.02", "--probe", "fist", "--grid", "0.06", "--reading", "self"]
    asked = ["coverage", path, *few, "--output", target]
    assert "fist: noticed at" in analysis(*asked, "--method", "small-probe").stdout
    text = target.read_text()
    assert "small-probe" in text and "https://" not in text.split("<script", maxsplit=1)[0]
    rows = list(csv.DictReader(target.with_suffix(".csv").open()))
    assert tuple(rows[0]) == COLUMNS
    assert {row["reading"] for row in rows} == {"self", "any"}
    assert {row["probe"] for row in rows} == {"sphere:0.02", "fist"}
    mesh = meshio.read(target.with_suffix(".vtu"))
    assert len(mesh.points) * 4 == len(rows) and "fist any" in mesh.point_data

    def before_the_sensor(rows: list[dict[str, str]]) -> float:
        own = [row for row in rows if row["on"] == "front" and row["kind"] == "noticed"]
        return sum(float(row["distance_m"]) for row in own)

    for option, value in (("--threshold", "5e-15"), ("--potential", "floating")):
        analysis(*asked, "--method", "none", option, value)
        others = list(csv.DictReader(target.with_suffix(".csv").open()))
        assert (before_the_sensor(others) > before_the_sensor(rows)) == (option == "--threshold")


def test_an_unknown_reading_is_refused(path: Path) -> None:
    told = analysis("coverage", path, "--reading", "other", status=2).stderr
    assert "'other' is none of self" in told


def test_what_the_model_refuses_is_told_with_the_scene(path: Path, tmp_path: Path) -> None:
    touching = tmp_path / "touching.toml"
    touching.write_text(path.read_text().replace("-0.07", "-0.05"))
    told = analysis("coverage", touching, "--probe", "sphere:0.02", status=2).stderr
    assert f"analysis: {touching}: sensor" in told


def survey_of(places: Places, threshold: float, changes: Any, **more: Any) -> surveys.Survey:
    """A survey by a fist at five distances from 1 cm to 1 m, whose changes of one reading are given."""
    given = {"compared": np.arange(0), "by_method": {}, "panels": 0, "error": 0.0} | more
    readings, distances = (Reading("self", 1.0, None, True),), np.geomspace(0.01, 1, 5)
    return surveys.Survey(
        readings, (threshold,), places, distances, (probe("fist"),), (changes / distances[:, None],), **given
    )


def test_findings_count_places_and_compare_methods() -> None:
    """Three places: noticed, blind, blocked."""
    places = spread({"box": Cuboid((1.0, 1.0, 1.0)).triangles()}, frozenset(), 1.5)
    changes = np.array([1e-14, 1e-18, np.nan])[:, None, None] * np.ones((3, 5, 1))
    twice = {"double": (2 * changes / np.geomspace(0.01, 1, 5)[:, None],)}
    survey = survey_of(places, 1e-13, changes, compared=np.arange(3), by_method=twice)
    (told,) = findings.noticed(survey)
    assert (told.held, told.noticed) == (2, 1) and told.median == pytest.approx(0.1)
    (compared,) = findings.comparisons(survey)
    assert (compared.excess, compared.ratio, compared.false) == (pytest.approx(0.1), pytest.approx(2), 0)


def test_claims_count_places_on_sensors_nearby_and_before_the_middle_of_plates(path: Path) -> None:
    scene = reader.load(path)
    conductors = {name: scene.conductors()[name] for name in ("front", "housing")}
    places = spread(conductors, frozenset(["front"]), 0.01)
    x, y, _ = np.abs(places.points.T)
    on_plate = np.array(places.owners) == "front"
    is_middle = on_plate & (np.maximum(x, y) < 0.05 / 3)
    survey = survey_of(places, 2e-14, np.where(is_middle, 1e-18, 1e-14)[:, None, None])
    middle, margin = findings.on_plates(scene, survey, 0)
    assert (middle.held, middle.noticed) == (is_middle.sum(), 0) and margin.share == 1
    assert "the blind spot is there" in findings.centre_sentence(scene, survey)
    before, beside, farther = findings.around(scene, survey, 0)
    assert before.held == on_plate.sum() and before.noticed == on_plate.sum() - is_middle.sum()
    assert beside.held + farther.held == (~on_plate).sum() and beside.share == 1
    assert "it does not hold for fist" in findings.nearby_sentence(scene, survey)
    even = survey_of(places, 2e-14, np.full((len(x), 1, 1), 1e-14))
    assert "no blind spot at the centre" in findings.centre_sentence(scene, even)
    assert "it holds for fist" in findings.nearby_sentence(scene, even)
