"""Distances between bodies, and tests whether one contains another.

Every body is a union of convex pieces, each the convex hull of points, circles and ellipsoids, thickened by a radius. The distance between two
convex pieces is the distance of their Minkowski difference from the origin. It is found from a growing set of extreme points of the
difference (Wolfe 1976; with one point at a time it is the method of Gilbert, Johnson & Keerthi). The point nearest to the origin in
the convex hull of the points so far bounds the distance from above, and the plane through the next extreme point from below.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from fem_reference.bodies.shapes import Body, Cuboid, Disc, PlanePolygon, Rectangle, Soup, Surface, separation
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, Sphere, Swept
from fem_reference.bodies.triangle_distances import soup_distance
from geometries.common.arrays import Array

MAY_TOUCH = (Rectangle, Disc, PlanePolygon, Cuboid, Cylinder, Cone)
"""The shapes that may touch a dielectric body: with plane faces, and convex but for polygons."""

TOUCHING = 1e-9
"""Distance over size below which two bodies count as touching, since coordinates are written with some ten digits."""
DISTANCE_TOLERANCE = 1e-6
"""Relative distance of the two bounds at which the iteration ends; the lower bound is returned."""
MOST_STEPS = 200
"""Largest number of iterations."""
AWAY = np.array([1.0, 0.0, 0.0])
"""An arbitrary direction, in which the extreme point of a body is taken to represent it."""
SHRINKING = 1e-6
"""Share of its size by which the faces of a body are moved inwards to decide whether it overlaps another body or only touches it."""
MOST_SHRINKING = 0.1
"""Largest share of its own extent by which a thin body is shrunk to that end."""
LEAST_OVERLAP = 1e-2
"""Share of its size by which a body is shrunk, and overlaps another one still, where what both have in common is thick enough to mesh."""
FLAT = 1e-7
"""Largest distance from a plane, over the bounding radius of a piece, at which points count as lying in the plane."""
CUBOID_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""The faces of a cuboid as numbers of its corners."""
ARC_TOLERANCE = 1e-4
"""Largest distance by which the convex pieces that cover an arc may exceed it, over its size."""


@dataclass(frozen=True)
class Piece:
    """The convex hull of points (n, 3), circles (centre, two radius vectors) and ellipsoids (centre, three), thickened by `radius`."""

    points: Array
    circles: tuple[tuple[Array, ...], ...] = ()
    radius: float = 0.0

    @property
    def centre(self) -> Array:
        """The mean of the points and of the centres of circles and ellipsoids."""
        centres = [self.points, *(circle[0][None] for circle in self.circles)]
        return np.asarray(np.concatenate(centres).mean(axis=0))

    @property
    def reach(self) -> float:
        """The bounding radius: that of a sphere about `centre` that contains the piece."""
        middle = self.centre
        far = [float(np.linalg.norm(self.points - middle, axis=1).max())] if len(self.points) else []
        for centre, *radii in self.circles:
            far.append(float(np.linalg.norm(centre - middle) + max(np.linalg.norm(u) for u in radii)))
        return max(far) + self.radius

    def extreme(self, direction: Array) -> Array:
        """The support point: the point of the hull, not thickened, that is farthest in a direction."""
        found = [self.points[np.argmax(self.points @ direction)]] if len(self.points) else []
        for centre, *radii in self.circles:
            along = [float(u @ direction) for u in radii]
            length = math.hypot(*along)
            tip = sum(a * u for a, u in zip(along, radii)) / length if length > 0 else radii[0]
            found.append(centre + tip)
        return max(found, key=lambda point: float(point @ direction))

    def ends_in_face(self, direction: Array) -> bool:
        """Whether the points farthest in a unit direction form a plane face rather than a line or a point."""
        tolerance = FLAT * self.reach
        farthest = float(self.extreme(direction) @ direction)
        for centre, *radii in self.circles:
            tilt = math.hypot(*(float(u @ direction) for u in radii))
            if tilt <= tolerance and farthest - float(centre @ direction) <= tolerance:
                return True
        face = self.points[self.points @ direction >= farthest - tolerance]
        return len(face) >= 3


def distance(first: Surface, second: Surface) -> float:
    """The shortest distance (m) between two bodies, too small by a factor of at most DISTANCE_TOLERANCE; 0 when they meet.

    Distances from triangles are those from their surface, for bodies inside of it too.
    """
    if isinstance(first, Rectangle | Cuboid) and isinstance(second, Rectangle | Cuboid):
        return separation(first, second)
    triangles = triangles_of(first), triangles_of(second)
    if triangles[0] is not None and triangles[1] is not None:
        return soup_distance(triangles[0], triangles[1])
    if triangles[0] is not None:
        return min(_from_triangles(triangles[0], piece) for piece in pieces(second))
    if triangles[1] is not None:
        return min(_from_triangles(triangles[1], piece) for piece in pieces(first))
    pairs = [(one, other) for one in pieces(first) for other in pieces(second)]
    least = [np.linalg.norm(one.centre - other.centre) - one.reach - other.reach for one, other in pairs]
    best = np.inf
    for k in np.argsort(least):
        if least[k] >= best:
            break
        best = min(best, _piece_distance(*pairs[k]))
    return float(best)


