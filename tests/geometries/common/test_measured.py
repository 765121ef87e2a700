"""How values with errors, and intervals, are written: as the command writes them, to the digits that an error leaves."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from geometries.common.measured import measured, picofarad_interval, picofarads

IN_CPP = (Path(__file__).parents[2] / "model" / "cli" / "measured_test.cpp").read_text(encoding="utf-8")
CASES = re.findall(r'EXPECT_EQ\(measured\((-?[\d.e+-]+), (-?[\d.e+-]+)\), "(.*)"\);', IN_CPP)


@pytest.mark.parametrize(("value", "error", "text"), CASES)
def test_a_value_with_its_error_is_written_as_the_command_writes_it(
    value: str, error: str, text: str
) -> None:
    assert measured(float(value), float(error)) == text


def test_these_are_all_cases_of_the_command_with_finite_numbers() -> None:
    assert len(CASES) == IN_CPP.count("EXPECT_EQ(measured(") - 3


@pytest.mark.parametrize("error", [math.nan, math.inf])
def test_without_a_finite_error_a_value_is_unknown(error: float) -> None:
    assert measured(20.0, error) == "unknown"


def test_capacitances_are_given_in_farads() -> None:
    assert picofarads(2.4914e-12, 1.1e-15) == "2.4914 ± 0.0011"


@pytest.mark.parametrize(
    ("lower", "upper", "text"),
    [
        (2.49035e-12, 2.49245e-12, "[2.4903, 2.4925]"),
        (-2.49245e-12, -2.49035e-12, "[-2.4925, -2.4903]"),
        (4.882291e-16, 4.883898e-16, "[0.000488229, 0.000488390]"),
        (1234.5e-12, 4321.5e-12, "[1234, 4322]"),
        (math.nan, 1e-12, "unknown"),
    ],
)
def test_an_interval_is_rounded_outwards_to_two_digits_of_its_half_width(
    lower: float, upper: float, text: str
) -> None:
    assert picofarad_interval(lower, upper) == text
