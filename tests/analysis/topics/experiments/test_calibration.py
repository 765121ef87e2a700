"""Tuning finds the constants that a curve was made with, knows how sure it is, and predicts with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from analysis.results.answers import Estimate
from analysis.topics.experiments.calibration import (
    FORMS,
    OWN,
    OWN_BY_BARS,
    THESIS,
    Form,
    calibrate,
    deviation,
    summary,
    untuned,
)
from analysis.topics.experiments.claims import LARGER_PLATE, SMALLER_PLATE, for_plate, hold
from analysis.topics.experiments.curves import Curve, Divider, Point
from tests.analysis.synthetic import PICO

CAPACITANCES = np.geomspace(0.4, 18, 9)[::-1]
DISTANCES = np.geomspace(0.005, 0.2, 9)


def made(reference: NDArray[np.float64], own: float = 4, error: float = 1e-3) -> Curve:
    """A curve of the model's capacitances above with given reference values in V."""
    points = tuple(
        Point("case", float(at), float(model) * PICO, Estimate(float(value), error), *[Estimate(1, 0)] * 2)
        for at, model, value in zip(DISTANCES, CAPACITANCES, reference)
    )
    return Curve("parallel", {"target_size": (0.1, 0.1)}, Estimate(own * PICO, 0), 5 * PICO, 2.5, points)


def truth(coupling: float, own: float, permittivity: float) -> NDArray[np.float64]:
    """Delta output of a sensor that is just the model with these constants, pF."""
    return Divider(coupling * PICO, own * PICO, 2.5).delta_output(permittivity * CAPACITANCES * PICO)


@pytest.mark.parametrize("form", [OWN, OWN_BY_BARS])
def test_both_constants_are_found_where_the_own_capacitance_counts(form: Form) -> None:
    found = calibrate(made(truth(7, 4, 0.8)), form)
    assert found.coupling.value == pytest.approx(7 * PICO, rel=1e-6)
    assert found.permittivity.value == pytest.approx(0.8, rel=1e-6)
    assert found.misfit < 1e-6 and found.determined


def test_in_the_thesis_divider_only_the_ratio_counts() -> None:
    curve = made(truth(7, 0, 0.8))
    found = calibrate(curve, THESIS)
    assert found.permittivity.value / found.coupling.value == pytest.approx(0.8 / (7 * PICO), rel=1e-6)
    assert (found.coupling.value, found.coupling.error) == (5 * PICO, 0)
    twice = calibrate(replace(curve, coupling=10 * PICO), THESIS)
    assert twice.permittivity.value == pytest.approx(2 * found.permittivity.value)
    assert twice.predict(curve) == pytest.approx(found.predict(curve))


def test_standard_errors_are_the_scatter_over_noisy_curves() -> None:
    noise, exact = 2e-3, truth(5, 4, 0.9)
    random = np.random.default_rng(6)
    found = [
        calibrate(made(exact + noise * random.standard_normal(9), error=noise), OWN_BY_BARS)
        for _ in range(200)
    ]
    # Per degree of freedom, of which there are seven: the mean square of 200 draws is sure to 0.04.
    assert np.mean([each.misfit**2 for each in found]) == pytest.approx(1, abs=0.12)
    # 200 draws know a scatter to 5 %; Birge's ratio, of at least one, adds to the errors.
    for name in ("coupling", "permittivity"):
        constants = [getattr(each, name) for each in found]
        told = np.median([constant.error for constant in constants])
        assert 0.85 < told / np.std([constant.value for constant in constants]) < 1.3


def test_a_misfit_beyond_the_error_bars_widens_the_errors() -> None:
    bent = truth(5, 4, 0.9) * (1 + 0.1 * np.sin(np.arange(9)))
    narrow, wide = (calibrate(made(bent, error=error), OWN_BY_BARS) for error in (1e-5, 1e-3))
    assert narrow.misfit == pytest.approx(100 * wide.misfit, rel=1e-3)
    assert narrow.permittivity.error == pytest.approx(wide.permittivity.error, rel=1e-3)


