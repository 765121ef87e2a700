"""The report of an experiment: a section with figures and findings that follow from the answers."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from analysis.results import study_results as results
from analysis.study import plan
from analysis.topics.experiments.curves import Divider
from geometries.studies import study
from tests.analysis.synthetic import (
    EDGE,
    HEAD,
    PICO,
    make_results,
    model_document,
    reference_document,
    report_text,
)

COUNT = 6
SIZES = f"""
[[sweep]]
family = "parallel"
sensor_size = [0.1, 0.1]
target_size = [[0.1, 0.1], [0.05, 0.05], [0.15, 0.15]]
gap = {{ geomspace = [0.01, 0.16, {COUNT}] }}
"""
ANGLES = f"""
[[sweep]]
family = "parallel"
sensor_size = [0.1, 0.1]
target_size = [0.1, 0.1]
gap = {{ geomspace = [0.01, 0.16, {COUNT}] }}

[[sweep]]
family = "inclined"
sensor_size = [0.1, 0.1]
target_size = [0.1, 0.1]
hinge_gap = [0.01, 0.02]
tilt_degrees = [30, 60, 90]
"""
MODEL = np.geomspace(12, 1, COUNT)


def answers(factors: list[float]) -> dict[int, tuple[dict[str, object], dict[str, object]]]:
    """For each plate over distance the model's values, and so many times as much by the reference."""
    return {
        plate * COUNT + place: (reference_document(2 * factor * model, factor * model), model_document(model))
        for plate, factor in enumerate(factors)
        for place, model in enumerate(MODEL)
    }


def section(folder: Path) -> str:
    """The experiment's part of the page without scripts; empty without one."""
    found = re.findall(r"<section>\s*<h2>Experiment.*?</section>", report_text(folder), re.DOTALL)
    assert len(found) <= 1
    return found[0] if found else ""


def findings(text: str) -> list[str]:
    return re.findall(r'<p class="finding">(.*?)</p>', text)


def test_a_study_that_is_no_experiment_has_no_such_section(tmp_path: Path) -> None:
    assert section(make_results(tmp_path)) == ""


def times(factor: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The model's delta output over that of a reference so many times the model's capacitance, with the sensor's own 4 pF."""
    reference = Divider(5 * PICO, 4 * PICO, 2.5).delta_output(factor * MODEL * PICO)
    return np.asarray(Divider(5 * PICO, 0, 2.5).delta_output(MODEL * PICO) / reference)


def test_the_model_as_it_comes_is_shown_beside_the_reference(tmp_path: Path) -> None:
    other = SIZES.replace("sensor_size = [0.1, 0.1]", "sensor_size = [0.3, 0.3]")
    given = answers([0.8, 0.85, 0.5, 0.6, 0.6, 0.6])
    text = section(make_results(tmp_path, SIZES + other, given, experiment="III"))
    assert "Sensor of 10 cm × 10 cm" in text and "Sensor of 30 cm × 30 cm" in text
    assert text.count("plotly-graph-div") == 6 and len(findings(text)) == 4
    for plate, factor in (("10 cm × 10 cm", 0.8), ("5 cm × 5 cm", 0.85), ("15 cm × 15 cm", 0.5)):
        least, greatest = min(times(factor)), max(times(factor))
        told = f"plate of {plate} {least:.3g} (at 1 cm) to {greatest:.3g} (at 16 cm)"
        assert told in findings(text)[0]


@pytest.mark.parametrize(("experiment", "number"), [("II", 3), ("III", 3), ("IV", 2)])
def test_the_change_of_the_reading_is_held_beside_mutual(
    tmp_path: Path, experiment: str, number: int
) -> None:
    """Half of mutual but for one plate, far away or turned by 60 degrees, where it is a quarter."""
    given = answers([0.8, 0.8, 0.8])
    scenes = ANGLES if experiment == "IV" else SIZES
    if experiment == "IV":
        given = {place: given[place] for place in range(COUNT)}
        given |= {COUNT + place: (reference_document(4, 2), model_document(3)) for place in range(6)}
    place, at = (COUNT + 1, "60°") if experiment == "IV" else (COUNT - 1, "16 cm")
    given[place] = (reference_document(4, 1), model_document(3))
    text = section(make_results(tmp_path, scenes, given, experiment=experiment))
    measured = findings(text)[1]
    assert measured.count(" to ") == number and f" 0.25 (at {at}) to 0.5 " in measured
    assert text.count("not mutual: that is the charge on the plate") == 1


def test_the_first_experiment_measures_nothing(tmp_path: Path) -> None:
    text = section(make_results(tmp_path, SIZES, answers([0.8, 0.8, 0.8]), experiment="I"))
    assert "Measured quantity: none." in text


@pytest.mark.parametrize("experiment", ["I", "II", "III", "IV"])
def test_an_experiment_without_answers_still_has_a_report(tmp_path: Path, experiment: str) -> None:
    none = {number: (None, None) for number in range(12)}
    text = section(make_results(tmp_path, ANGLES, none, experiment=experiment))
    assert f"Experiment {experiment}:" in text and not findings(text)


def test_a_study_without_a_reference_solves_nothing(tmp_path: Path) -> None:
    alone = HEAD.replace("rtol = 1e-3\nmax_seconds = 60", 'error = "none"')
    chosen = study.loads(alone + EDGE)
    asked = {file for work in plan.missing(chosen, chosen.cases(), tmp_path) for file in work.keys}
    assert asked == {results.MODEL}


def test_the_studies_of_the_experiments_name_them() -> None:
    for number, name in enumerate(study.EXPERIMENTS, start=1):
        assert study.load(study.find(f"experiment_{number}")).experiment == name
