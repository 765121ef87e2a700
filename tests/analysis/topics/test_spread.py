"""The spread of numbers: median and range, errors about a true number, and what is not finite."""

import math

import pytest

from analysis.topics.spread import range_of, ratio, spread


def test_errors_are_about_the_true_number_and_the_range_is_of_the_numbers() -> None:
    found = spread([0.8, 1.1, 1.6, math.nan, math.inf], true=1.0)
    assert found is not None and found.count == 3
    assert (found.median, found.least, found.greatest) == (1.1, 0.8, 1.6)
    assert found.worst == pytest.approx(0.6)
    assert found.rms == pytest.approx(math.sqrt((0.04 + 0.01 + 0.36) / 3))
    assert range_of(found) == found.range == "1.1 (0.8 to 1.6)"


def test_the_worst_keeps_its_sign() -> None:
    found = spread([-3.0, 2.0])
    assert found is not None and found.worst == -3 and found.least == -3 and found.greatest == 2


def test_there_is_none_without_numbers() -> None:
    assert spread([]) is None and spread([math.nan]) is None and range_of(None) == ""


def test_large_ratios_keep_all_their_digits() -> None:
    assert [ratio(value) for value in (0.12345, 63.84, -5735.2)] == ["0.123", "63.8", "-5735"]
