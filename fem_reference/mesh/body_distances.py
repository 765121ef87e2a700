"""Distances of points from bodies, and radii of curvature, in closed form: for arrays of points, and for tapes (`tape`).

Most bodies are symmetric about the coordinate planes of their own frame, so that a distance depends only on the absolute values of a
point's coordinates. Inside spheres, cylinders, cones and ellipsoids the distance is that to the surface, so that the mesh
coarsens towards their middle; inside cuboids and arcs it is 0, and within a swept box the ball's radius. The distance to an ellipsoid
is one of first order: it only steers the size of cells.
"""

from __future__ import annotations

import math

import numpy as np

from fem_reference.bodies.shapes import Cuboid, Disc, PlanePolygon, Rectangle, Sheet
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, RoundBody, Sphere, Swept
from fem_reference.mesh.tape import Point, Quantity, smallest
from geometries.common.arrays import Array

ClosedFormBody = Sheet | Cuboid | RoundBody
"""The bodies whose distances have closed forms."""
MOST_SEGMENTS = 2000
"""Largest number of segments of an ellipsoid's focal curve."""


def surface_distance(body: ClosedFormBody, point: Point) -> Quantity:
    """Distance to the body."""
    if isinstance(body, Sphere):
        return np.abs(_norm(_from_centre(body, point)) - body.radius)
    if isinstance(body, PlanePolygon):
        return _polygon_distance(body, point)
    if isinstance(body, Ellipsoid):
        stretched, gradient = _ellipsoid_norms(body, point)
        return stretched * np.abs(stretched - 1) / gradient
    x, y, z = _folded(body, point)
    if isinstance(body, Swept):
        return np.abs(_norm([_beyond(c, w) for c, w in zip((x, y, z), body.core)]) - body.radius)
    if isinstance(body, Disc):
        return _norm([_beyond(_norm([x, y]), body.radius), z])
    if isinstance(body, Cylinder):
        beside, above = _norm([x, y]) - body.radius, z - body.height / 2
        outside = _norm([np.maximum(beside, 0), np.maximum(above, 0)])
        return outside - np.minimum(np.maximum(beside, above), 0)
    if isinstance(body, Cone):
        return np.minimum(_cone_side_distance(body, point), _cone_base_distance(body, point))
    if isinstance(body, Arc):
        return _arc_surface_distance(body, point)
    widths = [*body.half_widths, 0.0][:3]
    return _norm([_beyond(c, w) for c, w in zip((x, y, z), widths)])


def distance_from_surface(body: RoundBody, points: Array) -> Array:
    """The distances (n,) of points (3, n) from the surface of a round body, also of points inside; to an ellipsoid, to first order."""
    if not isinstance(body, Arc):
        return np.asarray(surface_distance(body, points))
    x, y, z = (np.asarray(coordinate) for coordinate in _local(body, points))
    past_end, along = _arc_coordinates(body, points)
    inside = [
        np.abs(along - body.inner_radius),
        np.abs(along - body.outer_radius),
        np.abs(np.abs(z) - body.height / 2),
    ]
    if not body.is_ring:
        inside.append(np.abs(np.asarray(past_end)))
    outside = np.asarray(surface_distance(body, points))
    return np.where(outside > 0, outside, np.min(inside, axis=0))


def wall_distance(room: Cuboid, point: Point) -> Quantity:
    """Distance from a point inside a room to its walls."""
    return smallest([half - c for c, half in zip(_folded(room, point), room.half_widths)])


def edge_distance(body: ClosedFormBody, point: Point) -> Quantity | None:
    """Distance to the nearest edge or apex of the body; None when it has none."""
    if isinstance(body, Sphere | Ellipsoid | Swept):
        return None
    if isinstance(body, PlanePolygon):
        x, y, z = _local(body, point)
        return _norm([_outline_distance_in_plane(body, x, y), z])
    x, y, z = _folded(body, point)
    if isinstance(body, Disc):
        return _norm([_norm([x, y]) - body.radius, z])
    if isinstance(body, Cylinder):
        return _norm([_norm([x, y]) - body.radius, z - body.height / 2])
    if isinstance(body, Cone):
        x, y, z = _local(body, point)
        return np.minimum(
            _norm([_norm([x, y]) - body.radius, z + body.height / 2]), _norm([x, y, z - body.height / 2])
        )
    if isinstance(body, Arc):
        return _arc_edge_distance(body, point)
    if isinstance(body, Cuboid):
        return _box_edge_distance((x, y, z), body.half_widths)
    a, b = body.half_widths
    return np.sqrt(np.minimum(_beyond(x, a) ** 2 + (y - b) ** 2, (x - a) ** 2 + _beyond(y, b) ** 2) + z**2)


def curvature_radius(body: ClosedFormBody, point: Point) -> Quantity | None:
    """The smaller principal radius of curvature of the surface near a point; None for bodies with plane faces only."""
    if isinstance(body, Sphere | Cylinder | Swept):
        return body.radius
    if isinstance(body, Ellipsoid):
        return _ellipsoid_curvature_radius(body, point)
    if isinstance(body, Cone):
        _, _, z = _local(body, point)
        return np.maximum(body.height / 2 - z, 0) * (body.radius / body.height)
    if isinstance(body, Arc):
        x, y, _ = _folded(body, point)
        return np.maximum(_norm([x, y]), body.inner_radius)
    return None


