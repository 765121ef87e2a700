"""Wraps triangles in any state into a closed surface that strictly contains them: NUMERICS.md section 13.

The wrap itself is made by CGAL's alpha wrap, in the program fringe-wrap. How closely it follows the triangles is chosen here, place by
place, from the distance to what has another potential: near that the wrap has to be exact.
"""

from __future__ import annotations

import math
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from fem_reference.bodies.shapes import Body
from fem_reference.bodies.polyhedron import Polyhedron, connected_parts, smallest_width
from fem_reference.bodies.triangle_distances import soup_distance
from geometries.common import installation
from geometries.common.arrays import Array, Indices
from geometries.common.children import ending_with_this, temporary_folder
from geometries.scene import shapes
from geometries.scene.shapes import Shape

ALPHA_SHARE = 0.4
"""Alpha, the radius of the narrowest hollow that the wrap follows, over the distance to what has another potential. Near such a body alpha
tends to 0, so that the wrap cannot bridge to it unless it lies in a cavity."""
ALPHA_OF_EXTENT = 0.02
"""Largest alpha over the extent of the wrapped bodies."""
SHARE_OF_RTOL, LEAST_SHARE, LARGEST_SHARE = 0.125, 1e-3, 2.5e-3
"""Distance of the wrap from what it contains, over the distance to what has another potential: this share of the relative accuracy that was
asked for, within limits. To first order, a displacement of a surface changes capacitances by as much of themselves, or twice that after
simplification. On an arm of 9,000 triangles shares of 2e-2 and 5e-3 cost 5 % and 2 % of the change by a hand."""
OFFSET_OF_EXTENT = 0.25
"""Distance at which the offset stops growing, over the extent of the wrapped bodies: their own shape counts there as well."""
ALLOWED_OVER_OFFSET = 2.0
"""Distance up to which the wrap is simplified, over its offset at that place."""
SAMPLES = 100_000
"""Number of points on the wrapped bodies by which the body nearest to a place on the wrap is found."""
CLOSED = 1.5
"""Distance from the wrapped bodies, over that up to which a wrap may be simplified, from which on a wrap closes a hollow."""
OTHERS_TOLERANCE = 0.1
"""Relative error of the distances to other bodies that this comparison allows: small beside `CLOSED`."""
SPACINGS, SPACING_QUANTILE = 3.0, 0.99
"""Largest distance of a point from the nearest sample, over a quantile of the samples' distances from each other."""
OPENING, OPENED, MOST_OPENINGS = 0.8, 0.6, 3
"""First alpha that is to open a hollow, over the largest distance in it; the ratio of that distance to what is left of it from which on it is open;
and the number of times that alpha is made smaller."""
MOST_SEGMENTS = 400
"""Largest number of flat sides of a round body that is wrapped."""


@dataclass(frozen=True)
class Geometry:
    """How bodies are meshed; lengths in metres."""

    kind: Literal["exact", "wrapped", "auto"] = "auto"
    """`exact`: no body is wrapped. `wrapped`: every conductor made of objects is. `auto`: those that cannot be meshed as they are."""
    alpha: float | None = None
    """Radius of the narrowest hollow that a wrap follows; None: chosen for each conductor."""
    offset: float | None = None
    """Distance of a wrap from what it contains; None: chosen for each conductor."""
    rtol: float = 1e-3
    """Relative accuracy that was asked for, from which offsets are chosen."""
    coarseness: float = 1.0
    """Factor on all lengths of a wrap; the comparison of two of them shows what the wrap costs."""
    opens: Mapping[str, float] = field(default_factory=dict)
    """By the names of wraps that close hollows, the largest distance (m) in these, `Wrap.closes`: alpha is so small that the widest one opens,
    which shows what closing hollows costs."""

    def opened(self, wraps: Sequence[Wrap]) -> Geometry:
        """The same with the hollows open that these wraps close."""
        return replace(self, opens={wrap.name: wrap.closes for wrap in wraps if wrap.closes})


@dataclass(frozen=True, kw_only=True)
class Wrap(Polyhedron):
    """A solid that strictly contains one or more bodies of one conductor."""

    members: tuple[str, ...]
    """The names of these bodies."""
    samples: Array
    """Points (n, 3) on their surfaces."""
    labels: Indices
    """(n,): the position in `members` of the body that each point is on."""
    alpha: float
    """Radius (m) of the narrowest hollow that the wrap follows."""
    offset: float
    """Distance (m) of the wrap from what it contains, before it was simplified."""
    closes: float = 0.0
    """Largest distance (m) from what it contains, of the parts of the wrap that close hollows; 0 if it closes none."""


