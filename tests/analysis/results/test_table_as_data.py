"""`table.csv` as others read it: pandas, without any option, finds numbers where there are numbers, and units in the names."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pandas
import pytest

from analysis.results import table
from analysis.study import report
from tests.analysis.synthetic import (
    PARALLEL,
    empty_document,
    make_results,
    model_document,
    reference_document,
)

TEXTS = {"case", "family", "parameters", "sensor", "object", "reading", "quantity", "command"}
TEXTS |= {"answered_by", "reference_error_kind", "field_error_kind"}
RATIOS = {
    "gap_over_size",
    "lateral_offset_over_size",
    "size_ratio",
    "model_error",
    "model_error_low",
    "model_error_high",
}
UNITS = ("_F", "_degrees", "_seconds")
COUNTS = {"reference_unknowns"}


@pytest.fixture
def frame(tmp_path: Path) -> pandas.DataFrame:
    """Three cases; the first has a reference that may be zero, the second a check of delta_self, the third an infinite model."""
    answers = {
        0: (reference_document(2, 1, error=3), model_document(1.8)),
        1: (reference_document(2, 1), model_document(1.8)),
        2: (reference_document(2, 1), model_document(float("inf"))),
        3: (empty_document(), None),
    }
    folder = make_results(tmp_path, PARALLEL, answers)
    report.make(folder)
    return pandas.read_csv(folder / "table.csv")


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