def test_error_bars_weigh_the_points_where_they_are_to() -> None:
    reference = truth(5, 4, 0.9)
    reference[4] += 0.3
    curve = made(reference)
    unsure = replace(curve.points[4], reference=Estimate(float(reference[4]), 1e3))
    curve = replace(curve, points=(*curve.points[:4], unsure, *curve.points[5:]))
    assert calibrate(curve, OWN_BY_BARS).permittivity.value == pytest.approx(0.9, rel=1e-4)
    assert abs(calibrate(curve, OWN).permittivity.value - 0.9) > 0.02


def test_a_curve_that_does_not_saturate_leaves_the_constants_open() -> None:
    assert not calibrate(made(0.01 * CAPACITANCES**1.2), OWN).determined


@pytest.mark.parametrize("form", FORMS)
def test_too_few_points_are_refused(form: Form) -> None:
    curve = made(truth(5, 4, 0.9))
    free = 2 if form.counts_own else 1
    with pytest.raises(ValueError, match="too few"):
        calibrate(replace(curve, points=curve.points[:free]), form)


def test_an_untuned_curve_is_the_model_with_the_constants_of_the_scene() -> None:
    assert untuned(made(CAPACITANCES)) == pytest.approx(truth(5, 0, 1))


def test_deviations_carry_the_error_bars_over() -> None:
    curve = made(np.full(9, 0.5), error=0.1)
    found = deviation(curve, np.full(9, 0.6))
    assert (found.value[0], found.low[0], found.high[0]) == pytest.approx((0.2, 0.0, 0.5))


def test_the_distance_beyond_which_the_deviation_stays_below_a_limit() -> None:
    curve = made(np.ones(9))
    found = deviation(curve, 1 + np.array([0.3, -0.01, 0.2, -0.06, 0.04, 0, 0, 0.01, 0.02]))
    assert found.within(0.05) == pytest.approx(DISTANCES[4])
    assert found.within(0.5) == pytest.approx(DISTANCES[0])
    assert found.within(0.015) is None
    assert found.worst == 0


def test_what_is_hardly_observable_is_told_apart() -> None:
    reference = np.array([1, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.04, 0.02])
    curve = made(reference)
    found = summary(curve, reference * np.array([1, 1, 0.9, 1, 1, 1, 1, 1, 1.5]), curve)
    assert (found.worst, found.observable) == pytest.approx((0.5, -0.1))
    assert (found.worst_at, found.observable_at) == pytest.approx((DISTANCES[8], DISTANCES[2]))
    assert found.observable_until == pytest.approx(DISTANCES[6])
    assert found.rms == pytest.approx(np.hypot(0.06, 0.01) / 3)


def test_claims_are_held_against_over_what_is_observable() -> None:
    reference = np.array([1, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.04, 0.02])
    curve = made(reference)
    off = np.array([-0.2, -0.1, 0, 0, 0, 0, 0, 1, 1])
    held = hold(curve, reference * (1 + off), curve, SMALLER_PLATE)
    assert held is not None and held.holds and held.worst == pytest.approx(-0.2)
    assert held.mean == pytest.approx(-0.3 / 7)
    assert held.later_from == pytest.approx(DISTANCES[2])
    stricter = hold(curve, reference * (1 + off), curve, LARGER_PLATE)
    assert stricter is not None and not stricter.holds
    faint = made(0.01 * reference)
    assert hold(faint, 0.01 * reference, curve, SMALLER_PLATE) is None
    assert not summary(faint, 0.01 * reference, curve).is_observable


def test_the_thesis_is_low_on_smaller_plates_and_high_on_larger_ones() -> None:
    small, large = for_plate(1, 2), for_plate(3, 2)
    assert small is not None and small.is_low
    assert large is not None and not large.is_low
    assert for_plate(2, 2) is None
