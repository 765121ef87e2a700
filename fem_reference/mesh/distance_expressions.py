"""Distances from bodies as expressions in x, y, z for gmsh's MathEval.

Most bodies are symmetric about the coordinate planes of their own frame, so that a distance depends only on the absolute values of a
point's coordinates. Inside spheres, cylinders, cones and ellipsoids the expression is the distance to the surface, so that the mesh
coarsens towards their middle; inside cuboids and arcs it is 0, and within a swept box the ball's radius. The distance to an ellipsoid
is one of first order: it only steers the size of cells.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fem_reference.bodies.shapes import Cuboid, Disc, PlanePolygon, Rectangle, Sheet
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, RoundBody, Sphere, Swept

TextBody = Sheet | Cuboid | RoundBody
"""The bodies whose distances have closed forms."""


def surface_distance(body: TextBody) -> str:
    """Distance to the body."""
    if isinstance(body, Sphere):
        return f"abs({_radius_from_centre(body)}-{body.radius!r})"
    if isinstance(body, PlanePolygon):
        return _polygon_distance(body)
    if isinstance(body, Ellipsoid):
        stretched, gradient = _ellipsoid_norms(body)
        return f"({stretched}*abs({stretched}-1)/{gradient})"
    x, y, z = _folded(body)
    if isinstance(body, Swept):
        squares = "+".join(f"{_beyond(c, w)}^2" for c, w in zip((x, y, z), body.core))
        return f"abs(sqrt({squares})-{body.radius!r})"
    if isinstance(body, Disc):
        return f"sqrt({_beyond(f'sqrt({x}^2+{y}^2)', body.radius)}^2+{z}^2)"
    if isinstance(body, Cylinder):
        beside = f"(sqrt({x}^2+{y}^2)-{body.radius!r})"
        above = f"({z}-{body.height / 2!r})"
        return f"(sqrt(max({beside},0)^2+max({above},0)^2)-min(max({beside},{above}),0))"
    if isinstance(body, Cone):
        return f"min({_cone_side_distance(body)},{_cone_base_distance(body)})"
    if isinstance(body, Arc):
        return _arc_surface_distance(body)
    widths = [*body.half_widths, 0.0][:3]
    return "sqrt(" + "+".join(f"{_beyond(c, w)}^2" for c, w in zip((x, y, z), widths)) + ")"


def evaluated(expression: str, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The values (n,) of an expression at points (n, 3)."""
    functions = {"sqrt": np.sqrt, "abs": np.abs, "max": np.maximum, "min": np.minimum}
    values = eval(expression.replace("^", "**"), functions, dict(zip("xyz", points.T)))
    return np.broadcast_to(np.asarray(values, dtype=np.float64), len(points))


def wall_distance(room: Cuboid) -> str:
    """Distance from a point inside a room to its walls."""
    return minimum([f"({half!r}-{c})" for c, half in zip(_folded(room), room.half_widths)])


def edge_distance(body: TextBody) -> str | None:
    """Distance to the nearest edge or apex of the body; None when it has none."""
    if isinstance(body, Sphere | Ellipsoid | Swept):
        return None
    if isinstance(body, PlanePolygon):
        return _outline_distance(body)
    x, y, z = _folded(body)
    if isinstance(body, Disc):
        return f"sqrt((sqrt({x}^2+{y}^2)-{body.radius!r})^2+{z}^2)"
    if isinstance(body, Cylinder):
        return f"sqrt((sqrt({x}^2+{y}^2)-{body.radius!r})^2+({z}-{body.height / 2!r})^2)"
    if isinstance(body, Cone):
        x, y, z = _local(body)
        rim = f"((sqrt(({x})^2+({y})^2)-{body.radius!r})^2+({z}+{body.height / 2!r})^2)"
        return f"sqrt(min({rim},({x})^2+({y})^2+({z}-{body.height / 2!r})^2))"
    if isinstance(body, Arc):
        return _arc_edge_distance(body)
    if isinstance(body, Cuboid):
        return _box_edge_distance((x, y, z), body.half_widths)
    past = [f"({c}-{w!r})^2" for c, w in zip((x, y), body.half_widths)]
    outside = [f"{_beyond(c, w)}^2" for c, w in zip((x, y), body.half_widths)]
    return f"sqrt(min({outside[0]}+{past[1]},{past[0]}+{outside[1]})+{z}^2)"


def curvature_radius(body: TextBody) -> str | None:
    """The smaller principal radius of curvature of the surface near a point; None for bodies with plane faces only."""
    if isinstance(body, Sphere | Cylinder | Swept):
        return repr(body.radius)
    if isinstance(body, Ellipsoid):
        return _ellipsoid_curvature_radius(body)
    if isinstance(body, Cone):
        _, _, z = _local(body)
        return f"(max({body.height / 2!r}-({z}),0)*{body.radius / body.height!r})"
    if isinstance(body, Arc):
        x, y, _ = _folded(body)
        return f"max(sqrt({x}^2+{y}^2),{body.inner_radius!r})"
    return None


