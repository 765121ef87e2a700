"""What a page says of readings by two methods: how many agree, what lies apart, and every number."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from analysis.results.answers import Estimate
from analysis.topics import field_section
from analysis.topics.company.set_ups import SetUp
from analysis.topics.company.topic import CHECK, chosen
from analysis.topics.field_solver import Comparison

PICO = 1e-12
PROVEN = (1.99 * PICO, 2.03 * PICO)


def made_up(
    over_errors: float, proven: tuple[float, float] = (-math.inf, math.inf)
) -> list[Comparison[SetUp]]:
    """Two values that agree, and one whose methods differ by so many times their errors."""
    field, background = Estimate(2 * PICO, 0.01 * PICO), Estimate(PICO, 0.01 * PICO)
    apart = Estimate(2 * PICO + over_errors * 0.015 * PICO, 0.005 * PICO)
    return [
        Comparison(chosen()[0], "value", field, field),
        Comparison(chosen()[0], "background", background, background),
        Comparison(chosen()[0], "change", field, apart, proven),
    ]


def test_a_difference_beyond_the_errors_is_told_with_its_set_up() -> None:
    agreeing, apart = made_up(0.5), made_up(2.0)
    assert [each.over_errors for each in agreeing] == pytest.approx([0, 0, 0.5])
    assert agreeing[2].difference == pytest.approx(0.00375) and agreeing[2].allowed == pytest.approx(0.0075)
    told = field_section.finding(CHECK, agreeing)
    assert "In 1 set-ups" in told and "3 of 3 values agree" in told and "proves" not in told
    assert (
        "change 1 of 1 within the errors and 1 within 0.5 %, at most 0.50 of the errors and +0.38 %" in told
    )
    told = field_section.finding(CHECK, apart)
    assert "2 of 3 values agree" in told
    assert told.endswith(f"Beyond their errors: change of set-up {chosen()[0].id} (2.00).")


def test_proven_intervals_are_counted_and_what_lies_outside_is_told() -> None:
    check = replace(CHECK, quantities=("change",))
    whole, outside = ([made_up(over, PROVEN)[2]] for over in (0.5, 3.0))
    assert "1 of 1 values by boundary elements lie in the interval" in field_section.finding(check, whole)
    assert "half-width is 1 % of the value" in field_section.finding(check, whole)
    told = field_section.finding(check, outside)
    assert "0 of 1 values by" in told and told.endswith(f"change of set-up {chosen()[0].id} (3.00).")
    text = "".join(field_section.parts(check, whole))
    assert "1.99 and 2.03" in text and "<td>yes</td>" in text


def test_the_section_shows_the_comparison_or_says_that_there_is_none() -> None:
    text = "".join(field_section.parts(CHECK, made_up(0.5)))
    assert text.count("plotly-graph-div") == 1 and "2.000 ± 0.010" in text and "<td>0.50</td>" in text
    assert chosen()[0].machine in text and "forty minutes" in text and "within</th>" not in text
    assert field_section.ABSENT in "".join(field_section.parts(CHECK, []))
