"""Boundary elements beside the field solver: what agrees, what both prove together, what is refused, and that it is kept."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.pipeline import model_stage
from analysis.pipeline.stage import NoAnswer
from analysis.results import store, study_results as results
from analysis.results.study_results import Results
from analysis.study import report
from analysis.topics import cross_check
from geometries.scene import reader
from geometries.scene.scene import Scene
from geometries.scene.shapes import Sphere
from geometries.scene.writer import canonical
from geometries.studies import families, study
from geometries.studies.study import Study
from tests.analysis.documents import PICO, boundary_document, reference_document
from tests.analysis.synthetic import (
    HEAD,
    MACHINES,
    MACHINE_ANSWERS,
    PARALLEL,
    machine_document,
    make_results,
    report_text,
)


def with_boundary(folder: Path, **documents: dict[str, Any]) -> Results:
    """Results whose cases, by their number as c0, c1 …, have these answers by boundary elements."""
    for number, case in enumerate(results.load(folder).compared()):
        if f"c{number}" in documents:
            store.write_json(
                case.folder / results.BOUNDARY, {"key": "", "rtol": 1e-4, **documents[f"c{number}"]}
            )
    return results.load(folder)


def enclosed(low: float, high: float) -> dict[str, Any]:
    """The reference's answer with every entry enclosed: the own ones of 5 pF from `low` to `high`."""
    lower, upper = [[low, -2.1], [-2.1, low]], [[high, -1.9], [-1.9, high]]
    return reference_document(2, 1) | {
        "error_kind": "enclosure",
        "lower": (PICO * np.array(lower)).tolist(),
        "upper": (PICO * np.array(upper)).tolist(),
    }


def test_changes_of_readings_are_compared_where_they_are_not_delta_self(tmp_path: Path) -> None:
    """The reference says 0.8 ± 0.01 pF before the housing; boundary elements are sure to 0.001."""
    solved = make_results(tmp_path, MACHINES, MACHINE_ANSWERS)
    both = machine_document(1.6, 0.812, error=0.001) | {"lower_bounds": [True] * 3}
    found = cross_check.comparisons(with_boundary(solved, c0=boundary_document(2, 1), c1=both))
    names = [each.what for each in found if "change" in each.what or "delta" in each.what]
    assert sorted(names) == ["change sensor", "delta_self sensor", "delta_self sensor"]
    (change,) = (each for each in found if each.what == "change sensor")
    assert not change.agrees and change.over_errors == pytest.approx(0.012 / 0.011)
    assert change.case.parameters["machine"] == "housing"


def test_values_agree_as_long_as_their_error_bars_overlap(tmp_path: Path) -> None:
    # The reference says 2 ± 0.01 and 1 ± 0.01 pF, boundary elements are sure to 0.001.
    found = cross_check.comparisons(
        with_boundary(
            make_results(tmp_path), c0=boundary_document(2.0109, 1), c1=boundary_document(2.0111, 1)
        )
    )
    assert len(found) == 2 * (3 + 1)
    assert found[0].what == "M[sensor, target]" and not found[0].agrees and found[1].agrees
    assert found[0].over_errors == pytest.approx(0.0111 / 0.011)
    assert found[1].over_errors == pytest.approx(0.0109 / 0.011)
    assert found[0].difference == pytest.approx(-0.0111 / 2)
    assert all(comparison.agrees for comparison in found[1:])


def test_an_enclosure_is_left_on_the_side_where_it_ends(tmp_path: Path) -> None:
    folder = make_results(tmp_path, answers={0: (enclosed(4.99, 5.5), None), 1: (enclosed(4.5, 5.01), None)})
    low = boundary_document(2, 0.9)  # diagonal entries 4.9 pF
    found = with_boundary(folder, c0=low, c1=low)
    own = {c.case.id: c for c in cross_check.comparisons(found) if c.what == "M[sensor, sensor]"}
    first, second, *_ = found.compared()
    assert not own[first.id].agrees and own[second.id].agrees


def test_an_own_entry_lies_between_galerkins_bound_and_the_field_solvers(tmp_path: Path) -> None:
    folder = make_results(tmp_path, answers={0: (enclosed(4.9, 5.02), None), 1: (enclosed(4.9, 5.02), None)})
    document = boundary_document(2, 1, error=0.01)
    found = with_boundary(folder, c0=document, c1=document | {"lower_bounds": [False, True]})
    brackets = cross_check.brackets(found)
    assert [bracket.conductor for bracket in brackets] == ["sensor", "target", "target"]
    for bracket in brackets:
        assert bracket.lower == pytest.approx((5 - 0.05 * 0.01) * PICO)
        assert bracket.width == pytest.approx(0.0205 / 5.02)
        assert bracket.width_before == pytest.approx(0.12 / 5.02)
    assert cross_check.contradictions(found) == 0
    assert "3 diagonal entries" in cross_check.bracket_finding(
        brackets
    ) and "empty" not in cross_check.bracket_finding(brackets)