def curved_distance(body: TextBody) -> str | None:
    """Distance to the curved part of the surface of a body that has plane faces, too; None for other bodies."""
    if isinstance(body, Swept):
        x, y, z = _folded(body)
        return f"abs({_box_edge_distance((x, y, z), body.core)}-{body.radius!r})"
    return None


def minimum(expressions: Sequence[str]) -> str:
    """The smallest of several expressions, nested because MathEval's `min` takes two arguments."""
    if len(expressions) == 1:
        return f"({expressions[0]})"
    half = len(expressions) // 2
    return f"min({minimum(expressions[:half])},{minimum(expressions[half:])})"


def _box_edge_distance(folded: tuple[str, str, str], half_widths: tuple[float, float, float]) -> str:
    """Distance to the edges of a box, by the absolute values of the coordinates."""
    past = [f"({c}-{w!r})^2" for c, w in zip(folded, half_widths)]
    outside = [f"{_beyond(c, w)}^2" for c, w in zip(folded, half_widths)]
    along = ["+".join(outside[k] if k == axis else past[k] for k in range(3)) for axis in range(3)]
    return f"sqrt({minimum(along)})"


def _ellipsoid_norms(ellipsoid: Ellipsoid) -> tuple[str, str]:
    """|(x/a, y/b, z/c)|, which is 1 on the surface, and |(x/a², y/b², z/c²)|; both above 0 at the centre."""
    least = 1e-9
    parts = list(zip(_local(ellipsoid), ellipsoid.semi_axes))
    stretched = "+".join(f"(({c})/{a!r})^2" for c, a in parts)
    gradient = "+".join(f"(({c})/{a * a!r})^2" for c, a in parts)
    small = least / min(ellipsoid.semi_axes)
    return f"sqrt({stretched}+{least**2!r})", f"sqrt({gradient}+{small**2!r})"


def _ellipsoid_curvature_radius(ellipsoid: Ellipsoid) -> str:
    """The smaller principal radius at the point of the surface on the same ray from the centre.

    With the distance h of the tangent plane from the centre, P = (abc)² and S = a² + b² + c², the mean curvature is
    h³(S − |p|²)/2P and the Gaussian one h⁴/P.
    """
    stretched, gradient = _ellipsoid_norms(ellipsoid)
    squares = [a * a for a in ellipsoid.semi_axes]
    product = squares[0] * squares[1] * squares[2]
    radius = "+".join(f"({c})^2" for c in _local(ellipsoid))
    height = f"({stretched}/{gradient})"
    mean = f"({height}^3*({sum(squares)!r}-({radius})/{stretched}^2)/{2 * product!r})"
    return f"(1/({mean}+sqrt(max({mean}^2-{height}^4/{product!r},0))))"


def _polygon_distance(polygon: PlanePolygon) -> str:
    """Distance to a polygon: beside it, in its plane, that to its outline.

    A point is beside it if it is beyond a side of each of its triangles. How far it is beyond the farthest side's line is less than
    the distance, but no less than a share of it: 1e3 times as much decides where the outline's distance counts, and is 0 within.
    """
    x, y, z = _local(polygon)
    steep = 1e3
    beside = []
    for corners in polygon.ears:
        lines = ["0"]
        for (ax, ay), (bx, by) in zip(corners.tolist(), np.roll(corners, -1, axis=0).tolist()):
            length = math.hypot(bx - ax, by - ay)
            u, v = (by - ay) / length, (ax - bx) / length
            lines.append(f"({u!r})*({x})+({v!r})*({y})-({u * ax + v * ay!r})")
        farthest = lines[0]
        for line in lines[1:]:
            farthest = f"max({farthest},{line})"
        beside.append(farthest)
    return f"sqrt(min({steep}*{minimum(beside)},{_outline_distance_in_plane(polygon)})^2+({z})^2)"


def _outline_distance(polygon: PlanePolygon) -> str:
    """Distance to the nearest side of a polygon."""
    return f"sqrt({_outline_distance_in_plane(polygon)}^2+({_local(polygon)[2]})^2)"


def _outline_distance_in_plane(polygon: PlanePolygon) -> str:
    """Distance of a point's projection into the plane to the nearest side of a polygon."""
    x, y, _ = _local(polygon)
    squares = []
    for (ax, ay), (bx, by) in zip(polygon.outline.tolist(), np.roll(polygon.outline, -1, axis=0).tolist()):
        length = math.hypot(bx - ax, by - ay)
        u, v = (bx - ax) / length, (by - ay) / length
        along = f"(({u!r})*({x})+({v!r})*({y})-({u * ax + v * ay!r}))"
        across = f"(({u!r})*({y})-({v!r})*({x})-({u * ay - v * ax!r}))"
        squares.append(f"max(max(-{along},{along}-{length!r}),0)^2+{across}^2")
    return f"sqrt({minimum(squares)})"


