"""Labels of points in a figure, placed so that they cover neither each other nor points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

Point = tuple[float, float]

_CHARACTER, _LINE = 6.0, 12.0
"""Width of a character and height of a line (pixels) in the font that labels have."""
_CLEAR = 7.0
"""Distance (pixels) of a label from the middle of its point."""
_PLACES = ("top right", "bottom right", "top left", "bottom left", "top center", "bottom center")


def placed(points: Sequence[Point], labels: Sequence[str]) -> list[str | None]:
    """Returns for each label where it stands, in plotly's words; None where there is no room for it or it is empty.

    `points` are in pixels, y upwards. Earlier labels are placed first.
    """
    taken = [_Box(x - _CLEAR / 2, y - _CLEAR / 2, x + _CLEAR / 2, y + _CLEAR / 2) for x, y in points]
    chosen: list[str | None] = []
    for own, (point, label) in enumerate(zip(points, labels)):
        others = taken[:own] + taken[own + 1 :]
        boxes = {place: _box(point, label, place) for place in _PLACES}
        free = [place for place in _PLACES if not any(boxes[place].meets(other) for other in others)]
        chosen.append(free[0] if free and label else None)
        if chosen[-1] is not None:
            taken.append(boxes[free[0]])
    return chosen


@dataclass(frozen=True)
class _Box:
    """Its sides in pixels, y upwards."""

    left: float
    bottom: float
    right: float
    top: float

    def meets(self, other: _Box) -> bool:
        across = self.left < other.right and other.left < self.right
        return across and self.bottom < other.top and other.bottom < self.top


def _box(point: Point, label: str, place: str) -> _Box:
    x, y = point
    width = _CHARACTER * len(label)
    vertical, horizontal = place.split()
    left = {"right": x + _CLEAR / 2, "left": x - _CLEAR / 2 - width, "center": x - width / 2}[horizontal]
    bottom = y + _CLEAR / 2 if vertical == "top" else y - _CLEAR / 2 - _LINE
    return _Box(left, bottom, left + width, bottom + _LINE)
