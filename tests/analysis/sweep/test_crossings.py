"""Where a change crosses its threshold: computed by hand, with the interval that the error allows."""

from __future__ import annotations

import math

import pytest

from analysis.sweep.series import Crossing, crossings


def test_a_power_law_crosses_at_its_exact_place() -> None:
    """Changes 1, 10, 100 are exponential in the frame: 31.6 lies halfway between the second and the third."""
    (found,) = crossings([1.0, 10.0, 100.0], [0.0, 0.0, 0.0], math.sqrt(1000))
    assert found.at == pytest.approx(2.5, abs=1e-12) and found.rises
    assert (found.first, found.last) == (pytest.approx(2.5), pytest.approx(2.5))


def test_the_error_widens_the_place_to_an_interval() -> None:
    """With an error of half each value the curves are 1.5 and 0.5 times the change."""
    (found,) = crossings([1.0, 10.0, 100.0], [0.5, 5.0, 50.0], 10**1.5)
    assert found.first == pytest.approx(2.5 - math.log10(1.5)) and found.last == pytest.approx(
        2.5 + math.log10(2)
    )


def test_what_falls_crosses_the_other_way_round() -> None:
    (found,) = crossings([100.0, 10.0, 1.0], [50.0, 5.0, 0.5], 10**1.5)
    assert not found.rises and found.at == pytest.approx(1.5)
    assert found.first == pytest.approx(1.5 - math.log10(2)) and found.last == pytest.approx(
        1.5 + math.log10(1.5)
    )


def test_an_error_that_reaches_beyond_the_motion_leaves_an_end_open() -> None:
    assert crossings([8.0, 12.0], [3.0, 1.5], 10.0)[0].first is None
    assert crossings([8.0, 12.0], [1.0, 3.0], 10.0)[0].last is None


def test_the_sign_of_a_change_does_not_count() -> None:
    assert crossings([-1.0, -100.0], [0.0, 0.0], 10.0) == [Crossing(1.5, 1.5, 1.5, True)]


def test_a_zero_is_interpolated_by_itself_and_what_is_unknown_is_left_out() -> None:
    assert crossings([0.0, 4.0], [0.0, 0.0], 1.0)[0].at == 1.25
    assert crossings([1.0, None, 4.0], [0.0, 0.0, 0.0], 2.0) == []


def test_every_crossing_is_found() -> None:
    found = crossings([1.0, 4.0, 1.0], [0.0, 0.0, 0.0], 2.0)
    assert [(each.at, each.rises) for each in found] == [(1.5, True), (2.5, False)]
