"""How far bodies are from each other, and whether one holds the other.

Every body is a union of convex pieces, each the convex hull of points and circles, thickened by a radius. The distance of two
convex pieces is that of their Minkowski difference from the origin. It is found from ever more of the difference's
extreme points (Wolfe 1976; with one point at a time it is the method of Gilbert, Johnson & Keerthi): the point nearest to
the origin in the hull of those found so far bounds the distance from above, the plane through the next one from below.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.spatial.distance import cdist

from fem_reference.bodies.shapes import Body, Cuboid, Disc, Rectangle, separation
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Sphere

Vector = NDArray[np.float64]

MayTouch = Rectangle | Cuboid | Cylinder | Cone
MAY_TOUCH = (Rectangle, Cuboid, Cylinder, Cone)
"""The bodies that may touch a dielectric one: convex, and with plane faces."""

TOUCHING = 1e-9
"""Distance over size below which two bodies touch: coordinates are written with some ten digits."""
DISTANCE_TOLERANCE = 1e-6
"""Relative width between the two bounds at which the distance counts as found; the lower one is returned."""
MOST_STEPS = 200
AWAY = np.array([1.0, 0.0, 0.0])
"""Any direction."""
SHRINKING = 1e-6
"""Share of its size by which a body is shrunk to see whether it overlaps another one or only touches it."""
FLAT = 1e-7
"""Distance from a plane, over the reach of a piece, within which points lie in it."""
ARC_TOLERANCE = 1e-4
"""How much larger than an arc, over its size, the convex pieces may be that stand for it."""


@dataclass(frozen=True)
class Piece:
    """The convex hull of points (n, 3) and circles (centre, two radius vectors), thickened by `radius`."""

    points: Vector
    circles: tuple[tuple[Vector, Vector, Vector], ...] = ()
    radius: float = 0.0

    @property
    def centre(self) -> Vector:
        centres = [self.points, *(circle[0][None] for circle in self.circles)]
        return np.asarray(np.concatenate(centres).mean(axis=0))

    @property
    def reach(self) -> float:
        """The radius of a sphere about `centre` that holds the piece."""
        middle = self.centre
        far = [float(np.linalg.norm(self.points - middle, axis=1).max())] if len(self.points) else []
        far += [float(np.linalg.norm(c - middle) + np.linalg.norm(u)) for c, u, _ in self.circles]
        return max(far) + self.radius

    def extreme(self, direction: Vector) -> Vector:
        """The point of the hull (without the radius) that is farthest in a direction."""
        found = [self.points[np.argmax(self.points @ direction)]] if len(self.points) else []
        for centre, u, v in self.circles:
            a, b = float(u @ direction), float(v @ direction)
            length = math.hypot(a, b)
            found.append(centre + (a * u + b * v) / length if length > 0 else centre + u)
        return max(found, key=lambda point: float(point @ direction))

    def ends_in_face(self, direction: Vector) -> bool:
        """Whether the points farthest in a unit direction make up a plane face, not a line or a point."""
        tolerance = FLAT * self.reach
        farthest = float(self.extreme(direction) @ direction)
        for centre, u, v in self.circles:
            tilt = math.hypot(float(u @ direction), float(v @ direction))
            if tilt <= tolerance and farthest - float(centre @ direction) <= tolerance:
                return True
        face = self.points[self.points @ direction >= farthest - tolerance]
        return len(face) >= 3


def distance(first: Body, second: Body) -> float:
    """The shortest distance (m) between two bodies, at most DISTANCE_TOLERANCE too small; 0 when they meet.

    A polyhedron is its surface here: what it holds inside is at a distance too.
    """
    if isinstance(first, Rectangle | Cuboid) and isinstance(second, Rectangle | Cuboid):
        return separation(first, second)
    one, other = pieces(first), pieces(second)
    centres = [np.array([piece.centre for piece in each]) for each in (one, other)]
    reaches = [np.array([piece.reach for piece in each]) for each in (one, other)]
    least = cdist(*centres) - reaches[0][:, None] - reaches[1][None]
    i, j = np.unravel_index(least.argmin(), least.shape)
    best = _piece_distance(one[i], other[j])
    close = np.argwhere(least < best)
    for i, j in close[np.argsort(least[close[:, 0], close[:, 1]])]:
        if least[i, j] >= best:
            break
        best = min(best, _piece_distance(one[i], other[j]))
    return best


def in_contact(first: Body, second: Body) -> bool:
    """Whether two bodies of shapes that may touch do so."""
    if not (isinstance(first, MAY_TOUCH) and isinstance(second, MAY_TOUCH)):
        return False
    return distance(first, second) <= TOUCHING * min(first.size, second.size)


def touch_with_faces(first: Body, second: Body) -> bool:
    """Whether two bodies that meet, the second a solid, have plane faces in one plane there and no volume in common.

    The second is shrunk about its middle: what only touched it is then off it, and the direction tells the faces. Only for
    shapes that may touch; of others it is not known.
    """
    if not (isinstance(first, MAY_TOUCH) and isinstance(second, MAY_TOUCH)):
        return False
    (one,), (other,) = pieces(first), pieces(second)
    shrunk = Piece(
        second.centre + (1 - SHRINKING) * (other.points - second.centre),
        tuple(
            (
                second.centre + (1 - SHRINKING) * (centre - second.centre),
                (1 - SHRINKING) * u,
                (1 - SHRINKING) * v,
            )
            for centre, u, v in other.circles
        ),
    )
    apart, direction = _nearest(one, shrunk)
    if apart <= TOUCHING * min(first.size, second.size):
        return False
    return one.ends_in_face(-direction) and shrunk.ends_in_face(direction)


def holds(outer: Body, inner: Body) -> bool:
    """Whether the solid `outer` holds `inner`, or a part of it that its surface does not meet."""
    if isinstance(outer, Polyhedron):
        if distance(outer, inner) <= TOUCHING * min(outer.size, inner.size):
            return False
        firsts = [part[0] for part in inner.parts] if isinstance(inner, Polyhedron) else [0]
        some = [pieces(inner)[k] for k in firsts]
        return bool(
            outer.holds(np.array([piece.extreme(AWAY) + piece.radius * AWAY for piece in some])).any()
        )
    if not outer.is_solid:
        return False
    solid = pieces(outer)
    points = [Piece(point[None]) for point in [*inner.corners, inner.corners.mean(axis=0)]]
    return all(any(_piece_distance(piece, point) == 0 for piece in solid) for point in points)


def gap_to_walls(body: Body, room: Cuboid) -> float:
    """The shortest distance (m) of a body from the walls of a room it is in; negative when it is not."""
    gaps = [
        half - (float((piece.extreme(side * axis) - room.centre) @ (side * axis)) + piece.radius)
        for piece in pieces(body)
        for axis, half in zip(room.axes, room.half_widths)
        for side in (1.0, -1.0)
    ]
    return min(gaps)


def pieces(body: Body) -> list[Piece]:
    """The convex pieces that a body consists of; a polyhedron's are the triangles of its surface."""
    if isinstance(body, Rectangle | Cuboid):
        return [Piece(body.corners)]
    if isinstance(body, Sphere):
        return [Piece(body.centre[None], radius=body.radius)]
    if isinstance(body, Polyhedron):
        return [Piece(triangle) for triangle in body.vertices[body.triangles]]
    if isinstance(body, Arc):
        return _arc_pieces(body)
    u, v = body.radius * body.axes[:2]
    nowhere = np.empty((0, 3))
    if isinstance(body, Disc):
        return [Piece(nowhere, ((body.centre, u, v),))]
    up = body.height / 2 * body.axes[2]
    if isinstance(body, Cone):
        return [Piece((body.centre + up)[None], ((body.centre - up, u, v),))]
    return [Piece(nowhere, ((body.centre - up, u, v), (body.centre + up, u, v)))]


