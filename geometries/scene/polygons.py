"""Simple polygons in a plane: what is wrong with one, and its triangles by clipping ears. SCENE.md fixes their order.

Every decision is exact: it is made in floating point where rounding cannot change it, and otherwise in fractions.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeVar

from geometries.common.arrays import Array

Point = tuple[float, float]
_T = TypeVar("_T", float, Array)

MOST_VERTICES = 500
"""Largest number of vertices: the time to check and divide a polygon grows with its square."""
_ROUNDING = 4 * 2.0**-53
"""Bound of the rounding error of `turn`, over the sum of the magnitudes of its two products (Shewchuk 1997)."""
_UNDERFLOW = 1e-290
"""Below this a product may have lost digits."""


def turn(a: Point, b: Point, c: Point) -> int:
    """Returns 1 if the way from a over b to c turns left, -1 if it turns right, and 0 if the points lie on a line."""
    doubled, bound = turn_and_bound(*a, *b, *c)
    if not abs(doubled) > bound:
        (ax, ay), (bx, by), (cx, cy) = ((Fraction(x), Fraction(y)) for x, y in (a, b, c))
        exact = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        return (exact > 0) - (exact < 0)
    return 1 if doubled > 0 else -1


def turn_and_bound(ax: _T, ay: _T, bx: _T, by: _T, cx: _T, cy: _T) -> tuple[_T, _T]:
    """Returns twice the area of the triangle a b c, positive to the left, and a bound of its rounding error; numbers or arrays."""
    first, second = (bx - ax) * (cy - ay), (by - ay) * (cx - ax)
    return first - second, _ROUNDING * (abs(first) + abs(second)) + _UNDERFLOW


def defect(vertices: Sequence[Point]) -> str | None:
    """Returns why these vertices, in their order, are not those of a simple polygon; None if they are."""
    n = len(vertices)
    if not 3 <= n <= MOST_VERTICES:
        return f"must have 3 to {MOST_VERTICES} vertices, not {n}"
    first: dict[Point, int] = {}
    for k, vertex in enumerate(vertices):
        if vertex in first:
            return f"vertex {k} repeats vertex {first[vertex]}"
        first[vertex] = k
    if all(turn(vertices[0], vertices[1], vertex) == 0 for vertex in vertices[2:]):
        return "the vertices lie on a line, and enclose no area"
    for i in range(n):
        for j in range(i + 1, n):
            if _edges_meet(vertices, i, j):
                return (
                    f"edge {i} (from vertex {i}) meets edge {j}: the outline must not cross or touch itself"
                )
    return None


def _edges_meet(vertices: Sequence[Point], i: int, j: int) -> bool:
    """Tells whether the edges that begin at vertices i < j have a point in common, besides the vertex of neighbours."""
    n = len(vertices)
    a, b, c, d = vertices[i], vertices[(i + 1) % n], vertices[j], vertices[(j + 1) % n]
    if j == i + 1:
        return _is_on(d, a, b) or _is_on(a, c, d)
    if i == 0 and j == n - 1:
        return _is_on(c, a, b) or _is_on(b, c, d)
    if turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0:
        return True
    return _is_on(c, a, b) or _is_on(d, a, b) or _is_on(a, c, d) or _is_on(b, c, d)


def _is_on(point: Point, a: Point, b: Point) -> bool:
    """Tells whether a point is on the segment from a to b."""
    between = all(min(a[k], b[k]) <= point[k] <= max(a[k], b[k]) for k in (0, 1))
    return between and turn(a, b, point) == 0


def anticlockwise(vertices: Sequence[Point]) -> tuple[Point, ...]:
    """Returns the vertices of a simple polygon anticlockwise: in their order, or reversed."""
    # The turn at an extreme vertex is that of the polygon; a vertex that is extreme in x and then in y is no flat one.
    k = min(range(len(vertices)), key=lambda k: vertices[k])
    left = turn(vertices[k - 1], vertices[k], vertices[(k + 1) % len(vertices)]) > 0
    return tuple(vertices) if left else tuple(reversed(vertices))


def ears(vertices: Sequence[Point]) -> list[tuple[Point, Point, Point]]:
    """Returns the triangles, anticlockwise, into which clipping ears divides a simple polygon given anticlockwise."""
    found, rest = clipped(vertices)
    assert not rest
    return [(vertices[i], vertices[j], vertices[k]) for i, j, k in found]


def clipped(vertices: Sequence[Point]) -> tuple[list[tuple[int, int, int]], list[int]]:
    """Clips the ears of an outline given anticlockwise; returns their triangles, and what is left of an outline that is not simple.

    Both are indices of vertices. The next triangle is that of the first vertex, in the order of the list, at which the outline turns
    left and whose triangle with its two neighbours contains no other vertex, not even on its sides; this vertex is then taken out. An
    outline may touch itself in vertices at one place, as one around a hole does.
    """
    left = list(range(len(vertices)))
    found: list[tuple[int, int, int]] = []
    while len(left) > 3:
        k = next((k for k in range(len(left)) if _is_ear(vertices, left, k)), None)
        if k is None:
            return found, left
        found.append((left[k - 1], left[k], left[(k + 1) % len(left)]))
        del left[k]
    return [*found, (left[2], left[0], left[1])], []


def _is_ear(vertices: Sequence[Point], left: Sequence[int], k: int) -> bool:
    n = len(left)
    a, b, c = vertices[left[k - 1]], vertices[left[k]], vertices[left[(k + 1) % n]]
    if turn(a, b, c) <= 0:
        return False
    low_x, high_x = min(a[0], b[0], c[0]), max(a[0], b[0], c[0])
    low_y, high_y = min(a[1], b[1], c[1]), max(a[1], b[1], c[1])
    for j in range(n):
        p = vertices[left[j]]
        if not (low_x <= p[0] <= high_x and low_y <= p[1] <= high_y) or p == a or p == c:
            continue
        if p != b:
            if turn(a, b, p) >= 0 and turn(b, c, p) >= 0 and turn(c, a, p) >= 0:
                return False
        elif j != k:
            # Another part of the outline touches this vertex, perhaps from within the triangle.
            beside = (vertices[left[j - 1]], vertices[left[(j + 1) % n]])
            if any(turn(a, b, q) > 0 and turn(b, c, q) > 0 for q in beside):
                return False
    return True
