"""The parameters of the rule by which `sizing` sets the size of the tetrahedra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometries.common.arrays import Array


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


COARSE_RTOL = 2e-2
"""Relative accuracy from which on the first mesh is coarser on round surfaces and at the edges of grounded bodies."""


def sizing_for(rtol: float, refinement: float) -> Sizing:
    """The sizes of a mesh for a relative accuracy; `refinement` divides those at the edges.

    At the growth chosen the cells away from edges leave about a quarter of the accuracy between the bounds: they leave 0.6 to 3.4e-4 at a
    growth of 0.6, and a fourth to a sixth of it at 0.4. With more than 0.6 cells are of bad shapes.
    """
    growth = float(0.6 * min(1.0, rtol / 1e-3) ** 0.25)
    if rtol >= COARSE_RTOL:
        return Sizing(far=0.2, curvature=0.6, growth=growth, refinement=refinement)
    return Sizing(growth=growth, refinement=refinement)