def test_a_lower_bound_above_the_upper_one_is_a_contradiction_though_error_bars_overlap(
    tmp_path: Path,
) -> None:
    folder = make_results(tmp_path, answers={0: (enclosed(4.9, 5.02), None)})
    found = with_boundary(folder, c0=boundary_document(2, 1.03, error=0.05))
    assert not cross_check.disagreements(cross_check.comparisons(found))
    assert cross_check.contradictions(found) == 2
    assert "2 brackets are empty" in cross_check.bracket_finding(cross_check.brackets(found))


def test_disagreements_are_told_first_in_the_report_and_on_the_page(tmp_path: Path) -> None:
    folder = make_results(tmp_path)
    with_boundary(folder, c0=boundary_document(2, 1))
    text = report_text(folder)
    assert "4 of 4 values agree" in text and "values of the two references disagree" not in text
    with_boundary(folder, c0=boundary_document(2, 1), c1=boundary_document(2.5, 1))
    assert report.make(folder).disagreements == 1
    head = (folder / "report.html").read_text().partition("<header>")[0]
    assert "1 values of the two references disagree" in head
    page = (folder / "report" / "cross_check.html").read_text()
    listed = re.findall(r"<h3>Values that disagree</h3>(.*?)</table>", page, re.DOTALL)
    assert len(listed) == 1 and listed[0].count("<strong>no</strong>") == 1


def test_what_is_refused_is_told_with_its_reason_and_counts_nowhere(tmp_path: Path) -> None:
    found = with_boundary(
        make_results(tmp_path), c0=boundary_document(2, 1), c1={"refused": "a <sphere> is round"}
    )
    text = "".join(cross_check.sections(found))
    assert "In 1 set-ups both methods answer" in text
    assert "1 set-ups are not comparable" in text and "a &lt;sphere&gt; is round" in text


def test_the_page_of_a_case_has_both_matrices(tmp_path: Path) -> None:
    folder = make_results(tmp_path)
    case, *_ = with_boundary(folder, c0=boundary_document(2.25, 1)).compared()
    report.make(folder)
    page = (case.folder / "case.html").read_text()
    assert "By boundary elements" in page and "−2.2500 ± 0.0010" in page and "boundary.json" in page
    assert f"cases/{case.id}/scene.toml --method boundary-elements --rtol 0.0001" in page


BESIDE = replace(study.loads(HEAD + PARALLEL), rtol=1e-2)
"""A study that asks both methods for 1 %."""


def stored(scene: Scene, folder: Path, asked: Study = BESIDE) -> dict[str, Any]:
    """What the stage stores of a scene."""
    store.write_text(folder / "scene.toml", canonical(scene))
    return model_stage.boundary_answer(folder / "scene.toml", asked)


def test_what_boundary_elements_answer_and_what_they_refuse_is_kept(tmp_path: Path) -> None:
    """Plates and boxes are answered, grounded or floating. A polyhedron is not the round body that the field solver meshes."""
    plates = families.parallel((0.1, 0.1), (0.1, 0.1), 0.04)
    answer = stored(plates, tmp_path / "plates")
    assert answer["conductors"] == ["sensor", "target"] and answer["reached"] and answer["rtol"] == 1e-3
    box = stored(families.box((0.1, 0.1), (0.1, 0.1), 0.04, 0.02, material="floating"), tmp_path / "box")
    assert box["conductors"] == ["sensor"] and box["delta_self"]["sensor"]["value"] > 0
    (target,) = plates.objects
    refused = stored(replace(plates, objects=(replace(target, relative_permittivity=3.0),)), tmp_path)
    assert set(refused) == {"rtol", "refused"}
    assert "target" in refused["refused"] and str(tmp_path) not in refused["refused"]
    ball = replace(plates, objects=(replace(target, shape=Sphere(0.02)),))
    assert "polyhedron" in stored(ball, tmp_path)["refused"]
    (tmp_path / "scene.toml").unlink()
    with pytest.raises(NoAnswer, match="scene.toml"):
        model_stage.boundary_answer(tmp_path / "scene.toml", BESIDE)


def test_boundary_elements_are_asked_for_a_tenth_of_plates_and_for_the_studys_tolerance_of_others(
    tmp_path: Path,
) -> None:
    plates = families.parallel((0.1, 0.1), (0.1, 0.1), 0.04)
    (tmp_path / "wall.obj").write_text("v 0 0 0\nv .05 0 0\nv .05 .05 0\nv 0 .05 0\nf 1 2 3 4\n")
    scene = canonical(plates).split("[object.shape]")[0]
    store.write_text(tmp_path / "scene.toml", scene + '[object.shape]\ntype = "mesh"\nfile = "wall.obj"\n')
    mesh = reader.load(tmp_path / "scene.toml")
    box = families.box((0.1, 0.1), (0.1, 0.1), 0.04, 0.02, material="dielectric", relative_permittivity=3)
    assert [model_stage.boundary_rtol(BESIDE, scene) for scene in (plates, mesh, box)] == [1e-3, 1e-2, 1e-2]
    alone = replace(BESIDE, reference_method=study.BOUNDARY_ELEMENTS)
    assert model_stage.boundary_rtol(alone, plates) == 1e-2
    answer = stored(mesh, tmp_path / "stored")
    assert answer["rtol"] == 1e-2 and answer["reached"]
