"""`table.csv`: its rows, the reference's error carried into the model error, the commands that recompute, and what pandas finds in it.
How reports name cases and differences."""

import csv
import io
import json
import math
import re
from pathlib import Path

import numpy as np
import pandas
import pytest

from analysis.results import study_results as results, table
from analysis.results.answers import Estimate
from analysis.results.units import in_words, of_cases, signed_percent, too
from geometries.studies.study import Parameter
from tests.analysis.documents import empty_document, model_document, reference_document
from tests.analysis.synthetic import ONE_CASE, PARALLEL, enclosed, make_results


def rows_of(tmp_path: Path, reference: dict[str, object], model: float) -> list[table.Row]:
    return table.rows(results.load(make_results(tmp_path, ONE_CASE, {0: (reference, model_document(model))})))


def test_each_case_gives_a_row_for_mutual_and_one_for_delta_self(tmp_path: Path) -> None:
    mutual, delta_self = rows_of(tmp_path, reference_document(2, 1), 1.8)
    assert (mutual.sensor, mutual.object, mutual.quantity) == ("sensor", "target", "mutual")
    assert (delta_self.sensor, delta_self.object, delta_self.quantity) == ("sensor", "", "delta_self")
    assert (mutual.reference.value, delta_self.reference.value) == (2e-12, 1e-12)


def test_the_model_error_and_its_interval_computed_by_hand(tmp_path: Path) -> None:
    """Model 1.8, reference 2.0 ± 0.1: −10 %, at least (1.8 − 2.1)/2.1 = −1/7 and at most (1.8 − 1.9)/1.9 = −1/19."""
    mutual, _ = rows_of(tmp_path, reference_document(2, 1, error=0.1), 1.8)
    assert mutual.model_error == pytest.approx(-0.1)
    assert mutual.model_error_interval == pytest.approx((-1 / 7, -1 / 19))
    assert mutual.reference_error == pytest.approx(0.05)


def test_an_enclosure_counts_as_far_as_its_farther_end(tmp_path: Path) -> None:
    """M = [[5, −2], [−2, 5]] in pF, each entry between 0.2 below and 0.1 above: mutual 2 may be 2.2."""
    mutual, _ = rows_of(tmp_path, enclosed(reference_document(2, 1), 0.2, 0.1), 1.8)
    assert mutual.reference_error == pytest.approx(0.1)


def test_the_interval_has_no_upper_end_when_the_reference_may_be_zero() -> None:
    low, high = table.error_interval(1.0, Estimate(0.5, 0.6))
    assert low == pytest.approx(1 / 1.1 - 1)
    assert high == math.inf


def test_the_check_of_delta_self_is_the_difference_of_two_solves_with_both_errors(tmp_path: Path) -> None:
    """M[s,s] is 5 ± 0.1 pF with the target and 4 ± 0.01 pF without."""
    _, delta_self = rows_of(tmp_path, reference_document(2, 1, error=0.1), 1.8)
    assert delta_self.check is not None
    assert delta_self.check.value == pytest.approx(1e-12)
    assert delta_self.check.error == pytest.approx(0.11e-12)
    assert delta_self.reference.agrees_with(delta_self.check)


def test_cases_without_both_answers_give_no_row(tmp_path: Path) -> None:
    answers = {0: (None, model_document(1)), 1: (reference_document(2, 1), None)}
    found = table.rows(results.load(make_results(tmp_path, PARALLEL, answers)))
    assert {row.case.parameters["gap"] for row in found} == {0.04}


def test_what_methods_of_the_model_state_themselves_has_columns(tmp_path: Path) -> None:
    document = model_document(1.8)
    sensor = document["methods"]["split:4"]["sensors"][0]
    sensor |= {"delta_self": 0.9e-12, "delta_self_error": 2e-15}
    sensor["objects"][0] |= {"error": 1e-15, "answered_by": "reduced"}
    folder = make_results(tmp_path, ONE_CASE, {0: (reference_document(2, 1), document)})
    found = table.rows(results.load(folder))
    mutual, delta_self = csv.DictReader(io.StringIO(table.to_csv(found, ("exact", "split:4"))))
    assert (mutual["model_split:4_error_F"], mutual["model_split:4_answered_by"]) == ("1e-15", "reduced")
    assert (delta_self["model_split:4_F"], delta_self["model_split:4_error_F"]) == ("9e-13", "2e-15")
    assert "model_exact_error_F" not in mutual


def test_the_commands_name_the_scene_of_the_case_and_survive_spaces(tmp_path: Path) -> None:
    folder = make_results(tmp_path / "with space", ONE_CASE)
    loaded = results.load(folder)
    case = loaded.compared()[0]
    scene = f"'{folder}/cases/{case.id}/scene.toml'"
    assert results.reference_command(loaded, case.id) == (
        f"python3 -m fem_reference {scene} --rtol 0.001 --max-seconds 60 --error estimate"
    )
    assert results.model_command(loaded, case.id) == f"build/bin/fringe capacitance {scene} --method exact"


TEXTS = {"case", "family", "parameters", "sensor", "object", "reading", "quantity", "command"}
TEXTS |= {"answered_by", "reference_error_kind", "field_error_kind"}
RATIOS = {"gap_over_size", "lateral_offset_over_size", "size_ratio"}
RATIOS |= {"model_error", "model_error_low", "model_error_high"}
UNITS = ("_F", "_degrees", "_seconds")
COUNTS = {"reference_unknowns"}


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> pandas.DataFrame:
    """Three cases; the first has a reference that may be zero, the second a check of delta_self, the third an infinite model."""
    answers = {
        0: (reference_document(2, 1, error=3), model_document(1.8)),
        1: (reference_document(2, 1), model_document(1.8)),
        2: (reference_document(2, 1), model_document(float("inf"))),
        3: (empty_document(), None),
    }
    found = results.load(make_results(tmp_path_factory.mktemp("frame"), PARALLEL, answers))
    return pandas.read_csv(io.StringIO(table.to_csv(table.rows(found), found.methods)))