def member_names(body: Body) -> tuple[str, ...]:
    """The names of the bodies that a body stands for: its own, unless it is a wrap."""
    return body.members if isinstance(body, Wrap) else (body.name,)


@dataclass(frozen=True)
class LocalLength:
    """A length (m) that is a share of the distance to what has another potential, within limits."""

    share: float
    least: float
    most: float

    def at(self, distances: Array) -> Array:
        """The length at places with these distances."""
        return np.clip(self.share * distances, self.least, self.most)


def wrap(members: Sequence[tuple[str, Array]], others: Array, geometry: Geometry) -> Wrap:
    """Wrap the triangles (n, 3, 3) of bodies, named, of one conductor; `others` (m, 3, 3) are those of everything else, in metres.

    Raises RuntimeError when the program fails or is missing.
    """
    triangles = np.concatenate([own for _, own in members])
    alpha, offset = _lengths(triangles, others, geometry)
    samples, labels = spread_points([own for _, own in members])

    def wrapped() -> tuple[Array, Indices, float]:
        vertices, corners = _run(triangles, others, alpha, offset)
        return vertices, corners, _closed(vertices[corners], samples, others, offset)

    widest = geometry.opens.get(members[0][0])
    if widest is None:
        vertices, corners, closes = wrapped()
    else:
        most = 2 * OPENING * widest
        for _ in range(MOST_OPENINGS):
            most = max(most / 2, 2 * offset.least)
            alpha = LocalLength(alpha.share, min(alpha.least, most), most)
            vertices, corners, closes = wrapped()
            if closes < OPENED * widest or most <= 2 * offset.least:
                break
    parts = connected_parts(corners)
    return Wrap(
        members[0][0],
        vertices,
        corners,
        tuple(parts),
        smallest_width(vertices, corners, parts),
        members=tuple(name for name, _ in members),
        samples=samples,
        labels=labels,
        alpha=alpha.least,
        offset=offset.least,
        closes=closes,
    )


def _lengths(triangles: Array, others: Array, geometry: Geometry) -> tuple[LocalLength, LocalLength]:
    """Alpha and the offset."""
    extent = float(np.linalg.norm(np.ptp(triangles.reshape(-1, 3), axis=0)))
    gap = soup_distance(triangles, others) if len(others) else math.inf
    if gap == 0:
        gap = extent
    share = geometry.coarseness * min(max(SHARE_OF_RTOL * geometry.rtol, LEAST_SHARE), LARGEST_SHARE)
    widest = ALPHA_OF_EXTENT * extent
    least = geometry.coarseness * geometry.offset if geometry.offset else share * min(gap, widest)
    offset = LocalLength(share, least, max(least, share * OFFSET_OF_EXTENT * extent))
    narrow, wide = (geometry.alpha or min(ALPHA_SHARE * gap, widest)), geometry.alpha or widest
    narrow, wide = (max(geometry.coarseness * length, 2 * least) for length in (narrow, wide))
    return LocalLength(geometry.coarseness * ALPHA_SHARE, narrow, wide), offset


def _closed(wrapped: Array, samples: Array, others: Array, offset: LocalLength) -> float:
    """The largest distance from `samples` of points on a wrap (n, 3, 3) that are farther away than it was allowed to be simplified; 0 if none
    are. The distance of points on the wrapped bodies from the nearest sample counts as nothing."""
    points, _ = spread_points([wrapped])
    tree = cKDTree(samples)
    away = tree.query(points)[0]
    spacing = float(np.quantile(tree.query(samples, k=2)[0][:, 1], SPACING_QUANTILE))
    nearest = np.full(len(points), np.inf)
    if len(others):
        # All points of a distant plane are nearly equally far, and the exact nearest one takes a minute to find.
        nearest = cKDTree(spread_points([others])[0]).query(
            points, eps=OTHERS_TOLERANCE, distance_upper_bound=offset.most / offset.share
        )[0]
    far = away > CLOSED * ALLOWED_OVER_OFFSET * offset.at(nearest) + SPACINGS * spacing
    return float(away[far].max(initial=0.0))


