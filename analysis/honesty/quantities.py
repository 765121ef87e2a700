"""The names of what methods answer: parts of readings, and entries of the Maxwell matrix where there are none."""

from __future__ import annotations

from geometries.scene.readings import readings
from geometries.scene.scene import Scene

PARTS = ("value", "background", "change")


def part_of(reading: str, part: str) -> str:
    """Returns the name of a part of a reading, one of PARTS."""
    return f"{reading}: {part}"


def entry(first: str, second: str) -> str:
    """Returns the name of an entry of the Maxwell matrix, which is symmetrical: the same for both orders of the conductors."""
    return f"M[{', '.join(sorted((first, second)))}]"


def has_readings(scene: Scene) -> bool:
    """Tells whether the scene has readings; else its Maxwell matrix is asked for."""
    return bool(readings(scene))
