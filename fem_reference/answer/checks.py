"""Checks of an estimated Maxwell matrix, against entries that are equal by symmetry and against bounds of its meshes.

An answer needs neither check. Both cost little, and both are independent of the differences between levels from which the errors
are estimated.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fem_reference.answer.convergence import Estimate
from fem_reference.solve.enclosure import Enclosure

Array = NDArray[np.float64]


def checked(
    found: Estimate, exchanges: Sequence[Sequence[int]], bounds: Enclosure | None
) -> tuple[Estimate, str | None]:
    """Widen the errors of an estimate until it passes the checks; returns it with a description of what it contradicted.

    The description is None where every deviation was within the errors stated. Each of `exchanges` is a permutation of the
    conductors that leaves the matrix unchanged. `bounds` are proven.
    """
    value, error = found.value, found.error
    contradicted: list[str] = []
    for exchange in exchanges:
        order = np.ix_(exchange, exchange)
        difference = np.abs(value - value[order])
        if np.any(difference > found.error + found.error[order]):
            contradicted.append("entries that are equal by symmetry differ by more than their errors")
        error = np.maximum(error, difference)
    if bounds is not None:
        outside = np.maximum(np.maximum(bounds.lower - value, value - bounds.upper), 0.0)
        if np.any(outside > found.error):
            contradicted.append("entries are outside of the bounds of a mesh by more than their errors")
        error = np.maximum(error, outside)
    words = "; ".join(dict.fromkeys(contradicted)) or None
    return Estimate(value, error, found.extrapolated), words
