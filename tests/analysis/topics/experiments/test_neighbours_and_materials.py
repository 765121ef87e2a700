"""Experiments V and VI, from the answers of a study to the report, and the sections of all experiments."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.results import store, study_results as results
from analysis.study import plan
from analysis.topics.experiments import neighbours
from analysis.topics.experiments.curves import Divider
from analysis.topics.experiments.materials import materials, ratios
from geometries.studies import study
from tests import scenes
from tests.analysis.synthetic import (
    EDGE,
    HEAD,
    PICO,
    make_results,
    model_document,
    reference_document,
    report_text,
)

NEIGHBOURS = scenes.sweep("sensors", separation=0.01, gap=[0.01, 0.16]) + scenes.sweep(
    "parallel", gap=[0.01, 0.16]
)
MATERIALS = scenes.sweep("box", thickness=0.04, gap=[0.01, 0.16], material=["grounded", "floating"])


def two_sensors(near: float, neighbour: float, coupling: float) -> dict[str, Any]:
    """The reference's answer in pF for sensor, neighbour and target; mutual is twice delta_self."""
    matrix = [
        [20.0, -coupling, -2 * near],
        [-coupling, 20.0, -2 * neighbour],
        [-2 * near, -2 * neighbour, 20.0],
    ]
    changes = {
        "sensor": {"value": near * PICO, "error": 0.01 * PICO},
        "neighbour": {"value": neighbour * PICO, "error": 0.01 * PICO},
    }
    return reference_document(2, 1) | {
        "conductors": ["sensor", "neighbour", "target"],
        "maxwell": [[value * PICO for value in row] for row in matrix],
        "error": [[0.01 * PICO] * 3] * 3,
        "delta_self": changes,
        "levels": [],
    }


def two_sensors_alone(coupling: float) -> dict[str, Any]:
    matrix = [[20 * PICO, -coupling * PICO], [-coupling * PICO, 20 * PICO]]
    return two_sensors(0, 0, coupling) | {
        "conductors": ["sensor", "neighbour"],
        "maxwell": matrix,
        "error": [[0.01 * PICO] * 2] * 2,
        "delta_self": {},
    }


def model_of_two(near: float, neighbour: float) -> dict[str, Any]:
    document = model_document(near)
    for answer in document["methods"].values():
        (first,) = answer["sensors"]
        objects = [{"name": "target", "capacitance": neighbour * PICO}]
        answer["sensors"] = [first, {"name": "neighbour", "total": neighbour * PICO, "objects": objects}]
    return document


def neighbours_folder(folder: Path) -> Path:
    answers = {
        0: (two_sensors(8, 0.2, 1.2), model_of_two(9, 2)),
        1: (two_sensors(0.1, 0.05, 1.9), model_of_two(0.5, 0.45)),
        2: (reference_document(16, 10), model_document(9)),
        3: (reference_document(0.4, 0.2), model_document(0.5)),
    }
    made = make_results(folder, NEIGHBOURS, answers, experiment="V")
    (alone,) = {case.empty for case in results.load(made).compared() if case.family == neighbours.FAMILY}
    document = two_sensors_alone(2.0)
    store.write_json(results.case_folder(made, alone) / results.REFERENCE, document)
    return made


def experiment_section(folder: Path) -> str:
    (found,) = re.findall(r"<section>\s*<h2>Experiment.*?</section>", report_text(folder), re.DOTALL)
    return str(found)


def test_the_neighbours_share_and_the_coupling_by_hand(tmp_path: Path) -> None:
    text = experiment_section(neighbours_folder(tmp_path))
    assert (
        "1 cm away it feels 2.5 % of what the near sensor does with the object at 1 cm, 50 % at 16 cm" in text
    )
    assert "(model: 22 % and 90 %)" in text
    assert "coupled by 2 pF, which the object at 1 cm changes by −40 %" in text
    assert "differs from that of a sensor alone by up to −50 %, at 16 cm" in text
    assert text.count("plotly-graph-div") == 2


def test_set_ups_of_two_sensors_come_by_gap_with_both_sensors(tmp_path: Path) -> None:
    (series,) = neighbours.series(results.load(neighbours_folder(tmp_path)))
    assert series.separation == 0.01 and [point.gap for point in series.points] == [0.01, 0.16]
    near, neighbour = series.points[0].near, series.points[0].neighbour
    assert near.mutual.value == pytest.approx(16 * PICO) and neighbour.mutual.value == pytest.approx(
        0.4 * PICO
    )
    assert neighbour.model == pytest.approx(2 * PICO)
    assert series.points[0].single is not None and series.points[0].single.value == pytest.approx(10 * PICO)


def test_rows_of_two_sensors_are_told_apart_in_the_table(tmp_path: Path) -> None:
    folder = neighbours_folder(tmp_path)
    report_text(folder)
    lines = (folder / "table.csv").read_text().splitlines()
    assert sum(",neighbour,target,mutual," in line for line in lines) == 2


def materials_folder(folder: Path) -> Path:
    def floating(delta_self: float) -> dict[str, Any]:
        whole = reference_document(1, delta_self)
        own = whole["maxwell"][0][0]
        return whole | {"conductors": ["sensor"], "maxwell": [[own]], "error": [[0.01 * PICO]], "levels": []}

    answers: dict[int, Any] = {
        0: (reference_document(16, 8), model_document(16)),
        1: (floating(0.8), None),
        2: (reference_document(0.8, 0.2), model_document(1.6)),
        3: (floating(0.01), None),
    }
    return make_results(folder, MATERIALS, answers, experiment="VI")


def test_materials_over_the_grounded_target_by_hand(tmp_path: Path) -> None:
    folder = materials_folder(tmp_path)
    grounded, floating = materials(results.load(folder))
    assert (grounded.label, floating.label) == ("grounded", "floating")
    assert [ratio for _, ratio in ratios(floating, grounded)] == pytest.approx([0.1, 0.05])
    text = experiment_section(folder)
    assert "floating: 10 % at 1 cm, 5 % at 16 cm" in text
    assert "over delta_self it is: grounded 2 to 8 times; floating 20 to 160 times" in text
    assert text.count("plotly-graph-div") == 2


def test_the_model_is_asked_for_grounded_targets_only(tmp_path: Path) -> None:
    chosen = study.loads(HEAD + MATERIALS)
    works = {work.case: work for work in plan.missing(chosen, chosen.cases(), tmp_path)}
    for case in chosen.cases():
        asked = results.MODEL in works[case.id].keys
        assert asked == (case.parameters.get("material") == "grounded")
        assert results.REFERENCE in works[case.id].keys


def test_experiments_without_answers_say_so(tmp_path: Path) -> None:
    nothing = {number: (None, None) for number in range(4)}
    text = experiment_section(make_results(tmp_path / "v", NEIGHBOURS, nothing, experiment="V"))
    assert "No set-up of two sensors has both answers" in text
    text = experiment_section(make_results(tmp_path / "vi", MATERIALS, nothing, experiment="VI"))
    assert "No grounded target has an answer" in text


def test_the_page_of_a_case_without_the_model_has_the_references_value(tmp_path: Path) -> None:
    folder = materials_folder(tmp_path)
    report_text(folder)
    for case in results.load(folder).compared():
        page = (case.folder / "case.html").read_text()
        known = case.parameters["material"] == "grounded"
        assert ("the model has no answer" in page) != known
        assert ("build/bin/fringe capacitance" in page) == known
        assert 'name":"target"' in page.replace(" ", ""), "drawn whatever it is made of"


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
