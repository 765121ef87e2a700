"""The thesis' experiments, from the answers of a study to the section of its report."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.results import store, study_results as results
from analysis.results.answers import Estimate
from analysis.results.set_up import rectangles
from analysis.study import workflow
from analysis.topics.experiments import neighbours
from analysis.topics.experiments.curves import curves, delta_output, reference_delta_output, with_flat_start
from analysis.topics.experiments.materials import materials, ratios
from analysis.topics.experiments.section import (
    AT_CORNER,
    BESIDE_EDGE,
    IN_FRONT,
    SEVERAL,
    accuracies,
    region,
    splitting_finding,
)
from geometries.scene.scene import Scene
from geometries.studies import families, study
from tests import scenes
from tests.analysis.documents import PICO, model_document, reference_document
from tests.analysis.synthetic import EDGE, HEAD, PARALLEL, make_results, report_text

SIZE = (0.1, 0.06)


@pytest.mark.parametrize(
    "scene, expected",
    [
        (families.parallel(SIZE, SIZE, 0.01), IN_FRONT),
        (families.parallel(SIZE, (0.101, 0.06), 0.01), SEVERAL),
        (families.inclined(SIZE, SIZE, 0.01, 30), IN_FRONT),
        (families.inclined(SIZE, SIZE, 0.01, 90), IN_FRONT),
        (families.edge(SIZE, SIZE, 0.01, 0), BESIDE_EDGE),
        (families.edge(SIZE, SIZE, 0, 0.01, 45), BESIDE_EDGE),
        (families.corner(SIZE, SIZE, (0.01, 0.02), 0), AT_CORNER),
        (families.corner(SIZE, SIZE, (0, 0), 0.01, 20, 30), AT_CORNER),
        (families.straddle(SIZE, SIZE, 0.01, (0.02, 0)), SEVERAL),
        (families.straddle(SIZE, SIZE, 0.01, (0.05, 0.03)), SEVERAL),
    ],
)
def test_regions_as_seen_along_the_normal(scene: Scene, expected: str) -> None:
    plates = rectangles(scene)
    assert plates is not None
    assert region(*plates) == expected


def test_errors_by_region_and_level_computed_by_hand(tmp_path: Path) -> None:
    answers = {
        number: (None, model_document(2, coarse=coarse)) for number, coarse in enumerate([1, 1.5, 1.8, 3, 2])
    }
    found = accuracies(results.load(make_results(tmp_path, PARALLEL + EDGE, answers)))
    assert [(each.region, each.level) for each in found] == [
        (IN_FRONT, 0),
        (IN_FRONT, 4),
        (BESIDE_EDGE, 0),
        (BESIDE_EDGE, 4),
    ]
    assert found[0].errors == pytest.approx((-0.5, -0.25, -0.1))
    assert (found[0].median, found[0].worst) == pytest.approx((0.25, 0.5))
    assert found[1].worst == pytest.approx(1e-5)
    assert found[2].errors == pytest.approx((0.5, 0))


def test_the_finding_is_of_the_level_that_the_thesis_recommends(tmp_path: Path) -> None:
    answers = {number: (None, model_document(2, coarse=1)) for number in range(5)}
    text = splitting_finding(accuracies(results.load(make_results(tmp_path, PARALLEL + EDGE, answers))))
    assert (
        text.startswith("After 4 splits")
        and "region I 0.001 % (0.001 %), region II 0.001 % (0.001 %)" in text
    )
    assert "below the exact integral in 50 % of all" in text


OVER_DISTANCE = scenes.sweep("parallel", target_size=[[0.1, 0.1], [0.05, 0.05]], gap=[0.04, 0.01])
INCLINED = scenes.sweep("inclined", hinge_gap=0.01, tilt_degrees=[30, 60])


def test_delta_output_is_the_output_without_objects_less_that_with_them() -> None:
    assert delta_output(np.array([0.0, 5 * PICO]), 0, 5 * PICO, 2.5) == pytest.approx([0, 2.5 - 1.25])
    change = np.array([10 * PICO, 30 * PICO])
    assert delta_output(change, 5 * PICO, 5 * PICO, 2.5) == pytest.approx([1.25 - 0.625, 1.25 - 0.3125])


def test_what_the_reference_may_be_off_moves_the_delta_output_by_its_error_bar() -> None:
    own, change = Estimate(4 * PICO, 1e-4 * PICO), Estimate(3 * PICO, 2e-4 * PICO)
    found = reference_delta_output(own, change, 5 * PICO, 2.5)

    def moved(by_own: float, by_change: float) -> float:
        changed = np.array(change.value + by_change * change.error)
        return float(delta_output(changed, own.value + by_own * own.error, 5 * PICO, 2.5))

    corners = [abs(moved(s, t) - found.value) for s in (-1, 1) for t in (-1, 1)]
    assert max(corners) == pytest.approx(found.error, rel=1e-3)


def test_a_curve_for_each_plate_in_the_order_of_the_study_and_of_the_distance(tmp_path: Path) -> None:
    found = curves(results.load(make_results(tmp_path, OVER_DISTANCE + INCLINED + EDGE)))
    assert [(curve.family, curve.size("target"), curve.at.tolist()) for curve in found] == [
        ("parallel", (0.1, 0.1), [0.01, 0.04]),
        ("parallel", (0.05, 0.05), [0.01, 0.04]),
        ("inclined", (0.1, 0.1), [30, 60]),
    ]
    first = found[0]
    assert (first.coupling, first.voltage, first.own.value) == pytest.approx((5e-12, 2.5, 4e-12))
    assert first.model == pytest.approx([1.8e-12] * 2)
    assert first.reference == pytest.approx(delta_output(np.full(2, 1e-12), 4e-12, 5e-12, 2.5))


FLOATING = reference_document(2, 1, conductors=["sensor"])


@pytest.mark.parametrize(
    "answers",
    [
        {0: (None, model_document(1)), 1: (reference_document(2, 1), None)},
        {place: (FLOATING, model_document(1)) for place in range(2)},
    ],
    ids=["one answer", "floating, which have no mutual"],
)
def test_cases_without_both_answers_and_floating_targets_are_left_out(
    tmp_path: Path, answers: dict[int, Any]
) -> None:
    found = curves(results.load(make_results(tmp_path, OVER_DISTANCE, answers)))
    assert [curve.size("target") for curve in found] == [(0.05, 0.05)]


def test_the_parallel_plate_at_the_height_of_the_hinge_is_the_angle_0(tmp_path: Path) -> None:
    flat, small, pivoted = curves(results.load(make_results(tmp_path, OVER_DISTANCE + INCLINED)))
    whole = with_flat_start(pivoted, flat)
    assert whole.at.tolist() == [0, 30, 60]
    assert whole.points[0].case == flat.points[0].case
    assert with_flat_start(pivoted, small).at.tolist() == [30, 60]
    elsewhere = replace(flat, points=flat.points[1:])
    assert with_flat_start(pivoted, elsewhere).at.tolist() == [30, 60]


def test_a_plate_hinged_to_the_edge_of_a_wider_sensor_is_not_the_centred_one(tmp_path: Path) -> None:
    wide = (OVER_DISTANCE + INCLINED).replace("sensor_size = [0.1, 0.1]", "sensor_size = [0.2, 0.1]")
    flat, _, pivoted = curves(results.load(make_results(tmp_path, wide)))
    assert flat.size("target") == pivoted.size("target")
    assert with_flat_start(pivoted, flat).at.tolist() == [30, 60]


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
    whole = two_sensors(0, 0, 2.0)
    matrices = {name: [row[:2] for row in whole[name][:2]] for name in ("maxwell", "error")}
    document = whole | matrices | {"conductors": ["sensor", "neighbour"], "delta_self": {}}
    store.write_json(results.case_folder(made, alone) / results.REFERENCE, document)
    return made


def section(folder: Path) -> str:
    """The experiment's part of the page without scripts; empty without one."""
    found = re.findall(r"<section>\s*<h2>Experiment.*?</section>", report_text(folder), re.DOTALL)
    assert len(found) <= 1
    return found[0] if found else ""


