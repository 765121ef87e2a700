"""Electrodes that are no rectangles: boundary elements and the field solver agree on their readings, and the model has none."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from fem_reference.answer.reference import solve_conductors
from fem_reference.bodies.conductors import conductors
from geometries.scene import reader
from tests import scenes

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "geometries" / "scenes" / "round_electrode.toml"
# Without round bodies, so that both solve the same.
SCENE = (
    scenes.body(
        "electrode",
        "polygon",
        vertices=[[0, 0], [0.04, 0], [0.04, 0.04], [0.02, 0.04], [0.02, 0.02], [0, 0.02]],
        potential="electrode",
    )
    + scenes.body(
        "triangle",
        "polygon",
        vertices=[[0, 0], [0.03, 0.01], [-0.01, 0.03]],
        potential="electrode",
        translation=[-0.01, 0.03, 0.01],
    )
    + scenes.body("target", "box", size=[0.05, 0.04, 0.03], target=True, translation=[0.02, 0.02, 0.05])
    + scenes.table("reading", name="own", sense="electrode", drive=["electrode"])
    + scenes.table("reading", name="transmitted", sense="electrode", drive=["triangle"])
)


@pytest.mark.night
def test_boundary_elements_and_the_field_solver_agree_on_polygons(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    boundary = model_module().Scene.load(str(path)).maxwell(rtol=1e-2)
    field = solve_conductors(conductors(reader.load(path)), rtol=1e-2, error="estimate")
    apart = np.abs(boundary["maxwell"][:2, :2] - field.maxwell.value[:2, :2])
    assert np.all(apart <= boundary["error"][:2, :2] + field.maxwell.error[:2, :2])
    assert np.all(boundary["error"][:2, :2] <= 1e-2 * np.abs(boundary["maxwell"][:2, :2]))


def test_the_example_has_readings_of_electrodes_and_the_model_none() -> None:
    command = [str(ROOT / "build" / "bin" / "fringe"), "capacitance", str(EXAMPLE), "--json"]
    model = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    assert [reading["change"] for reading in model["readings"]] == [None, None]
    more = ["--method", "boundary-elements", "--rtol", "0.1"]
    answer = json.loads(subprocess.run(command + more, capture_output=True, text=True, check=True).stdout)
    own, transmitted = answer["readings"]
    assert own["change"] > own["error"]["change"] and transmitted["change"] < -transmitted["error"]["change"]
