"""The change of a reading as a quantity, and the statistics of errors by family and quantity, on numbers computed by hand."""

import csv
import math
from pathlib import Path

import pytest

from analysis.results import set_up, statistics, study_results as results, table
from analysis.results.answers import MatrixAnswer, ModelAnswer
from analysis.results.table import CHANGE, DELTA_SELF, MUTUAL, Row
from analysis.topics.trends import changes
from geometries.scene import reader
from geometries.studies import families
from tests import scenes
from tests.analysis.documents import model_document, reference_document
from tests.analysis.synthetic import MACHINES, MACHINE_ANSWERS, machine_document, make_results

SENSOR = scenes.sensor("front", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
HAND = scenes.body("hand", "cube", size=0.1, translation=[0, 0, 0.1])
WALL = HAND.replace("hand", "wall").replace("0.1]", "0.5]")
READING = scenes.table("reading", name="near", sense="front", drive=["front"])


@pytest.fixture
def rows(tmp_path: Path) -> list[Row]:
    return table.rows(results.load(make_results(tmp_path, MACHINES, MACHINE_ANSWERS)))


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (SENSOR + HAND, True),
        (SENSOR + HAND + WALL, True),
        (SENSOR + HAND + "target = true\n", True),
        (SENSOR + HAND + "target = true\n" + WALL, False),
        (SENSOR + HAND + READING, False),
        (SENSOR + HAND + WALL + 'potential = "electrode"\n', False),
    ],
)
def test_the_change_is_delta_self_where_nothing_stays_but_sensors(scene: str, expected: bool) -> None:
    assert set_up.is_delta_self(reader.loads(scene)) == expected


def test_a_case_before_a_machine_has_mutual_of_its_target_and_the_change_of_every_reading(
    rows: list[Row],
) -> None:
    assert [(row.machine, row.quantity, row.object, row.reading) for row in rows] == [
        ("none", MUTUAL, "target", ""),
        ("none", DELTA_SELF, "", ""),
        ("housing", MUTUAL, "target", ""),
        ("housing", CHANGE, "", "sensor"),
        ("housing+guard", MUTUAL, "target", ""),
        ("housing+guard", CHANGE, "", "sensor"),
        ("housing", CHANGE, "", "sensor"),
    ]
    assert all(row.sensor == "sensor" for row in rows)
    assert [row.is_change for row in rows] == [row.quantity != MUTUAL for row in rows]


def test_the_row_of_a_change_compares_the_readings_of_both_methods(rows: list[Row]) -> None:
    row = rows[3]
    assert (row.reference.value, row.reference.error) == (0.8e-12, 0.01e-12)
    assert row.model["exact"] == 1.8e-12
    assert row.model_error == pytest.approx(1.25)
    assert row.model_error_interval == pytest.approx((1.8 / 0.81 - 1, 1.8 / 0.79 - 1))
    assert row.check is None


def test_rows_without_a_value_of_the_model_are_empty_and_left_out_of_statistics(rows: list[Row]) -> None:
    unknown = [row for row in rows if not row.is_compared]
    assert [(row.quantity, row.model, row.model_seconds) for row in unknown] == [(CHANGE, {}, {})] * 2
    found = {(each.family, each.quantity): each for each in statistics.summaries(rows)}
    every = {(family, quantity) for family in ("all", "parallel") for quantity in (MUTUAL, DELTA_SELF)}
    assert set(found) == every | {("all", CHANGE), ("housing", CHANGE)}
    assert found["housing", CHANGE].count == 1 and found["housing", CHANGE].worst == pytest.approx(1.25)