def _from_triangles(triangles: Array, piece: Piece) -> float:
    """The distance of triangles (n, 3, 3) from a convex piece.

    A plane between the piece and the nearest triangle so far bounds all distances from below, so that few triangles are looked at.
    """
    centres = triangles.mean(axis=1)
    least = np.linalg.norm(centres - piece.centre, axis=1) - piece.reach
    least -= np.linalg.norm(triangles - centres[:, None], axis=2).max(axis=1)
    best = np.inf
    while True:
        k = int(least.argmin())
        if least[k] >= best * (1 - DISTANCE_TOLERANCE):
            return float(best)
        found, direction = _distance_and_direction(Piece(triangles[k]), piece)
        best = min(best, found)
        if best == 0:
            return 0.0
        behind = float(piece.extreme(direction) @ direction) + piece.radius
        least = np.maximum(least, (triangles @ direction).min(axis=1) - behind)
        least[k] = np.inf


def triangles_of(body: Surface) -> Array | None:
    """The triangles (n, 3, 3) of the surface of a body without round surfaces; None for other bodies."""
    if isinstance(body, Soup):
        return body.triangles
    if isinstance(body, Polyhedron):
        return np.asarray(body.vertices[body.triangles])
    if isinstance(body, PlanePolygon):
        return body.triangles
    if isinstance(body, Rectangle):
        return np.asarray(body.corners[[[0, 1, 2], [0, 2, 3]]])
    if isinstance(body, Cuboid):
        quads = np.array(CUBOID_FACES)
        return np.asarray(body.corners[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])])
    return None


def in_contact(first: Body, second: Body) -> bool:
    """Whether two bodies touch or overlap."""
    return distance(first, second) <= TOUCHING * min(first.size, second.size)


def overlap(first: Surface, second: Surface) -> bool:
    """Whether two convex solids have a volume in common that is not too thin to mesh, and neither contains the other."""
    one, other = pieces(first), pieces(second)
    if len(one) > 1 or len(other) > 1 or holds(first, second) or holds(second, first):
        return False
    smaller = _shrunk(other[0], second.corners.mean(axis=0), LEAST_OVERLAP)
    return _piece_distance(one[0], smaller) <= TOUCHING * min(first.size, second.size)


def touch_with_faces(first: Surface, second: Surface) -> bool:
    """Whether two bodies that meet, the second of them a solid, touch with plane faces in one plane and do not overlap.

    The second body is shrunk about its centre. If the bodies only touched, they are then apart, and the direction of their distance
    shows with which faces they touched. For shapes that may not touch the answer is False.
    """
    if not (isinstance(first, MAY_TOUCH) and isinstance(second, MAY_TOUCH) and second.is_solid):
        return False
    (other,) = pieces(second)
    # The faces of a thin body, too, move by a length that the search for the distance resolves.
    shrinking = min(SHRINKING * other.reach / _half_thickness(second), MOST_SHRINKING)
    shrunk = _shrunk(other, second.centre, shrinking)
    touching = TOUCHING * min(first.size, second.size)
    for one in pieces(first):
        if _piece_distance(one, other) > touching:
            continue
        apart, direction = _distance_and_direction(one, shrunk)
        if apart <= touching or not (one.ends_in_face(-direction) and shrunk.ends_in_face(direction)):
            return False
    return True


def _shrunk(piece: Piece, about: Array, share: float) -> Piece:
    """The piece, shrunk about a point by a share of its size."""
    return Piece(
        about + (1 - share) * (piece.points - about),
        tuple(
            (about + (1 - share) * (centre - about), *((1 - share) * u for u in radii))
            for centre, *radii in piece.circles
        ),
        (1 - share) * piece.radius,
    )


def _half_thickness(body: Body) -> float:
    """Half the smallest extent (m) of a body along its principal axes, by its corners."""
    offsets = body.corners - body.corners.mean(axis=0)
    axes = np.linalg.svd(offsets, full_matrices=False)[2]
    return float(np.abs(offsets @ axes.T).max(axis=0).min())


def holds(outer: Surface, inner: Surface) -> bool:
    """Whether the solid `outer` contains `inner`; triangles also if they contain one of the parts of `inner`.

    Bodies that meet the surface of triangles do not count as contained.
    """
    if isinstance(outer, Polyhedron | Soup):
        if distance(outer, inner) <= TOUCHING * min(outer.size, inner.size):
            return False
        return bool(outer.holds(_one_point_of_each_part(inner)).any())
    if not outer.is_solid:
        return False
    solid = pieces(outer)
    points = (Piece(point[None]) for point in [*inner.corners, inner.corners.mean(axis=0)])
    return all(any(_piece_distance(piece, point) == 0 for piece in solid) for point in points)


