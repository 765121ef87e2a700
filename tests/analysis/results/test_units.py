"""How reports write numbers and name cases: as the command does, to the digits that an error leaves."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from analysis.results.units import in_words, measured, of_cases, picofarads, signed_percent, too

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


SQUARE = (0.1, 0.1)


def test_parameters_are_written_with_lengths_in_centimetres() -> None:
    words = in_words(
        {"sensor_size": (0.1, 0.05), "hinge_gap": 0.0137, "offset": (0.04, 0.0), "tilt_degrees": 30.0}
    )
    assert words == "sensor size 10 × 5 cm, hinge gap 1.37 cm, offset 4 and 0 cm, tilt 30°"


def test_a_capacitance_has_its_own_unit_and_a_permittivity_none() -> None:
    assert (
        in_words({"to_ground": 2e-11, "relative_permittivity": 50.0})
        == "to ground 20 pF, relative permittivity 50"
    )


def test_what_is_so_without_being_said_is_left_out() -> None:
    assert in_words({"material": "grounded", "to_ground": 0.0, "machine": "none", "gap": 0.02}) == "gap 2 cm"
    assert in_words({"material": "floating", "machine": "housing"}) == "material floating, machine housing"


def test_a_case_is_named_by_what_most_of_its_family_do_not_share() -> None:
    usual = [("parallel", {"sensor_size": SQUARE, "gap": gap}) for gap in (0.01, 0.02, 0.04)]
    odd = ("parallel", {"sensor_size": (0.04, 0.04), "gap": 0.04})
    assert of_cases([*usual, odd]) == [
        "parallel, gap 1 cm",
        "parallel, gap 2 cm",
        "parallel, gap 4 cm",
        "parallel, sensor size 4 × 4 cm, gap 4 cm",
    ]


def test_a_case_that_is_usual_in_everything_is_named_by_all_that_varies() -> None:
    cases = [("edge", {"gap": gap, "height": 0.0}) for gap in (0.01, 0.01, 0.01, 0.02)]
    assert of_cases(cases)[0] == "edge, gap 1 cm"


def test_the_only_case_of_a_family_is_named_by_its_family() -> None:
    assert of_cases([("corner", {"gap": 0.01}), ("empty", {"sensor_size": SQUARE})]) == [
        "corner",
        "sensor alone",
    ]


def test_frames_of_a_motion_are_named() -> None:
    cases = [("scene", {"scene": "hand", "frame": frame}) for frame in ("1 far", "2 near")]
    assert of_cases(cases) == ["scene, frame 1 far", "scene, frame 2 near"]


def test_different_parameters_have_different_names() -> None:
    cases = [
        ("parallel", {"gap": gap, "offset": (x, 0.0)})
        for gap in (0.01, 0.02, 0.03)
        for x in (0.0, 0.0125, 0.05)
    ]
    assert len(set(of_cases(cases))) == len(cases)