def _run(triangles: Array, others: Array, alpha: LocalLength, offset: LocalLength) -> tuple[Array, Indices]:
    """Run fringe-wrap; returns the vertices and triangles of its surface."""
    program = installation.wrap_program()
    lengths = [number for own in (alpha, offset) for number in (own.least, own.share, own.most)]
    with temporary_folder() as folder:
        names = [folder / name for name in ("in.off", "others.off", "out.off")]
        _write_off(names[0], triangles)
        _write_off(names[1], others)
        try:
            words = ending_with_this(
                [program, *names, *map(repr, map(float, [*lengths, ALLOWED_OVER_OFFSET]))]
            )
        except FileNotFoundError as missing:
            raise RuntimeError(f"wrapping failed: {program} is missing: ./run builds it") from missing
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"wrapping failed: {done.stderr.strip() or done.returncode}")
        return _read_off(names[2])


def _write_off(path: Path, triangles: Array) -> None:
    points, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = np.column_stack([np.full(len(triangles), 3), numbers.reshape(-1, 3)])
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        np.savetxt(file, points, fmt="%.17g")
        np.savetxt(file, faces, fmt="%d")


def _read_off(path: Path) -> tuple[Array, Indices]:
    numbers = path.read_text(encoding="ascii").split()[1:]
    points, faces = int(numbers[0]), int(numbers[1])
    vertices = np.array(numbers[3 : 3 + 3 * points], dtype=np.float64).reshape(-1, 3)
    corners = np.array(numbers[3 + 3 * points :], dtype=np.int64).reshape(faces, 4)[:, 1:]
    return vertices, corners


def spread_points(bodies: Sequence[Array]) -> tuple[Array, Indices]:
    """Points spread over the triangles of each body, in proportion to their areas, with the number of the body."""
    random = np.random.default_rng(1)
    areas = [np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1) / 2 for t in bodies]
    whole = sum(float(area.sum()) for area in areas)
    points, labels = [], []
    for k, (triangles, area) in enumerate(zip(bodies, areas)):
        count = 1 + int(SAMPLES * area.sum() / whole)
        chosen = random.choice(len(triangles), count, p=area / area.sum())
        u, v = np.sqrt(random.random(count)), random.random(count)
        weights = np.column_stack([1 - u, u * (1 - v), u * v])
        points.append(np.einsum("nk,nki->ni", weights, triangles[chosen]))
        labels.append(np.full(count, k))
    return np.concatenate(points), np.concatenate(labels)


def containing_triangles(shape: Shape, tolerance: float) -> Array:
    """Triangles (n, 3, 3) of a shape, in its frame; those of a round one contain it, and exceed it by at most about `tolerance`."""

    def sides(radius: float, degrees: float = 360.0) -> int:
        whole = math.pi / math.sqrt(2 * min(tolerance / radius, 0.1))
        return max(3, math.ceil(min(max(whole, 24), MOST_SEGMENTS) * degrees / 360))

    match shape:
        case shapes.Cylinder() | shapes.Cone() | shapes.Disc():
            n = sides(shape.radius)
            return replace(shape, radius=shape.radius / math.cos(math.pi / n), segments=n).triangles()
        case shapes.Sphere() | shapes.Capsule():
            step = 2 if isinstance(shape, shapes.Sphere) else 4
            n = step * math.ceil(sides(shape.radius) / step)
            return replace(shape, radius=shape.radius / math.cos(math.pi / n) ** 2, segments=n).triangles()
        case shapes.Ellipsoid():
            n = 2 * math.ceil(sides(max(shape.semi_axes)) / 2)
            x, y, z = (length / math.cos(math.pi / n) ** 2 for length in shape.semi_axes)
            return replace(shape, semi_axes=(x, y, z), segments=n).triangles()
        case shapes.RoundedCuboid():
            n = 4 * math.ceil(sides(shape.rounding) / 4)
            radius = shape.rounding / math.cos(math.pi / n) ** 2
            x, y, z = (length + 2 * (radius - shape.rounding) for length in shape.size)
            return replace(shape, size=(x, y, z), rounding=radius, segments=n).triangles()
        case shapes.Arc():
            n = sides(shape.outer_radius, shape.degrees)
            outer = shape.outer_radius / math.cos(math.radians(shape.degrees) / (2 * n))
            return replace(shape, outer_radius=outer, segments=n).triangles()
    return np.asarray(shape.triangles())