def focal_curve(ellipsoid: Ellipsoid) -> Array:
    """The segments (n, 2, 3) of a closed curve whose distance is, where the surface is bent most, the smaller radius of curvature there.

    It is the border of the ellipsoid's medial surface, an ellipse with the semi-axes a − c²/a and b − c²/b in the plane of a and b, if c is
    the smallest; a needle's is a segment, a ball's the centre.
    """
    order = np.argsort(ellipsoid.semi_axes)[::-1]
    (a, b, c), axes = np.array(ellipsoid.semi_axes)[order], ellipsoid.axes[order]
    first, second = a - c * c / a, b - c * c / b
    # Chords come within a fifth of the least radius of curvature of the ellipse.
    sides = math.ceil(min(max(16.0, math.pi * math.sqrt(2.5 * first * a / (c * c))), MOST_SEGMENTS))
    angles = 2 * np.pi * np.arange(sides + 1) / sides
    points = (
        ellipsoid.centre
        + np.outer(first * np.cos(angles), axes[0])
        + np.outer(second * np.sin(angles), axes[1])
    )
    return np.stack([points[:-1], points[1:]], axis=1)


def curved_distance(body: ClosedFormBody, point: Point) -> Quantity | None:
    """Distance to the curved part of the surface of a body that has plane faces, too; None for other bodies."""
    if isinstance(body, Swept):
        return np.abs(_box_edge_distance(_folded(body, point), body.core) - body.radius)
    return None


def _norm(parts: Point) -> Quantity:
    """The length of a vector, given by its coordinates."""
    squares = parts[0] ** 2
    for part in parts[1:]:
        squares = squares + part**2
    return np.sqrt(squares)


def _from_centre(body: ClosedFormBody, point: Point) -> list[Quantity]:
    """The coordinates of the vector from the body's centre."""
    return [c - origin for c, origin in zip(point, body.centre.tolist())]


def _local(body: Sheet | Cuboid | Ellipsoid | Swept | Cylinder | Cone | Arc, point: Point) -> list[Quantity]:
    """The three coordinates in the body's frame."""
    x, y, z = _from_centre(body, point)
    return [a * x + b * y + c * z for a, b, c in body.axes.tolist()]


def _folded(body: Rectangle | Disc | Cuboid | Swept | Cylinder | Cone | Arc, point: Point) -> list[Quantity]:
    """The absolute values of the three coordinates in the body's frame."""
    return [np.abs(coordinate) for coordinate in _local(body, point)]


def _beyond(coordinate: Quantity, limit: float) -> Quantity:
    """How far a coordinate exceeds a limit; 0 when it does not."""
    return np.maximum(coordinate - limit, 0)


def _box_edge_distance(folded: Point, half_widths: tuple[float, float, float]) -> Quantity:
    """Distance to the edges of a box, by the absolute values of the coordinates."""
    past = [(c - w) ** 2 for c, w in zip(folded, half_widths)]
    outside = [_beyond(c, w) ** 2 for c, w in zip(folded, half_widths)]
    along = [sum(outside[k] if k == axis else past[k] for k in range(3)) for axis in range(3)]
    return np.sqrt(smallest(along))


def _ellipsoid_norms(ellipsoid: Ellipsoid, point: Point) -> tuple[Quantity, Quantity]:
    """|(x/a, y/b, z/c)|, which is 1 on the surface, and |(x/a², y/b², z/c²)|; both above 0 at the centre."""
    least = 1e-9
    parts = list(zip(_local(ellipsoid, point), ellipsoid.semi_axes))
    stretched = sum((c / a) ** 2 for c, a in parts)
    gradient = sum((c / (a * a)) ** 2 for c, a in parts)
    small = least / min(ellipsoid.semi_axes)
    return np.sqrt(stretched + least**2), np.sqrt(gradient + small**2)


def _ellipsoid_curvature_radius(ellipsoid: Ellipsoid, point: Point) -> Quantity:
    """The smaller principal radius at the point of the surface on the same ray from the centre.

    With the distance h of the tangent plane from the centre, P = (abc)² and S = a² + b² + c², the mean curvature is
    h³(S − |p|²)/2P and the Gaussian one h⁴/P.
    """
    stretched, gradient = _ellipsoid_norms(ellipsoid, point)
    squares = [a * a for a in ellipsoid.semi_axes]
    product = squares[0] * squares[1] * squares[2]
    radius = sum(c**2 for c in _local(ellipsoid, point))
    height = stretched / gradient
    mean = height * height**2 * (sum(squares) - radius / stretched**2) / (2 * product)
    gaussian = (height**2) ** 2 / product
    return 1 / (mean + np.sqrt(np.maximum(mean**2 - gaussian, 0)))