def _one_point_of_each_part(body: Surface) -> Array:
    """One point (n, 3) of each part of a body, the parts of a mesh in any state being unknown."""
    if isinstance(body, Polyhedron):
        return np.asarray(body.vertices[body.triangles[[part[0] for part in body.parts], 0]])
    if isinstance(body, Soup):
        return np.asarray(body.triangles[:1, 0])
    piece = pieces(body)[0]
    return np.asarray((piece.extreme(AWAY) + piece.radius * AWAY)[None])


def gap_to_walls(body: Surface, room: Cuboid) -> float:
    """The shortest distance (m) between a body and the walls of the room around it; negative when the body is not inside."""
    if isinstance(body, Polyhedron | Soup):
        offsets = np.abs((body.corners - room.centre) @ room.axes.T)
        return float((np.array(room.half_widths) - offsets).min())
    gaps = [
        half - (float((piece.extreme(side * axis) - room.centre) @ (side * axis)) + piece.radius)
        for piece in pieces(body)
        for axis, half in zip(room.axes, room.half_widths)
        for side in (1.0, -1.0)
    ]
    return min(gaps)


def pieces(body: Surface) -> list[Piece]:
    """The convex pieces that a body consists of; those of a polyhedron are the triangles of its surface."""
    if isinstance(body, Rectangle | Cuboid):
        return [Piece(body.corners)]
    if isinstance(body, Sphere):
        return [Piece(body.centre[None], radius=body.radius)]
    if isinstance(body, Polyhedron | Soup | PlanePolygon):
        triangles = triangles_of(body)
        return [] if triangles is None else [Piece(triangle) for triangle in triangles]
    if isinstance(body, Arc):
        return _arc_pieces(body)
    if isinstance(body, Swept):
        return [Piece(body.core_corners, radius=body.radius)]
    if isinstance(body, Ellipsoid):
        radii = np.array(body.semi_axes)[:, None] * body.axes
        return [Piece(np.empty((0, 3)), ((body.centre, *radii),))]
    u, v = body.radius * body.axes[:2]
    nowhere = np.empty((0, 3))
    if isinstance(body, Disc):
        return [Piece(nowhere, ((body.centre, u, v),))]
    up = body.height / 2 * body.axes[2]
    if isinstance(body, Cone):
        return [Piece((body.centre + up)[None], ((body.centre - up, u, v),))]
    return [Piece(nowhere, ((body.centre - up, u, v), (body.centre + up, u, v)))]


def _arc_pieces(arc: Arc) -> list[Piece]:
    """Wedges that cover the arc. Their outer corners lie on tangents of the outer circle, their inner corners on the inner circle."""
    step = math.sqrt(8 * ARC_TOLERANCE * arc.size / arc.outer_radius)
    count = math.ceil(2 * arc.half_angle / step)
    angles = np.linspace(-arc.half_angle, arc.half_angle, count + 1)
    outer = arc.outer_radius / math.cos(arc.half_angle / count)
    rays = np.cos(angles)[:, None] * arc.axes[0] + np.sin(angles)[:, None] * arc.axes[1]
    up = arc.height / 2 * arc.axes[2]
    ends = [arc.centre + radius * rays + z for radius in (arc.inner_radius, outer) for z in (-up, up)]
    return [Piece(np.array([end[k + side] for end in ends for side in (0, 1)])) for k in range(count)]


def _piece_distance(first: Piece, second: Piece) -> float:
    """A lower bound of the distance between two convex pieces, tight to DISTANCE_TOLERANCE; 0 when they meet."""
    return _distance_and_direction(first, second)[0]


def _distance_and_direction(first: Piece, second: Piece) -> tuple[float, Array]:
    """The distance that `_piece_distance` returns, and the unit vector along it from the second piece to the first.

    Both are 0 when the pieces meet.
    """
    thickness = first.radius + second.radius
    scale = first.reach + second.reach + float(np.linalg.norm(first.centre - second.centre))
    start = first.centre - second.centre
    found = [first.extreme(-start) - second.extreme(start)]
    bound = 0.0
    for _ in range(MOST_STEPS):
        nearest = _nearest_in_hull(np.array(found), scale)
        length = float(np.linalg.norm(nearest))
        if length <= thickness or length <= 1e-12 * scale:
            return 0.0, np.zeros(3)
        following = first.extreme(-nearest) - second.extreme(nearest)
        bound = max(bound, float(following @ nearest) / length)
        if length - bound <= DISTANCE_TOLERANCE * (length - thickness):
            break
        found.append(following)
    return max(bound - thickness, 0.0), nearest / length


def _nearest_in_hull(points: Array, scale: float) -> Array:
    """The point of the convex hull of points p_i (n, 3) that is nearest to the origin.

    Minimising |Σ w_i p_i|² + scale²·(Σ w_i − 1)² over w ≥ 0 gives the weights of this point up to a common factor (Wolfe 1976).
    """
    matrix = np.vstack([points.T, np.full(len(points), scale)])
    weights, _ = nnls(matrix, np.array([0.0, 0.0, 0.0, scale]), maxiter=100 * len(points))
    return np.asarray(weights @ points / weights.sum())