def test_the_neighbours_share_and_the_coupling_by_hand(tmp_path: Path) -> None:
    folder = neighbours_folder(tmp_path)
    (series,) = neighbours.series(results.load(folder))
    assert series.separation == 0.01 and [point.gap for point in series.points] == [0.01, 0.16]
    first = series.points[0]
    known = (first.near.mutual.value, first.neighbour.mutual.value, first.neighbour.model)
    assert known == pytest.approx((16 * PICO, 0.4 * PICO, 2 * PICO))
    assert first.single is not None and first.single.value == pytest.approx(10 * PICO)
    text = section(folder)
    told = (
        "1 cm away it feels 2.5 % of what the near sensor does with the object at 1 cm, 50 % at 16 cm",
        "(model: 22 % and 90 %)",
        "coupled by 2 pF, which the object at 1 cm changes by −40 %",
        "differs from that of a sensor alone by up to −50 %, at 16 cm",
    )
    assert [words for words in told if words not in text] == []
    assert text.count("plotly-graph-div") == 2
    lines = (folder / "table.csv").read_text().splitlines()
    assert sum(",neighbour,target,mutual," in line for line in lines) == 2, "rows tell the sensors apart"


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
    text = section(folder)
    assert "floating: 10 % at 1 cm, 5 % at 16 cm" in text
    assert "over delta_self it is: grounded 2 to 8 times; floating 20 to 160 times" in text
    assert text.count("plotly-graph-div") == 2


