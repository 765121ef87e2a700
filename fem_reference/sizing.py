"""The size of the tetrahedra: small at the conductors' edges and in the gaps between them, growing with the distance.

The charge density of a conductor is singular at its edges and varies over the width of a gap, and is smooth elsewhere, so

    h(x) = min( edge_i + growth · distance to the edges of body i,  distance to body i + distance to body j )

over all bodies i and all pairs i, j. `edge_i` is a fraction of the body's size, or of the local gap where that is
smaller. The sum of two distances is the local width of a gap, wherever the gap is: two plates that meet at an angle are
resolved where they are close, and nowhere else. All distances are closed forms, evaluated by gmsh's MathEval.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import gmsh

from fem_reference.bodies import Body, Cuboid, Disc


@dataclass(frozen=True)
class Sizing:
    """How fine the mesh is. Lengths are relative; `fem_reference/NUMERICS.md` section 2 has the measurements."""

    edge: float = 0.1
    """Size at a body's edges over the body's size, on the coarsest level."""
    edge_in_gap: float = 0.3
    """Size at an edge over the width of the gap there, on the coarsest level: from 0.4 on the first level may lie outside
    the convergent range."""
    gap: float = 1.0
    """Size in a gap over its width. Cubic elements resolve the smooth field in a gap with one."""
    growth: float = 0.4
    """Growth of the size per distance from the edges."""
    refinement: float = 1.0
    """Divides the sizes at the edges: 1, 2, 4, … on successive levels, at a fixed growth."""


def set_size_field(bodies: Sequence[Body], owner: Sequence[int], sizing: Sizing) -> None:
    """Make the size field of these bodies the background mesh of the current gmsh model.

    Bodies of one conductor (equal `owner`) have no gap between them.
    """
    surface = [_surface_distance(body) for body in bodies]
    sizes = []
    for i, body in enumerate(bodies):
        gaps = [f"({surface[i]}+{surface[j]})" for j in range(len(bodies)) if owner[j] != owner[i]]
        edge = [repr(sizing.edge * body.size), *(f"{sizing.edge_in_gap}*{gap}" for gap in gaps)]
        sizes.append(f"{_minimum(edge)}/{sizing.refinement}+{sizing.growth}*{_edge_distance(body)}")
    for i, j in combinations(range(len(bodies)), 2):
        if owner[i] != owner[j]:
            sizes.append(f"{sizing.gap}*({surface[i]}+{surface[j]})")
    fields = gmsh.model.mesh.field
    smallest = fields.add("Min")
    fields.setNumbers(smallest, "FieldsList", [_add(size) for size in sizes])
    fields.setAsBackgroundMesh(smallest)


def _add(expression: str) -> int:
    field: int = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(field, "F", expression)
    return field


def _minimum(expressions: Sequence[str]) -> str:
    """The smallest of several expressions; MathEval's own `min` takes two."""
    if len(expressions) == 1:
        return f"({expressions[0]})"
    half = len(expressions) // 2
    return f"min({_minimum(expressions[:half])},{_minimum(expressions[half:])})"


def _folded(body: Body) -> list[str]:
    """Absolute coordinates in the body's frame, as text."""
    return [
        "abs("
        + "+".join(f"({axis[k]!r})*({name}-({body.centre[k]!r}))" for k, name in enumerate("xyz"))
        + ")"
        for axis in body.axes.tolist()
    ]


def _surface_distance(body: Body) -> str:
    """Distance to the body itself (0 inside a solid), as text."""
    x, y, z = _folded(body)
    if isinstance(body, Disc):
        return f"sqrt(max(sqrt({x}^2+{y}^2)-{body.radius!r},0)^2+{z}^2)"
    widths = [*body.half_widths, 0.0][:3]
    return "sqrt(" + "+".join(f"max({c}-{w!r},0)^2" for c, w in zip((x, y, z), widths)) + ")"


def _edge_distance(body: Body) -> str:
    """Distance to the nearest edge of the body, as text."""
    x, y, z = _folded(body)
    if isinstance(body, Disc):
        return f"sqrt((sqrt({x}^2+{y}^2)-{body.radius!r})^2+{z}^2)"
    beyond = [f"({c}-{w!r})^2" for c, w in zip((x, y, z), body.half_widths)]
    outside = [f"max({c}-{w!r},0)^2" for c, w in zip((x, y, z), body.half_widths)]
    if isinstance(body, Cuboid):
        along = ["+".join(outside[k] if k == axis else beyond[k] for k in range(3)) for axis in range(3)]
        return f"sqrt({_minimum(along)})"
    return f"sqrt(min({outside[0]}+{beyond[1]},{beyond[0]}+{outside[1]})+{z}^2)"
