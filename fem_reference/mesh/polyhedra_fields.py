"""Distances from polyhedra, which gmsh samples: names of the fields, for use in the expressions of `sizing`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem_reference.mesh import gmsh_fields
from fem_reference.bodies.shapes import Body
from fem_reference.bodies.distances import distance
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.mesh.size_rules import Sizing

SPACING_IN_GAP = 0.5
"""Spacing of the sample points on a face over the width of the narrowest gap to the body."""


def sampled_surfaces(
    bodies: Sequence[Body],
    gaps: Sequence[tuple[int, int]],
    sizing: Sizing,
    volumes: Mapping[int, Sequence[int]],
) -> dict[int, str]:
    """Sample the distance to the surface of each polyhedron among the bodies, as finely as its gaps require."""
    sampled = {}
    for k, body in enumerate(bodies):
        if isinstance(body, Polyhedron):
            near = [distance(bodies[i], bodies[j]) for i, j in gaps if k in (i, j)]
            spacing = min([sizing.edge * body.size, *(SPACING_IN_GAP * gap for gap in near)])
            sampled[k] = gmsh_fields.name(gmsh_fields.surface_distance(volumes[k], spacing))
    return sampled


def sampled_edges(body: Polyhedron, volumes: Sequence[int]) -> str | None:
    """Sample the distance to the sharp edges of a polyhedron; None when it has none."""
    field = gmsh_fields.edge_distance(body, volumes)
    return None if field is None else gmsh_fields.name(field)


def facet_size(body: Polyhedron) -> float | None:
    """The median length of the sides of the triangles on rounded surfaces, from which the mesh size grows; None without such.

    The triangles of plane faces do not count: how a plane face is cut into triangles is arbitrary.
    """
    corners = body.vertices[body.triangles[body.rounded]]
    if not len(corners):
        return None
    return float(np.median(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)))
