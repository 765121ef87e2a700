"""What an estimated Maxwell matrix has to agree with: entries that symmetry makes equal, and bounds on the coarsest mesh.

Neither is needed for an answer. Both cost little and know nothing of the differences between levels that errors are estimated from.
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
    """The estimate with errors that cover what it is checked against, and what it contradicted, in words.

    Each of `exchanges` is an order of the conductors in which the matrix is the same. `bounds` are proven.
    """
    value, error = found.value, found.error
    contradicted: list[str] = []
    for exchange in exchanges:
        order = np.ix_(exchange, exchange)
        apart = np.abs(value - value[order])
        if np.any(apart > found.error + found.error[order]):
            contradicted.append("entries that are equal by symmetry differ by more than their errors")
        error = np.maximum(error, apart)
    if bounds is not None:
        outside = np.maximum(np.maximum(bounds.lower - value, value - bounds.upper), 0.0)
        if np.any(outside > found.error):
            contradicted.append("entries are off the bounds of the coarsest mesh by more than their errors")
        error = np.maximum(error, outside)
    words = "; ".join(dict.fromkeys(contradicted)) or None
    return Estimate(value, error, found.extrapolated), words
