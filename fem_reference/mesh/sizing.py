"""The size of the tetrahedra: small at the conductors' edges and in the gaps between them, and growing with the distance.

The charge density of a conductor is singular at its edges, varies over distances like the width of a gap, and is smooth elsewhere.
Hence the size at a point x is

    h(x) = min( edge_i + growth · distance to the edges of body i,  c·(distance to body i + distance to body j) )

over all bodies i and all pairs i, j. `edge_i` is a fraction of the body's size, or of the local gap where that is smaller; for a body of a
conductor that is always grounded it is at least a fraction of the distance from those that are driven. The sum of the distances to two
bodies is the local width of the gap between them: two plates at an angle are resolved where they are close. Between plane faces c is
larger than 1, since the potential there is nearly linear except near edges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from fem_reference.bodies.conductors import Conductors
from fem_reference.bodies.distances import distance, in_contact
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid
from fem_reference.bodies.shapes import SHEETS, Body, Cuboid, Rectangle
from fem_reference.mesh.body_distances import (
    ClosedFormBody,
    curvature_radius,
    curved_distance,
    edge_distance,
    focal_curve,
    surface_distance,
    wall_distance,
)
from fem_reference.mesh.tape import Expression, Quantity, SizeFunction, Tape, smallest
from geometries.common.arrays import Array

SIDES_ALONG_RIM = 800
"""Number of cells along the rim of an ellipsoid on the coarsest level, from which on they may be larger than the radius of curvature there."""
OF_LENGTH = 0.2
"""Size at the edges of a thin wall over that at a sheet's edges, for a sheet as broad as the wall is long."""
AT_APEX = 0.1
"""Size of the cells at the apex of a cone over the size at its edge. It has to end the refinement by curvature, since the radius of
curvature falls to 0 towards the apex."""


@dataclass(frozen=True)
class AdaptedSizes:
    """Sizes that the errors of a mesh before ask for (`marks`)."""

    triangles: Array
    """(n, 3, 3): sides along edges and points, as triangles with equal corners."""
    sizes: Array
    """(n,): the sizes there, from which the size grows."""
    growth_of_cells: float
    """Predicted ratio of the number of cells to that of the mesh before."""


@dataclass(frozen=True)
class Sizing:
    """Relative sizes that determine how fine the mesh is; `fem_reference/NUMERICS.md` section 2 has the measurements."""

    edge: float = 0.1
    """Size at a body's edges over the body's size, on the coarsest level."""
    thin: float = 1.0
    """Largest size at the edges of a thin wall over its thickness, on the coarsest level."""
    edge_in_gap: float = 0.3
    """Size at an edge over the width of the gap there, on the coarsest level. With 0.4 or more the first level may lie outside the
    range in which the errors fall as in theory."""
    edge_in_layer: float = 0.6
    """Size at an edge of a dielectric body, or of what touches it, over the dielectric body's size, on the coarsest level."""
    gap: float = 1.0
    """Size in a gap over its width. One cubic element resolves the smooth field across a gap."""
    gap_between_faces: float = 5.0
    """The same between two bodies with plane faces only. There the potential is nearly linear across the gap, which cells of any width
    represent; where it is not, an edge is near, from which the size grows."""
    far: float = 0.1
    """Least size at the edges of bodies that are always grounded, over the distance from those that are driven, on the coarsest level.
    What such edges leave wrong of a charge elsewhere falls with a higher power of the distance."""
    curvature: float = 0.3
    """Size on a curved surface over its radius of curvature, on the coarsest level."""
    growth: float = 0.4
    """Growth of the size per distance from the edges."""
    refinement: float = 1.0
    """Divisor of the sizes at the edges: 1, 2, 4, … on successive levels, at a fixed growth. The sizes on curved surfaces, where nothing
    is singular, are divided by its square root."""
    adapted: AdaptedSizes | None = None
    """Sizes that take the place of those at edges."""


COARSE_EDGES_RTOL, COARSE_RTOL = 5e-3, 2e-2
"""Relative accuracies from which on the first mesh is coarser: at edges; and on round surfaces and at the edges of grounded bodies."""


def sizing_for(rtol: float, refinement: float) -> Sizing:
    """The sizes of a mesh for a relative accuracy; `refinement` divides those at the edges.

    At the growth chosen the cells away from edges leave about a quarter of the accuracy between the bounds: they leave 0.6 to 3.4e-4 at a
    growth of 0.6, and a fourth to a sixth of it at 0.4. With more than 0.6 cells are of bad shapes.
    """
    growth = float(0.6 * min(1.0, rtol / 1e-3) ** 0.25)
    if rtol < COARSE_EDGES_RTOL:
        return Sizing(growth=growth, refinement=refinement)
    far, curved = (0.2, 0.6) if rtol >= COARSE_RTOL else (Sizing.far, Sizing.curvature)
    return Sizing(edge=0.2, thin=4.0, far=far, curvature=curved, growth=growth, refinement=refinement)