def _arc_pieces(arc: Arc) -> list[Piece]:
    """Wedges that cover the arc: their outer corners lie on the tangents, their inner ones on the inner wall."""
    step = math.sqrt(8 * ARC_TOLERANCE * arc.size / arc.outer_radius)
    count = math.ceil(2 * arc.half_angle / step)
    angles = np.linspace(-arc.half_angle, arc.half_angle, count + 1)
    outer = arc.outer_radius / math.cos(arc.half_angle / count)
    rays = np.cos(angles)[:, None] * arc.axes[0] + np.sin(angles)[:, None] * arc.axes[1]
    up = arc.height / 2 * arc.axes[2]
    ends = [arc.centre + radius * rays + z for radius in (arc.inner_radius, outer) for z in (-up, up)]
    return [Piece(np.array([end[k + side] for end in ends for side in (0, 1)])) for k in range(count)]


def _piece_distance(first: Piece, second: Piece) -> float:
    """A lower bound of the distance of two convex pieces, tight to DISTANCE_TOLERANCE; 0 when they meet."""
    return _nearest(first, second)[0]


def _nearest(first: Piece, second: Piece) -> tuple[float, Vector]:
    """The distance as `_piece_distance` has it, and a unit vector from the second piece to the first; 0 when they meet."""
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


def _nearest_in_hull(points: Vector, scale: float) -> Vector:
    """The point of the convex hull of points (n, 3) that is nearest to the origin.

    Minimising |Σ w_i p_i|² + scale²·(Σ w_i − 1)² over w ≥ 0 gives its weights up to their sum (Wolfe 1976).
    """
    matrix = np.vstack([points.T, np.full(len(points), scale)])
    weights, _ = nnls(matrix, np.array([0.0, 0.0, 0.0, scale]), maxiter=100 * len(points))
    return np.asarray(weights @ points / weights.sum())