def _polygon_distance(polygon: PlanePolygon, point: Point) -> Quantity:
    """Distance to a polygon: beside it, in its plane, that to its outline.

    A point is beside it if it is beyond a side of each of its triangles. How far it is beyond the farthest side's line is less than
    the distance, but no less than a share of it: 1e3 times as much decides where the outline's distance counts, and is 0 within.
    """
    x, y, z = _local(polygon, point)
    steep = 1e3
    beside = []
    for corners in polygon.ears:
        farthest: Quantity = 0.0
        for (ax, ay), (bx, by) in zip(corners.tolist(), np.roll(corners, -1, axis=0).tolist()):
            length = math.hypot(bx - ax, by - ay)
            u, v = (by - ay) / length, (ax - bx) / length
            farthest = np.maximum(u * x + v * y - (u * ax + v * ay), farthest)
        beside.append(farthest)
    in_plane = _outline_distance_in_plane(polygon, x, y)
    return _norm([np.minimum(steep * smallest(beside), in_plane), z])


def _outline_distance_in_plane(polygon: PlanePolygon, x: Quantity, y: Quantity) -> Quantity:
    """Distance of a point's projection into the plane, with coordinates x and y there, to the nearest side of a polygon."""
    squares = []
    for (ax, ay), (bx, by) in zip(polygon.outline.tolist(), np.roll(polygon.outline, -1, axis=0).tolist()):
        length = math.hypot(bx - ax, by - ay)
        u, v = (bx - ax) / length, (by - ay) / length
        along = u * x + v * y - (u * ax + v * ay)
        across = u * y - v * x - (u * ay - v * ax)
        squares.append(np.maximum(np.maximum(-along, along - length), 0) ** 2 + across**2)
    return np.sqrt(smallest(squares))


def _cone_side_distance(cone: Cone, point: Point) -> Quantity:
    """Distance to the lateral surface, which is a segment in the half-plane of (distance from the axis, z)."""
    x, y, z = _local(cone, point)
    across, down = _norm([x, y]), cone.height / 2 - z
    length = cone.radius**2 + cone.height**2
    share = np.minimum(np.maximum((across * cone.radius + down * cone.height) / length, 0), 1)
    return _norm([across - cone.radius * share, down - cone.height * share])


def _cone_base_distance(cone: Cone, point: Point) -> Quantity:
    """Distance to the disc at the bottom of the cone."""
    x, y, z = _local(cone, point)
    return _norm([_beyond(_norm([x, y]), cone.radius), z + cone.height / 2])


def _arc_surface_distance(arc: Arc, point: Point) -> Quantity:
    """Distance to the arc; 0 inside."""
    past_end, along = _arc_coordinates(arc, point)
    in_plane = np.maximum(_norm([np.maximum(past_end, 0), _arc_radial(arc, along)]), _behind(arc, point))
    return _norm([in_plane, _beyond(_folded(arc, point)[2], arc.height / 2)])


def _arc_edge_distance(arc: Arc, point: Point) -> Quantity:
    """Distance to the nearest edge of an arc: its four circular edges and, unless it is a ring, the edges of its two ends."""
    z = _folded(arc, point)[2]
    past_end, along = _arc_coordinates(arc, point)
    above, outside = (z - arc.height / 2) ** 2, _beyond(z, arc.height / 2) ** 2
    past = np.maximum(past_end, 0) ** 2
    from_circles = [(along - radius) ** 2 for radius in (arc.inner_radius, arc.outer_radius)]
    squares = [past + square + above for square in from_circles]
    if not arc.is_ring:
        squares.append(past_end**2 + _arc_radial(arc, along) ** 2 + above)
        squares += [past_end**2 + square + outside for square in from_circles]
    return np.sqrt(np.maximum(smallest(squares), _behind(arc, point) ** 2 + outside))


def _arc_radial(arc: Arc, along: Quantity) -> Quantity:
    """How far a radius is outside of those of the arc."""
    return np.maximum(np.maximum(arc.inner_radius - along, along - arc.outer_radius), 0)


def _arc_coordinates(arc: Arc, point: Point) -> tuple[Quantity, Quantity]:
    """How far a point is past the plane of the sector's end, and its coordinate along the nearest radius of the sector."""
    x, y, _ = _local(arc, point)
    if arc.is_ring:
        return -1.0, _norm([x, y])
    past_end = math.cos(arc.half_angle) * np.abs(y) - math.sin(arc.half_angle) * x
    return past_end, np.sqrt(np.maximum(x**2 + y**2 - np.maximum(past_end, 0) ** 2, 0))


def _behind(arc: Arc, point: Point) -> Quantity:
    """Lower bound on the distance to a narrow sector from points behind it; 0 for a wide sector.

    It is the distance to the plane, at right angles to the sector's middle radius, beyond which the whole sector lies. Without it
    points behind the axis would get the distance to the sector's mirror image.
    """
    nearest = arc.inner_radius * math.cos(arc.half_angle)
    return np.maximum(nearest - _local(arc, point)[0], 0) if nearest > 0 else 0.0
