"""How reports write numbers: as the command does, to the digits that an error leaves."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from analysis.results.units import measured, picofarads, signed_percent, too

IN_CPP = (Path(__file__).parents[2] / "model" / "cli" / "measured_test.cpp").read_text(encoding="utf-8")
CASES = re.findall(r'EXPECT_EQ\(measured\((-?[\d.e+-]+), (-?[\d.e+-]+)\), "(.*)"\);', IN_CPP)


@pytest.mark.parametrize(("value", "error", "text"), CASES)
def test_a_value_with_its_error_is_written_as_the_command_writes_it(
    value: str, error: str, text: str
) -> None:
    assert measured(float(value), float(error)) == text


def test_these_are_all_cases_of_the_command_with_finite_numbers() -> None:
    assert len(CASES) == IN_CPP.count("EXPECT_EQ(measured(") - 2


@pytest.mark.parametrize("error", [math.nan, math.inf])
def test_without_a_finite_error_a_value_is_unknown(error: float) -> None:
    assert measured(20.0, error) == "unknown"


def test_capacitances_are_given_in_farads() -> None:
    assert picofarads(2.4914e-12, 1.1e-15) == "2.4914 ± 0.0011"


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
