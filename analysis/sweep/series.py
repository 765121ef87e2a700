"""The table of `fringe sweep` as series: what each method says of each reading, frame by frame."""

import csv
import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from analysis.results.answers import Estimate
from geometries.scene.motion import Frame


def place_words(motion: tuple[Frame, ...], at: float) -> str:
    """Returns the interpolated translation of the link that moves between two frames; empty if several move or one turns.
    `at` counts frames from 1 on."""
    number = min(math.floor(at), len(motion) - 1)
    before, after = motion[number - 1].poses, motion[number].poses
    moved = [name for name in before if before[name] != after[name]]
    if len(moved) != 1 or before[moved[0]].rotation != after[moved[0]].rotation:
        return ""
    share = at - number
    first, last = (np.array(poses[moved[0]].translation) for poses in (before, after))
    x, y, z = (1 - share) * first + share * last
    return f"{moved[0]} at ({x:.4g}, {y:.4g}, {z:.4g}) m"


@dataclass(frozen=True)
class Crossing:
    """A place where a change exceeds the threshold (`rises`) or stops to: places count frames from 1 on, fractions lie between two.
    The errors allow it from `first` to `last`; None if they allow that it is before the first frame, or after the last.
    """

    at: float
    first: float | None
    last: float | None
    rises: bool


def crossings(changes: list[float | None], errors: list[float], threshold: float) -> list[Crossing]:
    """Returns where the size of a change crosses the threshold; changes, errors and threshold in one unit, None for unknown ones.
    Sizes are interpolated by their logarithms, since changes fall like powers of the distance."""
    sizes = [None if change is None else abs(change) for change in changes]
    bounds = [
        (None, None) if size is None else (size + error, max(size - error, 0.0))
        for size, error in zip(sizes, errors, strict=True)
    ]
    found = []
    for at, rises in _places(sizes, threshold):
        ends: list[float | None] = []
        for curve in zip(*bounds, strict=True):
            same_way = [place for place, direction in _places(list(curve), threshold) if direction == rises]
            ends.append(min(same_way, key=lambda place: abs(place - at)) if same_way else None)
        first, last = ends if rises else reversed(ends)
        found.append(Crossing(at, first, last, rises))
    return found


def _places(sizes: list[float | None], threshold: float) -> list[tuple[float, bool]]:
    """Returns where sizes cross the threshold, and whether they rise."""
    found = []
    for number, (before, after) in enumerate(pairwise(sizes), start=1):
        if before is not None and after is not None and (before > threshold) != (after > threshold):
            share = (threshold - before) / (after - before)
            if before > 0 and after > 0:
                share = math.log(threshold / before) / math.log(after / before)
            found.append((number + share, after > before))
    return found


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
    def error(self) -> float:
        """The error of the change; infinite or NaN where none is known."""
        return self.change.error if self.change is not None else math.inf

    @property
    def is_truth(self) -> bool:
        """Whether the change is known with an error."""
        return math.isfinite(self.error)


_NOTHING = Said("", None, None, None, None, "")


@dataclass(frozen=True)
class Series:
    """A reading over all frames: what each method says, by its name, and the threshold (F), if it has one."""

    reading: str
    threshold: float | None
    methods: dict[str, tuple[Said, ...]]

    @property
    def truth(self) -> tuple[Said, ...]:
        """In each frame the answer whose change has the least stated error; one that knows nothing where no method states one."""
        return tuple(
            min((said for said in frame if said.is_truth), key=lambda said: said.error, default=_NOTHING)
            for frame in zip(*self.methods.values(), strict=True)
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
    change, value, background = (_estimate(row, name) for name in ("change", "value", "background"))
    voltage = _number(row["delta_voltage_V"])
    return Said(row["answered_by"], change, value, background, voltage, row["noticed"])


def _estimate(row: dict[str, str], name: str) -> Estimate | None:
    value, error = _number(row[f"{name}_F"]), _number(row[f"{name}_error_F"])
    return None if value is None else Estimate(value, math.nan if error is None else error)


def _number(text: str) -> float | None:
    return float(text) if text else None
