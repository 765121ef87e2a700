"""Distances between sets of triangles, closed or not, exact to rounding and fast for a hundred thousand of them; how they wind around points."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from geometries.common.arrays import Array, Flags, Indices

CHUNK = 20_000
"""Number of pairs of triangles whose distances are computed at a time."""
FIRST_PAIRS = 1000
"""Number of pairs of triangles whose least distance bounds that of all from above."""
NO_AREA = 1e-24
"""Square of the height over the longest side at which a triangle has no area: only its sides count then."""
ROUNDING = 1e-6
"""Share by which lower bounds of distances are reduced, for rounding."""
TINY = 1e-300
"""Squared length that takes the place of 0 in a division."""


def soup_distance(first: Array, second: Array) -> float:
    """The shortest distance between triangles (n, 3, 3) and triangles (m, 3, 3); 0 where two of them meet.

    The nearest of pairs with close centroids bounds it from above, so that only triangles near the other box have to be looked at. Each
    is enclosed in a ball, and pairs are taken in the order of the distance of their balls, until it exceeds the least distance found.
    """
    apart, nearest = cKDTree(second.mean(axis=1)).query(first.mean(axis=1))
    close = np.argsort(apart)[:FIRST_PAIRS]
    best = float(_distances(first[close], second[nearest[close]]).min())
    first, second = _near_box(first, second, best), _near_box(second, first, best)
    if best == 0 or not len(first) or not len(second):
        return best
    one, other = _Balls(first), _Balls(second)
    pairs, least = one.pairs_within(other, best)
    for start in range(0, len(pairs), CHUNK):
        if least[start] > best or best == 0:
            break
        chosen = pairs[start : start + CHUNK]
        one_side, other_side = first[chosen[:, 0]], second[chosen[:, 1]]
        near = _at_least(one_side, other_side) <= best
        best = min(best, float(_distances(one_side[near], other_side[near]).min(initial=np.inf)))
    return best


def _near_box(triangles: Array, others: Array, reach: float) -> Array:
    """The triangles (n, 3, 3) whose bounding boxes are at most `reach` from that of others (m, 3, 3)."""
    low, high = others.min(axis=(0, 1)), others.max(axis=(0, 1))
    apart = np.maximum(triangles.min(axis=1) - high, low - triangles.max(axis=1))
    return np.asarray(triangles[apart.max(axis=1) <= reach * (1 + ROUNDING)])


def _at_least(first: Array, second: Array) -> Array:
    """Lower bounds (n,) of the distances of pairs of triangles (n, 3, 3): between their bounding boxes, and from the plane of each."""
    apart = np.maximum(first.min(axis=1) - second.max(axis=1), second.min(axis=1) - first.max(axis=1))
    found = np.linalg.norm(np.maximum(apart, 0), axis=1)
    for one, other in ((first, second), (second, first)):
        normal = np.cross(one[:, 1] - one[:, 0], one[:, 2] - one[:, 0])
        heights = np.einsum("nki,ni->nk", other - one[:, :1], normal)
        beyond = np.maximum(heights.min(axis=1), -heights.max(axis=1))
        found = np.maximum(found, beyond / np.maximum(np.linalg.norm(normal, axis=1), TINY))
    # Rounding must not exclude the nearest pair.
    return np.asarray(found * (1 - ROUNDING))


class _Balls:
    """The balls around the centroids of triangles."""

    def __init__(self, triangles: Array) -> None:
        self.centres = triangles.mean(axis=1)
        self.radii = np.linalg.norm(triangles - self.centres[:, None], axis=2).max(axis=1)

    def pairs_within(self, other: _Balls, reach: float) -> tuple[Indices, Array]:
        """The pairs of balls (k, 2) at most `reach` apart, in the order of these distances (k,), which are negative where they overlap.

        The balls of `other` are grouped by their size, so that a few large ones do not make all of them candidates.
        """
        found = []
        exponent = np.floor(np.log2(np.maximum(other.radii, TINY))).astype(int)
        for size in np.unique(exponent):
            group = np.flatnonzero(exponent == size)
            largest = float(other.radii[group].max())
            tree = cKDTree(other.centres[group])
            limit = float(self.radii.max()) + largest + reach
            nearest = tree.query(self.centres, distance_upper_bound=limit * (1 + 1e-9))[0]
            near = np.flatnonzero(nearest <= self.radii + largest + reach)
            links = tree.query_ball_point(self.centres[near], self.radii[near] + largest + reach)
            counts = [len(link) for link in links]
            if sum(counts):
                own = np.repeat(near, counts)
                others = group[np.concatenate([np.asarray(link, dtype=np.int64) for link in links])]
                found.append(np.column_stack([own, others]))
        pairs = np.concatenate(found) if found else np.empty((0, 2), dtype=np.int64)
        apart = np.linalg.norm(self.centres[pairs[:, 0]] - other.centres[pairs[:, 1]], axis=1)
        apart = apart - self.radii[pairs[:, 0]] - other.radii[pairs[:, 1]]
        order = np.argsort(apart, kind="stable")
        order = order[apart[order] <= reach]
        return pairs[order], apart[order]


def _distances(first: Array, second: Array) -> Array:
    """Distances (n,) of pairs of triangles (n, 3, 3): those of their sides, and of the corners of each from the other; 0 where a side
    passes through the other triangle."""
    squared = np.full(len(first), np.inf)
    for j in range(3):
        for one, other in ((first, second), (second, first)):
            ends = one[:, j], one[:, (j + 1) % 3]
            squared = np.minimum(squared, _corner_to_face(ends[0], other))
            squared = np.where(_passes_through(*ends, other), 0.0, squared)
        for k in range(3):
            squared = np.minimum(
                squared,
                _between_segments(first[:, j], first[:, (j + 1) % 3], second[:, k], second[:, (k + 1) % 3]),
            )
    return np.asarray(np.sqrt(squared))


def segment_distances(segments: Array, triangles: Array) -> Array:
    """Distances (n,) of segments (n, 2, 3) from one triangle (n, 3, 3) each; 0 where a segment passes through its triangle."""
    start, end = segments[:, 0], segments[:, 1]
    squared = np.minimum(_corner_to_face(start, triangles), _corner_to_face(end, triangles))
    for k in range(3):
        side = triangles[:, k], triangles[:, (k + 1) % 3]
        squared = np.minimum(squared, _between_segments(start, end, *side))
    return np.asarray(np.sqrt(np.where(_passes_through(start, end, triangles), 0.0, squared)))


def _corner_to_face(points: Array, triangles: Array) -> Array:
    """Squared distances (n,) of points (n, 3) from the planes of triangles above whose inside they lie; infinite elsewhere."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    sides = np.maximum(((b - a) ** 2).sum(axis=1), ((c - a) ** 2).sum(axis=1))
    length = (normal**2).sum(axis=1)
    inside = length > NO_AREA * sides**2
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(end - start, points - start), normal) >= 0
    height = np.einsum("ij,ij->i", points - a, normal)
    return np.where(inside, height**2 / np.where(inside, length, 1.0), np.inf)


