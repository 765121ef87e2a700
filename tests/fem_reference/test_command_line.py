"""The command python3 -m fem_reference: exit statuses, messages, and the files it writes."""

from __future__ import annotations

import contextlib
import io
import json
import subprocess
import sys
from pathlib import Path

import jsonschema
import meshio
import numpy as np
import pytest

from fem_reference.__main__ import main
from tests import scenes

ROOT = Path(__file__).resolve().parents[2]
READING = scenes.table("reading", name="front", sense="front", drive=["front"])
SCENE = scenes.SENSOR + scenes.body("target", "plate", size=[0.06, 0.06], translation=[0.01, 0, 0.03])


def command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """The command as users start it."""
    words = [sys.executable, "-m", "fem_reference", *map(str, arguments)]
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)


def answered(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """The command in this process, which loads the solver once for all tests."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([*map(str, arguments)])
    return subprocess.CompletedProcess(arguments, status, out.getvalue(), err.getvalue())


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "a scene.toml"
    path.write_text(SCENE)
    return path


def test_json_is_one_document_with_the_whole_answer(scene: Path) -> None:
    done = command(scene, "--json", "--error", "estimate")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["error_kind"] == "estimate"
    assert found["conductors"] == ["front", "target"] and found["reached"] and found["rtol"] == 1e-3
    maxwell, error = np.array(found["maxwell"]), np.array(found["error"])
    np.testing.assert_allclose(np.array(found["upper"]) - found["lower"], 2 * error, rtol=1e-9)
    assert np.all(error <= 1e-3 * np.abs(maxwell))
    assert found["unknowns"] == found["levels"][-1]["unknowns"]
    change = found["delta_self"]["front"]
    assert 0 < change["value"] < maxwell[0, 0] and change["error"] <= 1e-3 * change["value"]


@pytest.mark.night
def test_the_whole_of_space_is_meshed_when_symmetry_is_not_to_be_used(scene: Path) -> None:
    short = ("--json", "--error", "estimate", "--max-unknowns", "1000")
    half, whole = (json.loads(answered(scene, *short, *more).stdout) for more in ((), ("--no-symmetry",)))
    assert len(half["symmetry_planes"]) == 1 and whole["symmetry_planes"] == []
    assert whole["unknowns"] > 1.5 * half["unknowns"]
    np.testing.assert_allclose(half["maxwell"], whole["maxwell"], rtol=5e-3)


def test_an_estimate_of_one_mesh_is_between_its_bounds_and_not_accurate_enough(scene: Path) -> None:
    done = answered(scene, "--json", "--error", "estimate", "--max-unknowns", "1000")
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


@pytest.mark.parametrize("limit", [("--max-unknowns", "1000"), ("--max-memory", "0.01")])
def test_one_level_under_a_limit_still_encloses_the_truth(scene: Path, limit: tuple[str, str]) -> None:
    done = answered(scene, "--json", "--rtol", "5e-4", *limit)
    assert done.returncode == 3 and "the next level would" in done.stderr
    found = json.loads(done.stdout)
    assert not found["reached"] and len(found["levels"]) == 1 and found["error_kind"] == "enclosure"
    assert found["rtol"] == 5e-4
    assert found["stopped_by"].startswith("the next level would")
    lower, upper, value = (np.array(found[name]) for name in ("lower", "upper", "maxwell"))
    assert np.all(lower <= value) and np.all(value <= upper)
    assert np.all(upper - lower <= 0.05 * np.abs(value))
    assert 500 < found["memory_per_unknown"] < 50_000


@pytest.mark.parametrize("as_json", [False, True])
def test_the_limit_of_time_ends_the_first_level_too(tmp_path: Path, as_json: bool) -> None:
    """A gap of 0.1 mm takes the mesher more than the limit and the two seconds that the solver may end in by itself."""
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.replace("0, 0.03]", "0, 0.0001]"))
    done = command(path, "--max-seconds", "0.1", *(["--json"] if as_json else []))
    assert done.returncode == 3 and "no level was finished within 0.1 s; " in done.stderr
    if as_json:
        document = json.loads(done.stdout)
        jsonschema.validate(
            document, json.loads((ROOT / "geometries/schemas/reference-1.schema.json").read_text())
        )
        assert document["stopped_by"] == "no level was finished within 0.1 s" and not document["reached"]
    else:
        assert done.stdout == ""


def test_no_level_follows_when_everything_is_as_accurate_as_asked(scene: Path) -> None:
    """Proven intervals need no second level."""
    found = json.loads(answered(scene, "--json", "--rtol", "2e-2").stdout)
    assert found["reached"] and len(found["levels"]) == 1
    change = found["delta_self"]["front"]
    assert change["error"] <= 2e-2 * change["value"]


def test_columns_left_out_are_named_and_unknown_ones_refused(scene: Path) -> None:
    done = answered(scene, "--json", "--error", "estimate", "--max-unknowns", "1000", "--columns", "front")
    found = json.loads(done.stdout)
    assert found["conductors"] == ["front"] and found["not_asked"] == ["target"]
    assert list(found["delta_self"]) == ["front"] and found["delta_self"]["front"]["value"] > 0
    wrong = answered(scene, "--json", "--columns", "front,nobody")
    assert wrong.returncode == 2 and wrong.stdout == "" and '"nobody"' in wrong.stderr


def test_people_get_a_table_with_errors_and_a_line_per_level(scene: Path) -> None:
    done = answered(scene, "--max-unknowns", "1000")
    assert "delta_self, pF" in done.stdout and "±" in done.stdout and "proven to lie in" in done.stdout
    assert done.stderr.startswith("edge size")


@pytest.mark.parametrize(
    "change, words",
    [
        (("size = [0.06, 0.06]", "size = [0.06, 0]"), "shape.size"),
        (("translation = [0.01, 0, 0.03]", "translation = [0.01, 0, 0]"), "touch or cross"),
    ],
)
def test_wrong_input_is_named_and_leaves_nothing(scene: Path, change: tuple[str, str], words: str) -> None:
    scene.write_text(SCENE.replace(*change))
    done = answered(scene, "--json")
    assert done.returncode == 2 and done.stdout == ""
    assert str(scene) in done.stderr and words in done.stderr
    assert "Traceback" not in done.stderr
    assert list(scene.parent.iterdir()) == [scene]


@pytest.mark.parametrize(
    "arguments",
    [
        ["--rtol", "0"],
        ["--rtol", "nan"],
        ["--max-seconds", "-1"],
        ["--max-unknowns", "no"],
        ["--error", "guess"],
        ["--wrong"],
    ],
)
def test_wrong_options_are_refused(scene: Path, arguments: list[str]) -> None:
    done = command(scene, *arguments)
    assert done.returncode == 2 and arguments[-1] in done.stderr and done.stdout == ""


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


def test_a_slice_that_cannot_be_written_leaves_nothing(scene: Path, tmp_path: Path) -> None:
    done = answered(scene, "--slice", tmp_path / "missing" / "slice.json")
    assert done.returncode == 1 and "missing" in done.stderr
    assert list(tmp_path.iterdir()) == [scene]


def test_the_field_is_written_for_paraview(scene: Path, tmp_path: Path) -> None:
    """The file has metres, 1 V on the first sensor, a lower voltage on the floating object, and the field −∇u between them."""
    scene.write_text(
        SCENE
        + 'potential = "floating"\n[[object]]\nname = "ball"\ntranslation = [0, 0, -0.06]\n'
        + 'shape = { type = "sphere", radius = 0.02 }\nmaterial = { relative_permittivity = 3 }\n'
    )
    done = answered(scene, "--json", "--max-unknowns", "1000", "--output", tmp_path / "field.vtu")
    assert done.returncode == 3, done.stderr
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


@pytest.mark.parametrize("name, status", [("missing/field.vtu", 1), ("field.vtk", 2)])
def test_a_field_that_cannot_be_written_is_refused_before_the_work(
    scene: Path, tmp_path: Path, name: str, status: int
) -> None:
    done = command(scene, "--json", "--output", tmp_path / name)
    assert done.returncode == status and done.stdout == "" and name.split("/")[0] in done.stderr
    assert list(tmp_path.iterdir()) == [scene]


def test_help_names_every_exit_status() -> None:
    done = command("--help")
    assert done.returncode == 0 and "Exit status: 0 answered; 2 wrong input; 3" in done.stdout


@pytest.mark.parametrize("option", ["--wrap-alpha", "--wrap-offset"])
@pytest.mark.parametrize("length", ["0", "-0.01", "nan"])
def test_lengths_of_a_wrap_are_positive(scene: Path, option: str, length: str) -> None:
    wrong = command(scene, f"{option}={length}")
    assert wrong.returncode == 2 and wrong.stdout == "" and option in wrong.stderr
