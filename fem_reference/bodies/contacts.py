"""Which bodies touch: those of one conductor may, and make it one; between others contact is refused."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_reference.bodies.distances import TOUCHING, distance, gap_to_walls, holds, touch_with_faces
from fem_reference.bodies.polyhedron import connected
from fem_reference.bodies.shapes import Cuboid, Surface
from geometries.common.errors import InputError

SMALLEST_GAP = 1e-3
"""Smallest gap that is meshed, over the smaller of the two bodies' sizes. The mesh resolves every gap, and the number of its cells is
proportional to the square of size over gap: with a smaller gap it would not fit into memory."""


def groups(count: int, pairs: Sequence[tuple[int, int]]) -> list[int]:
    """The number (count,) of the group of each body, where the bodies of each pair are in one group; groups follow their first bodies."""
    return list(map(int, connected(count, np.array(pairs, dtype=np.int64).reshape(-1, 2))))


def meet(first: Surface, second: Surface, margin: float = 0.0) -> bool:
    """Whether two bodies touch, overlap, contain one another, or are at most `margin` times the smaller of their sizes apart."""
    if _boxes_apart(first, second, margin):
        return False
    close = distance(first, second) <= max(margin, TOUCHING) * min(first.size, second.size)
    return close or holds(first, second) or holds(second, first)


def _boxes_apart(first: Surface, second: Surface, margin: float = 0.0) -> bool:
    """Whether the bounding boxes of two bodies are farther apart than `margin` times the smaller of their sizes."""
    one, other = (np.array([body.corners.min(axis=0), body.corners.max(axis=0)]) for body in (first, second))
    gap = np.maximum(one[0] - other[1], other[0] - one[1]).max()
    return bool(gap > max(margin, TOUCHING) * min(first.size, second.size))


def refuse_contact(first: Surface, second: Surface, dielectric: bool, source: str, remedy: str = "") -> None:
    """Raise InputError when two bodies meet, or are too close to mesh; a `dielectric` second body may touch the first with a face.

    `remedy` ends the messages: words on what to do about it.
    """
    if _boxes_apart(first, second, SMALLEST_GAP):
        return
    key = f'"{first.name}" and "{second.name}"'
    gap = distance(first, second)
    size = min(first.size, second.size)
    least = SMALLEST_GAP * size
    if dielectric and gap <= TOUCHING * size and touch_with_faces(first, second):
        return
    for outer, inner in ((first, second), (second, first)):
        if holds(outer, inner):
            raise InputError(source, key, f'"{inner.name}" is inside "{outer.name}"{remedy}')
    reason = ""
    if gap <= TOUCHING * size and dielectric:
        reason = (
            "overlap, touch elsewhere than with plane faces, or one is inside of the other; a dielectric body may touch with plane "
            "faces of plates, discs, polygons, cuboids, cylinders and cones only, and may coat none: boundary elements take such bodies"
        )
    elif gap <= TOUCHING * size:
        reason = "the conductors touch or cross: with different potentials their capacitance is infinite or meaningless; "
        reason += f"they have to be at least {least:.3g} m apart{remedy}"
    elif gap < least:
        reason = f"the gap of {gap:.3g} m is below {SMALLEST_GAP:g} of the smaller size, too narrow to mesh: "
        reason += f"at least {least:.3g} m are needed{remedy}"
    if reason:
        raise InputError(source, key, reason)


def refuse_outside(body: Surface, room: Cuboid, source: str) -> None:
    """Raise InputError when a body is outside of a room or too close to its walls."""
    if gap_to_walls(body, room) < SMALLEST_GAP * body.size:
        raise InputError(
            source, "room", f'"{body.name}" is not inside, {SMALLEST_GAP:g} of its size off the walls'
        )