def _passes_through(start: Array, end: Array, triangles: Array) -> Flags:
    """Whether segments pass through the inside of triangles: their ends are on both sides, and the line winds around no side."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    below, above = (np.einsum("ij,ij->i", point - a, normal) for point in (start, end))
    crosses = below * above < 0
    share = np.where(crosses, below / np.where(crosses, below - above, 1.0), 0.0)
    at = start + share[:, None] * (end - start)
    return np.asarray(crosses & np.isfinite(_corner_to_face(at, triangles)))


def _between_segments(p: Array, q: Array, r: Array, s: Array) -> Array:
    """Squared distances (n,) of the segments from p to q and from r to s (Ericson 2005, section 5.1.9)."""
    u, v, w = q - p, s - r, p - r
    a, e = (np.maximum((x**2).sum(axis=1), TINY) for x in (u, v))
    b, c, f = (np.einsum("ij,ij->i", x, y) for x, y in ((u, v), (u, w), (v, w)))
    denominator = a * e - b * b
    along = np.where(denominator > 0, (b * f - c * e) / np.where(denominator > 0, denominator, 1.0), 0.0)
    along = np.clip(along, 0, 1)
    across = (b * along + f) / e
    along = np.where(
        across < 0, np.clip(-c / a, 0, 1), np.where(across > 1, np.clip((b - c) / a, 0, 1), along)
    )
    across = np.clip(across, 0, 1)
    return np.asarray(((w + along[:, None] * u - across[:, None] * v) ** 2).sum(axis=1))


def winding_number(triangles: Array, points: Array) -> Array:
    """The solid angle (n,) that triangles (m, 3, 3) subtend at points (n, 3), over 4π (Van Oosterom & Strackee 1983)."""
    found = np.empty(len(points))
    for k, point in enumerate(points):
        a, b, c = (triangles[:, corner] - point for corner in range(3))
        ra, rb, rc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = [np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a))]
        angle = 2 * np.arctan2(volume, ra * rb * rc + dots[0] * rc + dots[1] * ra + dots[2] * rb)
        found[k] = angle.sum() / (4 * np.pi)
    return found
