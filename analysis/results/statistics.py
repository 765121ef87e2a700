"""Summary statistics of the model's error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.results.table import QUANTITIES, Row

ALL_FAMILIES = "all"


@dataclass(frozen=True)
class Summary:
    """The model errors of one family in one quantity, relative to the reference.

    `median` is of the absolute errors, `worst` the error of the largest absolute value with its sign, `sure_to` the largest
    relative error of the reference among them.
    """

    family: str
    quantity: str
    count: int
    rms: float
    median: float
    worst: float
    worst_case: str
    sure_to: float


def summaries(rows: list[Row]) -> list[Summary]:
    """Returns a summary for each quantity, over all families and then for each of them."""
    families = list(dict.fromkeys(row.case.family for row in rows))
    found = []
    for quantity in QUANTITIES:
        for family in [ALL_FAMILIES, *families]:
            members = [
                row for row in rows if row.quantity == quantity and family in (ALL_FAMILIES, row.case.family)
            ]
            if members:
                found.append(summary(family, quantity, members))
    return found


def summary(family: str, quantity: str, rows: list[Row]) -> Summary:
    """Returns the summary of at least one row."""
    errors = np.array([row.model_error for row in rows])
    worst = int(np.argmax(np.abs(errors)))
    return Summary(
        family=family,
        quantity=quantity,
        count=len(rows),
        rms=float(np.sqrt(np.mean(errors**2))),
        median=float(np.median(np.abs(errors))),
        worst=float(errors[worst]),
        worst_case=rows[worst].case.id,
        sure_to=max(row.reference_error for row in rows),
    )


def headline(found: list[Summary]) -> str:
    """Returns the summaries over all families as lines for a terminal."""
    return "\n".join(
        f"{s.quantity:<11} model error over {s.count} cases: rms {s.rms:.1%}, median {s.median:.1%}, worst {s.worst:+.1%}"
        f" (the reference is sure to {s.sure_to:.2%})"
        for s in found
        if s.family == ALL_FAMILIES
    )