def size_at_edges(body: Body, sizing: Sizing) -> float:
    """The size at the edges of a conductor's body, before gaps and refinement: along thin walls that of a sheet, up to some thicknesses."""
    length = body.size
    if isinstance(body, (Cuboid, Cylinder, Cone, Arc)):
        length = float(np.linalg.norm(body.corners[[1, 2, 4]] - body.corners[0], axis=1).max())
    return max(sizing.edge * body.size, min(sizing.thin * body.size, OF_LENGTH * sizing.edge * length))


def size_function(problem: Conductors, sizing: Sizing) -> SizeFunction:
    """The size of the tetrahedra around and in these bodies.

    The size is not reduced in gaps between bodies of one conductor, nor between a dielectric body and a body it touches, where the field
    varies over the thickness of the dielectric. Nor is it between bodies that are at 0 V in every solution, so that there is no field
    between them.
    """
    bodies, room = problem.bodies, problem.room
    dielectrics, grounded = problem.permittivities, problem.grounded_bodies
    tape = Tape()
    potential = [None if k in grounded else number for k, number in enumerate(problem.owner)]
    pairs = [(i, j) for i, j in combinations(range(len(bodies)), 2) if potential[i] != potential[j]]
    driven = [k for k in range(len(bodies)) if k not in grounded and k not in dielectrics]
    contacts = [(i, j) for i, j in pairs if in_contact(bodies[i], bodies[j])]
    gaps = [pair for pair in pairs if pair not in contacts]
    known = [distance_on_tape(body, tape) for body in bodies]
    widths = {(i, j): distance(bodies[i], bodies[j]) for i, j in gaps}
    # Where a gap is wide, the growth from edges sets smaller sizes everywhere. Without such gaps the size is the same, and found sooner.
    sizes: list[Quantity] = [
        _in_gap(bodies[i], bodies[j], sizing) * (known[i] + known[j])
        for i, j in gaps
        if not any(
            _is_wide(bodies[k], widths[i, j], _in_gap(bodies[i], bodies[j], sizing), sizing)
            for k in (i, j)
            if k not in grounded
        )
    ]
    for i, body in enumerate(bodies):
        across = [
            known[i] + known[k + j - i]
            for k, j in gaps
            if i in (k, j) and sizing.edge_in_gap * widths[k, j] < size_at_edges(body, sizing)
        ]
        if room is not None and i not in grounded:
            across.append(known[i] + wall_distance(room, tape.point))
            sizes.append(_in_gap(body, room, sizing) * across[-1])
        own = sizing.edge_in_layer * body.size if i in dielectrics else size_at_edges(body, sizing)
        edge: list[Quantity] = [own, *(sizing.edge_in_gap * gap for gap in across)]
        for j in (k + j - i for k, j in contacts if i in (k, j)):
            part = sizing.edge_in_layer if {i, j} & {*dielectrics} else sizing.edge
            edge.append(part * bodies[j].size + sizing.edge_in_gap * known[j])
        least = 0.0
        if i in grounded and driven:
            least = sizing.far * smallest([known[k] for k in driven])
        at_edges = np.maximum(smallest(edge), least) / sizing.refinement
        if isinstance(body, Polyhedron):
            sizes += _sizes_of_polyhedron(body, at_edges, least, known[i], sizing)
        else:
            sizes += _sizes_of_body(body, at_edges, known[i], sizing, tape)
        if i in dielectrics:
            across_it = sizing.gap_between_faces if _is_plane_faced(body) else sizing.gap
            sizes.append(across_it * (body.size + 2 * known[i]))
    adapted = sizing.adapted
    if adapted is not None:
        sizes.append(sizing.growth * tape.distance(adapted.triangles, adapted.sizes / sizing.growth))
    return SizeFunction(smallest(sizes))


def distance_on_tape(body: Body, tape: Tape) -> Expression:
    """Distance to the body; inside of triangles, to its surface."""
    if isinstance(body, Polyhedron):
        return tape.distance(body.vertices[body.triangles])
    found: Expression = surface_distance(body, tape.point)
    return found


