"""The names of what methods answer: parts of readings, also in poses of a motion, and entries of the Maxwell matrix where there are none."""

from __future__ import annotations

from geometries.scene.readings import readings
from geometries.scene.scene import Scene

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
