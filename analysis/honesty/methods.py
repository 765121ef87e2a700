"""The methods that state errors, how each is asked, the names of what they answer, and their answers.

Those names are of parts of readings, also in poses of a motion, and of entries of the Maxwell matrix where there are none."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from geometries.scene.readings import readings
from geometries.scene.scene import Scene

FIELD_SOLVER = "field-solver"
BOUNDARY_ELEMENTS = "boundary-elements"
AUTO = "auto"
METHODS: dict[str, dict[str, Any]] = {
    "formula": {"method": "formula"},
    "reduced:1e-1": {"method": "reduced", "rtol": 1e-1},
    "reduced:1e-2": {"method": "reduced", "rtol": 1e-2},
    "reduced+entries:1e-2": {"method": "reduced", "rtol": 1e-2, "entries": True},
    "boundary-elements:1e-2": {"method": BOUNDARY_ELEMENTS, "rtol": 1e-2},
    "boundary-elements:3e-2": {"method": BOUNDARY_ELEMENTS, "rtol": 3e-2},
    "auto:1e-2": {"method": AUTO, "rtol": 1e-2},
}
"""The methods of the library, with their options in Python; after a colon is the relative accuracy asked for, of the entries of the
Maxwell matrix, too, where the name says so."""
ALL = (*METHODS, FIELD_SOLVER)

FINER = "boundary-elements, finer"
"""The answer that others are held against: boundary elements at a tenth of the error, round bodies with more sides."""
FINER_RTOL = 1e-3
FINER_SECONDS = 20.0
"""After which it ends with the best that it has."""

FIELD_RTOL = 1e-2
FIELD_SECONDS = 60.0
"""After which the field solver starts no further mesh."""


@dataclass(frozen=True)
class Stated:
    """A value (F) and the error stated of it; None where the method says that it does not know one. `by` is who answered."""

    value: float | None
    error: float | None
    by: str = ""


@dataclass(frozen=True)
class Answer:
    """What one method made of a scene: values by the names of the quantities, or why there are none, and seconds of the clock. `key`
    stands for the scene, the options and the code that answered; `reached` tells whether a Maxwell matrix is as accurate as asked, and
    `guess` is the time that `auto` expected over the time that it took."""

    outcome: str
    seconds: float = 0.0
    reason: str = ""
    values: dict[str, Stated] = field(default_factory=dict)
    key: str = ""
    reached: bool | None = None
    guess: float | None = None


ANSWERED, REFUSED, LATE, ENDED = "answered", "refused", "late", "ended"
"""Outcomes of a question: an answer, a refusal by name, none in time, and a process that ended or an error that names no input."""


CHANGE = "change"
PARTS = ("value", "background", CHANGE)


def part_of(reading: str, part: str) -> str:
    """Returns the name of a part of a reading, one of PARTS."""
    return f"{reading}: {part}"


def in_pose(reading: str, number: int) -> str:
    """Returns the name of a reading in a pose of a motion, which is counted from 0."""
    return f"{reading} in pose {number}"


def pair(sensor: str, body: str) -> str:
    """Returns the name of the capacitance between a sensor and a body, by themselves."""
    return f"C[{sensor}, {body}]"


def entry(first: str, second: str) -> str:
    """Returns the name of an entry of the Maxwell matrix, which is symmetrical: the same for both orders of the conductors."""
    return f"M[{', '.join(sorted((first, second)))}]"


def has_readings(scene: Scene) -> bool:
    """Tells whether the scene has readings; else its Maxwell matrix is asked for."""
    return bool(readings(scene))