def test_the_table_has_empty_cells_there_and_can_be_compared_with_itself(
    rows: list[Row], tmp_path: Path
) -> None:
    path = tmp_path / table.TABLE
    path.write_text(table.to_csv(rows, ("exact", "split:0")), encoding="utf-8")
    last = list(csv.DictReader(path.open(encoding="utf-8")))[-1]
    assert (last["quantity"], last["reading"], last["object"]) == (CHANGE, "sensor", "")
    empty = ["model_error", "model_error_low", "model_error_high", "model_exact_F", "model_split:0_seconds"]
    assert [last[name] for name in empty] == [""] * 5 and float(last["reference_F"]) == 0.1e-12
    found = changes.of_table(path)
    assert [each.kind for each in found if each.case == last["case"]] == ["field solver"]
    assert not changes.marks(found + found)


def test_answers_of_earlier_versions_have_no_readings_and_give_the_rows_they_gave(tmp_path: Path) -> None:
    assert MatrixAnswer.of(reference_document(2, 1)).readings == {}
    assert ModelAnswer.of(model_document(1.8)).changes == {"exact": {}, "split:0": {}, "split:4": {}}
    earlier = machine_document(1.6, 0.8)
    del earlier["readings"]
    answers = {**MACHINE_ANSWERS, 1: (earlier, MACHINE_ANSWERS[1][1])}
    found = table.rows(results.load(make_results(tmp_path, MACHINES, answers)))
    housing = [row for row in found if row.case.parameters["machine"] == "housing" and row.is_compared]
    assert [(row.quantity, row.object) for row in housing] == [
        (MUTUAL, "target"),
        (MUTUAL, "housing"),
        (DELTA_SELF, ""),
    ]
    assert not housing[-1].is_change


def test_a_scene_of_ones_own_has_a_machine_if_something_stays(tmp_path: Path) -> None:
    case = results.load(make_results(tmp_path)).compared()[0]
    for machine, told in (("none", "none"), ("table", table.OWN_MACHINE)):
        scene = families.parallel((0.1, 0.1), (0.1, 0.1), 0.02, machine=machine)
        own = {**vars(case), "scene": scene, "parameters": {"scene": "arm", "frame": "1"}}
        assert table.machine_of(results.CaseResult(**own)) == told


@pytest.fixture
def summaries(tmp_path: Path) -> dict[tuple[str, str], statistics.Summary]:
    """Three parallel cases off by −10 %, +20 %, −40 %, two edge cases off by 0 and +50 %."""
    models = [1.8, 2.4, 1.2, 2.0, 3.0]
    errors = [0.01, 0.02, 0.01, 0.01, 0.05]
    answers = {
        number: (reference_document(2, 1, error=error), model_document(model))
        for number, (model, error) in enumerate(zip(models, errors))
    }
    found = statistics.summaries(table.rows(results.load(make_results(tmp_path, answers=answers))))
    return {(summary.family, summary.quantity): summary for summary in found}


@pytest.mark.parametrize(
    ("family", "squares", "median", "worst", "sure_to"),
    [
        ("parallel", (0.01, 0.04, 0.16), 0.2, -0.4, 0.01),
        ("all", (0.01, 0.04, 0.16, 0, 0.25), 0.2, 0.5, 0.025),
    ],
)
def test_the_numbers_of_a_family_and_of_all(
    summaries: dict[tuple[str, str], statistics.Summary],
    family: str,
    squares: tuple[float, ...],
    median: float,
    worst: float,
    sure_to: float,
) -> None:
    found = summaries[family, "mutual"]
    assert found.count == len(squares)
    assert found.rms == pytest.approx(math.sqrt(sum(squares) / len(squares)))
    assert (found.median, found.worst) == (pytest.approx(median), pytest.approx(worst))
    assert found.sure_to == pytest.approx(sure_to)


def test_the_headline_tells_both_quantities_apart(
    summaries: dict[tuple[str, str], statistics.Summary]
) -> None:
    mutual, delta_self = statistics.headline(list(summaries.values())).splitlines()
    assert mutual.startswith("mutual") and "worst +50.0%" in mutual and "2.5 %" in mutual
    assert delta_self.startswith("delta_self")