def _facet_size(body: Polyhedron) -> float | None:
    """The median length of the sides of the triangles on rounded surfaces, from which the mesh size grows; None without such.

    The triangles of plane faces do not count: how a plane face is cut into triangles is arbitrary.
    """
    corners = body.vertices[body.triangles[body.rounded]]
    if not len(corners):
        return None
    return float(np.median(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)))


def _is_wide(body: Body, width: float, in_gap: float, sizing: Sizing) -> bool:
    """Whether growth from the edges of a driven body sets a smaller size than a gap of this width, in which the body is, everywhere.

    In the gap the size is c·(d + d'), with c = `in_gap`, d the distance to the body and d + d' at least the width. Points of its surface are
    at most r away from its edges, from which the size grows, so that this size is at most edge + growth·(d + r). It is the smaller one if
    (c − growth)·width is at least edge + growth·r.
    """
    if isinstance(body, Rectangle):
        farthest = min(body.half_widths)
    elif isinstance(body, Cuboid):
        farthest = sorted(body.half_widths)[1]
    else:
        return False
    at_edges = size_at_edges(body, sizing) / sizing.refinement
    return (in_gap - sizing.growth) * width >= at_edges + sizing.growth * farthest


def _is_plane_faced(body: Body) -> bool:
    """Whether all faces of a body are plane.

    Where faces of two such bodies are close and not parallel, an edge is so near that growth from it resolves the gap.
    """
    if isinstance(body, Polyhedron):
        return not body.rounded.any()
    return isinstance(body, (*SHEETS, Cuboid))


def _in_gap(first: Body, second: Body, sizing: Sizing) -> float:
    """Size of the cells in the gap between two bodies over the width of the gap."""
    plane = _is_plane_faced(first) and _is_plane_faced(second)
    return sizing.gap_between_faces if plane else sizing.gap


def _sizes_of_body(
    body: ClosedFormBody, at_edges: Quantity, surface: Expression, sizing: Sizing, tape: Tape
) -> list[Quantity]:
    """The sizes that the edges of a body and the curvature of its surface require; at the apex of a cone AT_APEX limits the latter."""
    edges, radius = edge_distance(body, tape.point), curvature_radius(body, tape.point)
    sizes = [] if edges is None or sizing.adapted is not None else [at_edges + sizing.growth * edges]
    if radius is not None:
        least = AT_APEX * at_edges if isinstance(body, Cone) else 0.0
        curved = sizing.curvature / sizing.refinement**0.5 * radius
        if isinstance(body, Ellipsoid):
            curved = _on_ellipsoid(body, curved, sizing, tape)
        if isinstance(body, Arc):
            # Chords of one wall come a quarter of the way to the other at most, so that the meshes of both do not cross.
            curved = np.minimum(
                curved, math.sqrt(2 * body.outer_radius * (body.outer_radius - body.inner_radius))
            )
        away = curved_distance(body, tape.point)
        sizes.append(least + curved + sizing.growth * (surface if away is None else away))
    return sizes


def _on_ellipsoid(body: Ellipsoid, curved: Quantity, sizing: Sizing, tape: Tape) -> Quantity:
    """The size on an ellipsoid, of which `curved` is what the radius of curvature requires.

    That radius may grow faster along the surface than sizes of cells can; the distance to the focal curve does not. Along a sharp rim the cells
    may be larger than the radius, so that their number is bounded.
    """
    focal = focal_curve(body)
    length = float(np.linalg.norm(focal[:, 1] - focal[:, 0], axis=1).sum())
    least = min(length / SIDES_ALONG_RIM, sizing.curvature * min(body.semi_axes)) / sizing.refinement
    curve = sizing.curvature / sizing.refinement**0.5 * tape.distance(focal[:, [0, 1, 1]])
    return np.maximum(np.minimum(curved, curve), least)


def _sizes_of_polyhedron(
    body: Polyhedron, at_edges: Quantity, least: Quantity, surface: Expression, sizing: Sizing
) -> list[Quantity]:
    """The sizes that the sharp edges and the rounded surfaces of a polyhedron require.

    The latter start from the size of facets, or from the `least` size where that is larger.
    """
    edges, facet = body.vertices[body.edges], _facet_size(body)
    sizes = []
    if len(edges) and sizing.adapted is None:
        # A triangle with two equal corners is a segment.
        sizes.append(at_edges + sizing.growth * surface.tape.distance(edges[:, [0, 1, 1]]))
    if facet is not None:
        sizes.append(np.maximum(facet, least) / sizing.refinement**0.5 + sizing.growth * surface)
    return sizes
