"""The table of `fringe sweep` as series: what each method says of each reading, frame by frame."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

from analysis.results.answers import Estimate


@dataclass(frozen=True)
class Said:
    """What a method says of a reading in a frame, F and V; None where it knows nothing. An error that it does not state is NaN."""

    answered_by: str
    change: Estimate | None
    value: Estimate | None
    background: Estimate | None
    delta_voltage: float | None
    noticed: str

    @property
    def is_truth(self) -> bool:
        """Whether the change is known with an error."""
        return self.change is not None and math.isfinite(self.change.error)


@dataclass(frozen=True)
class Series:
    """A reading over all frames: what each method says, by its name, and the threshold (F), if it has one."""

    reading: str
    threshold: float | None
    methods: dict[str, tuple[Said, ...]]

    @property
    def truth(self) -> tuple[Said | None, ...]:
        """In each frame the answer whose change has the least stated error; None where no method states one."""
        frames = zip(*self.methods.values(), strict=True)
        return tuple(
            min((said for said in frame if said.is_truth), key=_error_of_change)
            if any(said.is_truth for said in frame)
            else None
            for frame in frames
        )


@dataclass(frozen=True)
class Sweep:
    """The names of the frames in their order, and a series for every reading."""

    frames: tuple[str, ...]
    series: tuple[Series, ...]


def read(table: Path) -> Sweep:
    """Reads the table that `fringe sweep` wrote."""
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    frames = {int(row["frame"]): row["name"] for row in rows}
    by_reading: dict[str, dict[str, list[Said]]] = {}
    thresholds: dict[str, float | None] = {}
    for row in rows:
        by_reading.setdefault(row["reading"], {}).setdefault(row["method"], []).append(_said(row))
        # The row of a method without an answer is empty.
        thresholds[row["reading"]] = _number(row["threshold_F"]) or thresholds.get(row["reading"])
    series = tuple(
        Series(reading, thresholds[reading], {method: tuple(said) for method, said in by_method.items()})
        for reading, by_method in by_reading.items()
    )
    return Sweep(tuple(frames.values()), series)


def _said(row: dict[str, str]) -> Said:
    return Said(
        answered_by=row["answered_by"],
        change=_estimate(row, "change"),
        value=_estimate(row, "value"),
        background=_estimate(row, "background"),
        delta_voltage=_number(row["delta_voltage_V"]),
        noticed=row["noticed"],
    )


def _estimate(row: dict[str, str], name: str) -> Estimate | None:
    value, error = _number(row[f"{name}_F"]), _number(row[f"{name}_error_F"])
    return None if value is None else Estimate(value, math.nan if error is None else error)


def _number(text: str) -> float | None:
    return float(text) if text else None


def _error_of_change(said: Said) -> float:
    return said.change.error if said.change is not None else math.inf
