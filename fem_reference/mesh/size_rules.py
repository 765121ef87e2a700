"""The numbers of the rule by which `sizing` makes the tetrahedra small or large."""

from __future__ import annotations

from dataclasses import dataclass


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
    gap_between_faces: float = 5.0
    """The same between two bodies with plane faces only: the field that straight faces have between them is nearly linear
    across, however wide the cells are, and where it is not an edge is near, from which the size grows."""
    curvature: float = 0.3
    """Size on a curved surface over its radius of curvature, on the coarsest level."""
    growth: float = 0.4
    """Growth of the size per distance from the edges."""
    refinement: float = 1.0
    """Divides the sizes at the edges: 1, 2, 4, … on successive levels, at a fixed growth. Those on curved surfaces, where
    nothing is singular, are divided by its root."""


def growth_for(rtol: float) -> float:
    """The growth whose own error (`convergence.shared_error`) leaves room for a relative accuracy."""
    return 0.4 if rtol >= 2e-4 else 0.25
