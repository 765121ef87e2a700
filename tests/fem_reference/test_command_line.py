"""The command python3 -m fem_reference: exit statuses, messages, and the files it writes."""

import json
import subprocess
import sys
from pathlib import Path

import jsonschema
import meshio
import numpy as np
import pytest

from fem_reference.__main__ import main
from fem_reference.common.limits import Limits
from tests import scenes
from tests.programs import in_this_process

ROOT = Path(__file__).resolve().parents[2]
READING = scenes.table("reading", name="front", sense="front", drive=["front"])
SCENE = scenes.SENSOR + scenes.body("target", "plate", size=[0.06, 0.06], translation=[0.01, 0, 0.03])


def command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """The command as users start it."""
    words = [sys.executable, "-m", "fem_reference", *map(str, arguments)]
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)


def answered(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return in_this_process(main, *arguments)


@pytest.fixture
def centred(scene: Path) -> Path:
    """With its target before the sensor's centre, where a quarter of space is half the work."""
    scene.write_text(SCENE.replace("[0.01, 0, 0.03]", "[0, 0, 0.03]"))
    return scene


def test_json_is_one_document_with_the_whole_answer(centred: Path) -> None:
    done = command(centred, "--json", "--error", "estimate")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["error_kind"] == "estimate"
    assert found["conductors"] == ["front", "target"] and found["reached"] and found["rtol"] == 1e-3
    maxwell, error = np.array(found["maxwell"]), np.array(found["error"])
    np.testing.assert_allclose(np.array(found["upper"]) - found["lower"], 2 * error, rtol=1e-9)
    assert np.all(error <= 1e-3 * np.abs(maxwell))
    assert found["unknowns"] == found["levels"][-1]["unknowns"]
    assert 500 < found["memory_per_unknown"] < 50_000
    change = found["delta_self"]["front"]
    assert 0 < change["value"] < maxwell[0, 0] and change["error"] <= 1e-3 * change["value"]


@pytest.mark.night
def test_the_whole_of_space_is_meshed_when_symmetry_is_not_to_be_used(scene: Path) -> None:
    short = ("--json", "--error", "estimate", "--max-unknowns", "1000")
    half, whole = (json.loads(answered(scene, *short, *more).stdout) for more in ((), ("--no-symmetry",)))
    assert len(half["symmetry_planes"]) == 1 and whole["symmetry_planes"] == []
    assert whole["unknowns"] > 1.5 * half["unknowns"]
    np.testing.assert_allclose(half["maxwell"], whole["maxwell"], rtol=5e-3)


def test_an_estimate_of_one_mesh_is_between_its_bounds_and_not_accurate_enough(centred: Path) -> None:
    done = answered(centred, "--json", "--error", "estimate", "--max-unknowns", "1000")
    assert done.returncode == 3 and "asked 0.001, reached" in done.stderr
    found = json.loads(done.stdout)
    (first,) = found["levels"]
    assert found["contradicted"] is None and not found["reached"]
    lower, upper, value, error = (
        np.array(matrix)
        for matrix in (first["check"]["lower"], first["check"]["upper"], found["maxwell"], found["error"])
    )
    assert np.all(lower <= value) and np.all(value <= upper)
    assert np.all(error < (upper - lower) / 2)


@pytest.mark.night
def test_only_readings_may_be_asked_for(scene: Path) -> None:
    """The errors of the reading and its change are what counts, and no other entry's."""
    scene.write_text(scene.read_text() + READING)
    every, only = (
        json.loads(answered(scene, "--json", "--error", "estimate", "--max-unknowns", "1000", *more).stdout)
        for more in ((), ("--only-readings",))
    )
    (reading,) = only["readings"]
    relative = [reading["error"][kind] / abs(reading[kind]) for kind in ("value", "change")]
    assert (
        only["worst_relative_error"] == pytest.approx(max(relative)) and every["maxwell"] == only["maxwell"]
    )
    assert only["worst_relative_error"] <= every["worst_relative_error"]
    scene.write_text(SCENE)
    refused = answered(scene, "--only-readings", "--columns", "target")
    assert refused.returncode == 2 and "--only-readings" in refused.stderr


def test_the_first_limit_that_is_exceeded_is_named() -> None:
    limits = Limits(seconds=60, unknowns=1000, memory=2**30)
    assert limits.exceeded_by(60, 1000, 2**30) is None and Limits().exceeded_by(1e9, 1e9, 1e18) is None
    assert "end after 60 s" in str(limits.exceeded_by(61, 1001, 2**31))
    assert "more than 1000 unknowns" in str(limits.exceeded_by(60, 1001, 2**31))
    assert "more than 1 GiB" in str(limits.exceeded_by(60, 1000, 2**31))


def test_one_level_under_a_limit_still_encloses_the_truth(centred: Path) -> None:
    done = answered(centred, "--json", "--rtol", "5e-4", "--max-memory", "0.01")
    assert done.returncode == 3 and "the next level would" in done.stderr
    found = json.loads(done.stdout)
    assert not found["reached"] and len(found["levels"]) == 1 and found["error_kind"] == "enclosure"
    assert found["rtol"] == 5e-4
    assert found["stopped_by"] == "the next level would take more than 0.01 GiB"
    lower, upper, value = (np.array(found[name]) for name in ("lower", "upper", "maxwell"))
    assert np.all(lower <= value) and np.all(value <= upper)
    assert np.all(upper - lower <= 0.05 * np.abs(value))


def test_the_limit_of_time_ends_the_first_level_too(scene: Path) -> None:
    """A gap of 0.1 mm takes the mesher more than the limit and the two seconds that the solver may end in by itself."""
    scene.write_text(SCENE.replace("0, 0.03]", "0, 0.0001]"))
    done = command(scene, "--max-seconds", "0.1", "--json")
    assert done.returncode == 3 and "no level was finished within 0.1 s; " in done.stderr
    document = json.loads(done.stdout)
    schema = ROOT / "geometries/schemas/reference-1.schema.json"
    jsonschema.validate(document, json.loads(schema.read_text()))
    assert document["stopped_by"] == "no level was finished within 0.1 s" and not document["reached"]


def test_columns_left_out_are_named_and_unknown_ones_refused(centred: Path) -> None:
    done = answered(centred, "--json", "--error", "estimate", "--max-unknowns", "1000", "--columns", "front")
    found = json.loads(done.stdout)
    assert found["conductors"] == ["front"] and found["not_asked"] == ["target"]
    assert list(found["delta_self"]) == ["front"] and found["delta_self"]["front"]["value"] > 0
    wrong = answered(centred, "--json", "--columns", "front,nobody")
    assert wrong.returncode == 2 and wrong.stdout == "" and '"nobody"' in wrong.stderr


def test_people_get_a_table_with_errors_and_a_line_per_level(centred: Path) -> None:
    """Proven intervals as narrow as asked for need no second level."""
    done = answered(centred, "--rtol", "2e-2")
    assert done.returncode == 0 and ", 1 levels, " in done.stdout
    assert "delta_self, pF" in done.stdout and "±" in done.stdout and "proven to lie in" in done.stdout
    assert done.stderr.startswith("edge size") and len(done.stderr.splitlines()) == 1


def test_wrong_input_is_named_and_leaves_nothing(scene: Path) -> None:
    scene.write_text(SCENE.replace("0, 0.03]", "0, 0]"))
    done = answered(scene, "--json")
    assert done.returncode == 2 and done.stdout == ""
    assert str(scene) in done.stderr and "touch or cross" in done.stderr and "Traceback" not in done.stderr
    assert list(scene.parent.iterdir()) == [scene]


@pytest.mark.parametrize(
    "option, value",
    [
        ("--rtol", "0"),
        ("--rtol", "nan"),
        ("--max-seconds", "-1"),
        ("--max-unknowns", "no"),
        ("--error", "guess"),
        ("--output", "field.vtk"),
        *((option, value) for option in ("--wrap-alpha", "--wrap-offset") for value in ("0", "-0.01", "nan")),
        ("--wrong", "option"),
    ],
)
def test_wrong_options_are_refused(scene: Path, option: str, value: str) -> None:
    done = answered(scene, f"{option}={value}")
    assert done.returncode == 2 and option in done.stderr and value in done.stderr and done.stdout == ""


def test_a_slice_of_the_potential_runs_from_the_sensor_to_the_ground(scene: Path, tmp_path: Path) -> None:
    done = answered(scene, "--slice", tmp_path / "slice.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "slice.json").read_text())
    potential = np.array(found["potential"])
    along, z = np.array(found["along"]), np.array(found["z"])
    assert potential.shape == (len(z), len(along))
    assert found["origin"] == pytest.approx([0.005, 0]) and found["direction"] == [1, 0]
    assert -0.01 < potential.min() < 0.3 and 0.9 < potential.max() < 1.01
    near_target = potential[np.abs(z - 0.03).argmin(), np.abs(along - 0.005).argmin()]
    near_sensor = potential[np.abs(z).argmin(), np.abs(along - 0.005).argmin()]
    assert near_target < 0.1 and near_sensor > 0.9


@pytest.mark.parametrize("option, name", [("--slice", "slice.json"), ("--output", "field.vtu")])
def test_a_picture_that_cannot_be_written_leaves_nothing(
    scene: Path, tmp_path: Path, option: str, name: str
) -> None:
    done = answered(scene, "--json", option, tmp_path / "missing" / name)
    assert done.returncode == 1 and "missing" in done.stderr and done.stdout == ""
    assert list(tmp_path.iterdir()) == [scene]


def test_the_field_is_written_for_paraview(scene: Path, tmp_path: Path) -> None:
    """The file has metres, 1 V on the first sensor, a lower voltage on the floating object, and the field −∇u between them."""
    scene.write_text(
        SCENE
        + 'potential = "floating"\n'
        + scenes.body(
            "ball", "sphere", radius=0.02, translation=[0, 0, -0.06], material={"relative_permittivity": 3}
        )
    )
    coarse = ("--json", "--rtol", "0.5", "--error", "estimate")
    done = answered(scene, *coarse, "--output", tmp_path / "field.vtu")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["conductors"] == ["front"] and document["floating"] == ["target"]
    assert document["dielectrics"] == [{"name": "ball", "relative_permittivity": 3}]
    assert document["delta_self"]["front"]["value"] > 0
    found = meshio.read(tmp_path / "field.vtu")
    tetrahedra, triangles = found.cells_dict["tetra"], found.cells_dict["triangle"]
    bodies = dict(zip((block.type for block in found.cells), found.cell_data["body"]))
    fields = dict(zip((block.type for block in found.cells), found.cell_data["field"]))
    potential = found.point_data["potential"]
    assert set(bodies["triangle"]) == {1, 2} and set(bodies["tetra"]) == {0, 3}
    sensor = found.points[triangles[bodies["triangle"] == 1]]
    np.testing.assert_allclose(np.abs(sensor).max(axis=(0, 1)), [0.05, 0.05, 0], atol=1e-9)
    np.testing.assert_allclose(potential[triangles[bodies["triangle"] == 1]], 1, atol=1e-9)
    (driven,) = (name for name in found.point_data if name != "potential")
    assert driven == "1 V: front"
    assert set(found.point_data[driven][triangles[bodies["triangle"] == 1]].ravel()) == {1}
    assert set(found.point_data[driven][triangles[bodies["triangle"] == 2]].ravel()) == {0}
    target = potential[triangles[bodies["triangle"] == 2]]
    assert np.ptp(target) < 1e-9 and 0.3 < target.min() < 0.9
    ball = np.linalg.norm(found.points[tetrahedra[bodies["tetra"] == 3]] - [0, 0, -0.06], axis=2)
    assert ball.max() == pytest.approx(0.02, rel=1e-6)
    middles = found.points[tetrahedra].mean(axis=1)
    between = np.linalg.norm(middles - [0.01, 0, 0.015], axis=1) < 0.01
    straight = (1 - target.min()) / 0.03
    assert fields["tetra"][between].mean(axis=0)[2] == pytest.approx(straight, rel=0.15)
    assert np.isnan(fields["triangle"]).all()


def test_help_names_every_exit_status() -> None:
    done = command("--help")
    assert done.returncode == 0 and "Exit status: 0 answered; 2 wrong input; 3" in done.stdout