def test_the_model_is_asked_for_grounded_targets_only_and_a_study_without_a_reference_solves_nothing(
    tmp_path: Path,
) -> None:
    chosen = study.loads(HEAD + MATERIALS)
    works = {work.case: work for work in workflow.missing(chosen, chosen.cases(), tmp_path)}
    for case in chosen.cases():
        asked = results.MODEL in works[case.id].keys
        assert asked == (case.parameters.get("material") == "grounded")
        assert results.REFERENCE in works[case.id].keys
    chosen = study.loads(HEAD.replace("rtol = 1e-3\nmax_seconds = 60", 'error = "none"') + EDGE)
    files = {file for work in workflow.missing(chosen, chosen.cases(), tmp_path) for file in work.keys}
    assert files == {results.MODEL}


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
GAPS = {"geomspace": [0.01, 0.16, COUNT]}
SIZES = scenes.sweep("parallel", target_size=[[0.1, 0.1], [0.05, 0.05], [0.15, 0.15]], gap=GAPS)
ANGLES = scenes.sweep("parallel", gap=GAPS) + scenes.sweep(
    "inclined", hinge_gap=[0.01, 0.02], tilt_degrees=[30, 60, 90]
)
MODEL = np.geomspace(12, 1, COUNT)


def answers(factors: list[float]) -> dict[int, tuple[dict[str, object], dict[str, object]]]:
    """For each plate over distance the model's values, and so many times as much by the reference."""
    return {
        plate * COUNT + place: (reference_document(2 * factor * model, factor * model), model_document(model))
        for plate, factor in enumerate(factors)
        for place, model in enumerate(MODEL)
    }


def findings(text: str) -> list[str]:
    return re.findall(r'<p class="finding">(.*?)</p>', text)


def times(factor: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The model's delta output over that of a reference so many times the model's capacitance, with the sensor's own 4 pF."""
    reference = delta_output(factor * MODEL * PICO, 4 * PICO, 5 * PICO, 2.5)
    return np.asarray(delta_output(MODEL * PICO, 0, 5 * PICO, 2.5) / reference)


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


@pytest.mark.parametrize(
    ("experiment", "sweeps", "told"),
    [
        ("I", ANGLES, "Measured quantity: none."),
        ("II", ANGLES, "No curve has both answers"),
        ("III", ANGLES, "No curve has both answers"),
        ("IV", ANGLES, "No curve has both answers"),
        ("V", NEIGHBOURS, "No set-up of two sensors has both answers"),
        ("VI", MATERIALS, "No grounded target has an answer"),
    ],
)
def test_an_experiment_without_answers_says_so(
    tmp_path: Path, experiment: str, sweeps: str, told: str
) -> None:
    none = {number: (None, None) for number in range(12)}
    text = section(make_results(tmp_path, sweeps, none, experiment=experiment))
    assert f"Experiment {experiment}:" in text and told in text and not findings(text)


def test_the_studies_of_the_experiments_name_them() -> None:
    for number, name in enumerate(study.EXPERIMENTS, start=1):
        assert study.load(study.find(f"experiment_{number}")).experiment == name