def _local(body: Sheet | Cuboid | Ellipsoid | Swept | Cylinder | Cone | Arc) -> list[str]:
    """The three coordinates in the body's frame."""
    return [
        "+".join(f"({axis[k]!r})*({name}-({body.centre[k]!r}))" for k, name in enumerate("xyz"))
        for axis in body.axes.tolist()
    ]


def _folded(body: Rectangle | Disc | Cuboid | Swept | Cylinder | Cone | Arc) -> list[str]:
    """The absolute values of the three coordinates in the body's frame."""
    return [f"abs({coordinate})" for coordinate in _local(body)]


def _beyond(coordinate: str, limit: float) -> str:
    """How far a coordinate exceeds a limit; 0 when it does not."""
    return f"max({coordinate}-{limit!r},0)"


def _radius_from_centre(sphere: Sphere) -> str:
    squares = (f"({name}-({sphere.centre[k]!r}))^2" for k, name in enumerate("xyz"))
    return f"sqrt({'+'.join(squares)})"


def _cone_side_distance(cone: Cone) -> str:
    """Distance to the lateral surface, which is a segment in the half-plane of (distance from the axis, z)."""
    x, y, z = _local(cone)
    across, down = f"sqrt(({x})^2+({y})^2)", f"({cone.height / 2!r}-({z}))"
    length = cone.radius**2 + cone.height**2
    share = f"min(max(({across}*{cone.radius!r}+{down}*{cone.height!r})/{length!r},0),1)"
    return f"sqrt(({across}-{cone.radius!r}*{share})^2+({down}-{cone.height!r}*{share})^2)"


def _cone_base_distance(cone: Cone) -> str:
    """Distance to the disc at the bottom of the cone."""
    x, y, z = _local(cone)
    return f"sqrt({_beyond(f'sqrt(({x})^2+({y})^2)', cone.radius)}^2+({z}+{cone.height / 2!r})^2)"


def _arc_surface_distance(arc: Arc) -> str:
    """Distance to the arc; 0 inside."""
    _, _, z = _folded(arc)
    past_end, along = _arc_coordinates(arc)
    radial = f"max(max({arc.inner_radius!r}-{along},{along}-{arc.outer_radius!r}),0)"
    in_plane = f"max(sqrt(max({past_end},0)^2+{radial}^2),{_behind(arc)})"
    return f"sqrt({in_plane}^2+{_beyond(z, arc.height / 2)}^2)"


def _arc_edge_distance(arc: Arc) -> str:
    """Distance to the nearest edge of an arc: its four circular edges and, unless it is a ring, the edges of its two ends."""
    _, _, z = _folded(arc)
    past_end, along = _arc_coordinates(arc)
    above = f"({z}-{arc.height / 2!r})^2"
    radii = (arc.inner_radius, arc.outer_radius)
    squares = [f"max({past_end},0)^2+({along}-{radius!r})^2+{above}" for radius in radii]
    if not arc.is_ring:
        radial = f"max(max({arc.inner_radius!r}-{along},{along}-{arc.outer_radius!r}),0)"
        squares.append(f"({past_end})^2+{radial}^2+{above}")
        outside = f"{_beyond(z, arc.height / 2)}^2"
        squares += [f"({past_end})^2+({along}-{radius!r})^2+{outside}" for radius in radii]
    return f"sqrt(max({minimum(squares)},{_behind(arc)}^2+{_beyond(z, arc.height / 2)}^2))"


def _arc_coordinates(arc: Arc) -> tuple[str, str]:
    """How far a point is past the plane of the sector's end, and its coordinate along the nearest radius of the sector."""
    x, y, _ = _local(arc)
    if arc.is_ring:
        return "(-1)", f"sqrt(({x})^2+({y})^2)"
    past_end = f"({math.cos(arc.half_angle)!r}*abs({y})-({math.sin(arc.half_angle)!r})*({x}))"
    return past_end, f"sqrt(max(({x})^2+({y})^2-max({past_end},0)^2,0))"


def _behind(arc: Arc) -> str:
    """Lower bound on the distance to a narrow sector from points behind it; 0 for a wide sector.

    It is the distance to the plane, at right angles to the sector's middle radius, beyond which the whole sector lies. Without it
    points behind the axis would get the distance to the sector's mirror image.
    """
    x, _, _ = _local(arc)
    nearest = arc.inner_radius * math.cos(arc.half_angle)
    return f"max({nearest!r}-({x}),0)" if nearest > 0 else "0"
