"""The few numbers that the thesis states about its experiments. Distances and plate sizes are blacked out there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.topics.experiments.calibration import deviation, summary
from analysis.topics.experiments.curves import Curve

Array = NDArray[np.float64]

# 6.1: "after splitting up the triangle only four or more times, the difference is negligible".
NEGLIGIBLE_FROM_LEVEL = 4


@dataclass(frozen=True)
class PlateClaim:
    """Section 6.3: the largest difference, the limit that it stays below from some distance on, and the sign of the prediction's error."""

    greatest: float
    later: float
    is_low: bool


# Section 6.3: the prediction of Figure 6.8 is below the measurement, that of 6.9 above. A prediction is too low for a smaller plate
# and too high for a larger one, which gives the sizes that the text leaves out.
SMALLER_PLATE = PlateClaim(0.24, 0.05, is_low=True)
LARGER_PLATE = PlateClaim(0.10, 0.06, is_low=False)


@dataclass(frozen=True)
class Held:
    """A prediction compared with a claim, over the observable points: the largest deviation and its place (m), the mean, the place (m)
    from which on all are below the claim's limit (None: nowhere), and whether the largest is within the claim.
    """

    worst: float
    worst_at: float
    mean: float
    later_from: float | None
    holds: bool


def for_plate(area: float, calibrated: float) -> PlateClaim | None:
    """Returns the claim on a plate of an area (m²) with the model calibrated on another plate; None for the same plate."""
    if area == calibrated:
        return None
    return SMALLER_PLATE if area < calibrated else LARGER_PLATE


def hold(curve: Curve, prediction: Array, calibrated_on: Curve, claim: PlateClaim) -> Held | None:
    """Compares a prediction (V) with a claim, over the observable points; None without any."""
    found = summary(curve, prediction, calibrated_on)
    if not found.is_observable:
        return None
    seen = curve.until(found.observable_until)
    values = deviation(seen, prediction[: len(seen.points)])
    return Held(
        found.observable,
        found.observable_at,
        float(np.mean(values.value)),
        values.within(claim.later),
        abs(found.observable) <= claim.greatest,
    )
