"""The size fields of scenes with polyhedra, whose distances gmsh samples: see `sizing` for the rule, `field_nodes` for how."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from fem_reference import field_nodes
from fem_reference.bodies import Body
from fem_reference.distance_text import edge_distance, surface_distance
from fem_reference.distances import distance
from fem_reference.polyhedron import Polyhedron
from fem_reference.size_rules import Sizing

SPACING_IN_GAP = 0.5
"""Distance of the points that stand for a face over the width of the narrowest gap to the body."""


def polyhedra_fields(
    bodies: Sequence[Body],
    gaps: Sequence[tuple[int, int]],
    sizing: Sizing,
    volumes: Mapping[int, Sequence[int]],
    dielectrics: Collection[int],
) -> list[int]:
    """Fields of the sizes that polyhedra ask for, and the `gaps` between bodies of which at least one is a polyhedron."""
    sampled: dict[int, int] = {}
    for k, body in enumerate(bodies):
        if isinstance(body, Polyhedron):
            near = [distance(bodies[i], bodies[j]) for i, j in gaps if k in (i, j)]
            spacing = min([sizing.edge * body.size, *(SPACING_IN_GAP * gap for gap in near)])
            sampled[k] = field_nodes.surface_distance(volumes[k], spacing)
    fields = [field_nodes.largest([_surface(bodies, sampled, k, sizing.gap) for k in pair]) for pair in gaps]
    for k, body in enumerate(bodies):
        fields += _at_edges(bodies, sampled, k, [i + j - k for i, j in gaps if k in (i, j)], sizing, volumes)
        if isinstance(body, Polyhedron):
            facet = _facet_size(body) / sizing.refinement**0.5
            fields.append(field_nodes.line(sampled[k], facet, sizing.growth))
        if isinstance(body, Polyhedron) and k in dielectrics:
            fields.append(field_nodes.line(sampled[k], sizing.gap * body.size, 2 * sizing.gap))
    return fields


def _surface(bodies: Sequence[Body], sampled: Mapping[int, int], k: int, factor: float) -> int:
    """A field: the distance to body k times a factor."""
    body = bodies[k]
    if isinstance(body, Polyhedron):
        return field_nodes.line(sampled[k], 0.0, factor)
    return field_nodes.expression(f"{factor}*{surface_distance(body)}")


def _at_edges(
    bodies: Sequence[Body],
    sampled: Mapping[int, int],
    k: int,
    across: Sequence[int],
    sizing: Sizing,
    volumes: Mapping[int, Sequence[int]],
) -> list[int]:
    """Fields of the sizes at the edges of body k, reduced in the gaps to the bodies `across`."""
    body = bodies[k]
    fields = []
    if isinstance(body, Polyhedron):
        edges = field_nodes.edge_distance(body, volumes[k])
        if edges is None:
            return []
        fields.append(field_nodes.line(edges, sizing.edge * body.size / sizing.refinement, sizing.growth))
        growing = field_nodes.line(edges, 0.0, sizing.growth)
    else:
        edge = edge_distance(body)
        if edge is None or not across:
            return []
        growing = field_nodes.expression(f"{sizing.growth}*{edge}")
    in_gaps = [_surface(bodies, sampled, j, sizing.edge_in_gap / sizing.refinement) for j in across]
    return fields + [field_nodes.largest([growing, in_gap]) for in_gap in in_gaps]


def _facet_size(body: Polyhedron) -> float:
    """The median length of a triangle's sides: on a faceted round surface the mesh grows from there."""
    corners = body.vertices[body.triangles]
    return float(np.median(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)))
