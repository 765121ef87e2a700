"""Lengths, plates and ranges in the words of the experiments' sections."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from analysis.results.units import CENTIMETRE
from analysis.topics.experiments.curves import DISTANCE, Curve


Labelled = list[tuple[str, Curve]]
"""Curves with their names."""


def ranges(labelled: Labelled, values: Callable[[Curve], NDArray[np.float64]], swept: str) -> str:
    """Writes the least and the greatest value along each curve, with their places."""
    phrases = []
    for name, curve in labelled:
        found = values(curve)
        least, greatest = (
            f"{found[index]:.3g} (at {place(float(curve.at[index]), swept)})"
            for index in (int(np.argmin(found)), int(np.argmax(found)))
        )
        phrases.append(f"{name} {least} to {greatest}")
    return "; ".join(phrases)


def place(at: float, swept: str) -> str:
    """Writes a distance in cm or an angle in degrees."""
    return f"{at / CENTIMETRE:.3g} cm" if swept == DISTANCE else f"{at:.3g}°"


def plate(curve: Curve) -> str:
    """Writes the target's size."""
    return size(curve.target_size)


def size(lengths: tuple[float, float]) -> str:
    """Writes lengths in metres as centimetres."""
    x, y = lengths
    return f"{x / CENTIMETRE:.3g} cm × {y / CENTIMETRE:.3g} cm"