def test_every_column_is_of_one_kind(frame: pandas.DataFrame) -> None:
    assert len(frame) == 6
    for name in frame.columns:
        kind = frame[name].dtype
        if name in TEXTS:
            assert all(isinstance(value, str) for value in frame[name].dropna())
        elif name == "reached":
            assert kind == np.bool_
        elif name in COUNTS:
            assert kind == np.int64
        else:
            assert kind == np.float64, name


def test_every_number_has_its_unit_in_its_name_or_has_none(frame: pandas.DataFrame) -> None:
    for name in frame.columns.difference([*TEXTS, *COUNTS, *RATIOS, "reached"]):
        assert name.endswith(UNITS), name


def test_every_column_is_described(frame: pandas.DataFrame) -> None:
    described = set(
        re.findall(r"\w+", " ".join(re.findall(r"^\| ([\w, ]+) \|", table.__doc__ or "", re.MULTILINE)))
    )
    described -= {"model_METHOD_error_F", "model_METHOD_answered_by"}  # only of methods that state errors
    names = {re.sub(r"^model_(exact|split:\d+)_", "model_METHOD_", name) for name in frame.columns}
    assert names == described - {"column"}


def test_numbers_survive_with_all_their_digits(frame: pandas.DataFrame) -> None:
    exact = frame[frame["case"] == frame["case"].iloc[2]]
    mutual = exact[exact["quantity"] == "mutual"].iloc[0]
    assert (mutual["reference_F"], mutual["model_exact_F"]) == pytest.approx((2e-12, 1.8e-12), rel=1e-15)
    # pandas reads decimals to the last digit but one.
    assert mutual["model_error"] == pytest.approx(-0.1, rel=1e-14)
    assert json.loads(mutual["parameters"])["gap"] == 0.02


def test_what_is_infinite_is_infinite_and_what_is_absent_is_no_number(frame: pandas.DataFrame) -> None:
    assert frame["model_error_high"].iloc[0] == np.inf
    assert np.isinf(frame["model_exact_F"].iloc[4:]).any()
    assert frame["check_F"].isna().any()
    assert frame.loc[frame["quantity"] == "delta_self", "object"].isna().all()


def test_a_difference_without_an_upper_end_is_told_in_words() -> None:
    assert signed_percent(math.inf) == "without limit"


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (25.27, "26 times too high"),
        (1234.0, "1,200 times too high"),
        (0.123, "12 % too high"),
        (1.9, "190 % too high"),
        (-0.123, "12 % too low"),
        (-0.8, "5 times too low"),
        (-1.0, "100 % too low"),
        (-1.2, "of the wrong sign"),
        (0.0, "exact"),
        (math.inf, "too high without limit"),
        (math.nan, "unknown"),
    ],
)
def test_errors_are_told_as_people_say_them(error: float, words: str) -> None:
    assert too(error) == words


SQUARE = (0.1, 0.1)


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        (
            {"sensor_size": (0.1, 0.05), "hinge_gap": 0.0137, "offset": (0.04, 0.0), "tilt_degrees": 30.0},
            "sensor size 10 × 5 cm, hinge gap 1.37 cm, offset 4 and 0 cm, tilt 30°",
        ),
        ({"to_ground": 2e-11, "relative_permittivity": 50.0}, "to ground 20 pF, relative permittivity 50"),
        ({"material": "floating", "machine": "housing"}, "material floating, machine housing"),
        # Parameters that have their default values are left out.
        ({"material": "grounded", "to_ground": 0.0, "machine": "none", "gap": 0.02}, "gap 2 cm"),
    ],
)
def test_parameters_are_written_with_their_units(parameters: dict[str, Parameter], words: str) -> None:
    assert in_words(parameters) == words


USUAL = [("parallel", {"sensor_size": SQUARE, "gap": gap}) for gap in (0.01, 0.02, 0.04)]


@pytest.mark.parametrize(
    ("cases", "names"),
    [
        pytest.param(
            [*USUAL, ("parallel", {"sensor_size": (0.04, 0.04), "gap": 0.04})],
            [*(f"parallel, gap {gap} cm" for gap in (1, 2, 4)), "parallel, sensor size 4 × 4 cm, gap 4 cm"],
            id="by what most of its family do not share",
        ),
        pytest.param(
            [("edge", {"gap": gap, "height": 0.0}) for gap in (0.01, 0.01, 0.01, 0.02)],
            [*3 * ["edge, gap 1 cm"], "edge, gap 2 cm"],
            id="by all that varies if it is usual in everything",
        ),
        pytest.param(
            [("corner", {"gap": 0.01}), ("empty", {"sensor_size": SQUARE})],
            ["corner", "sensor alone"],
            id="by its family if it is the only one",
        ),
        pytest.param(
            [("scene", {"scene": "hand", "frame": frame}) for frame in ("1 far", "2 near")],
            ["scene, frame 1 far", "scene, frame 2 near"],
            id="by its frame",
        ),
    ],
)
def test_a_case_is_named(cases: list[tuple[str, dict[str, Parameter]]], names: list[str]) -> None:
    assert of_cases(cases) == names


def test_different_parameters_have_different_names() -> None:
    cases = [
        ("parallel", {"gap": gap, "offset": (x, 0.0)})
        for gap in (0.01, 0.02, 0.03)
        for x in (0.0, 0.0125, 0.05)
    ]
    assert len(set(of_cases(cases))) == len(cases)
