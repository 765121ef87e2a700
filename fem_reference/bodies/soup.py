"""Triangles that bound no solid as they are: they have to be wrapped before they can be meshed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fem_reference.bodies.shapes import Body
from fem_reference.bodies.triangle_distances import winding_number
from geometries.common.arrays import Array, Flags


@dataclass(frozen=True)
class Soup:
    """The triangles (m, 3, 3) of a body, in metres, and what keeps them from bounding a solid."""

    name: str
    triangles: Array
    defect: str
    """Words that follow the name of the file."""
    is_solid: ClassVar[bool] = False

    @property
    def corners(self) -> Array:
        return np.asarray(self.triangles.reshape(-1, 3))

    @property
    def size(self) -> float:
        """The middle one of the widths of the bounding box, so that a sheet has a size as well."""
        return float(np.median(np.ptp(self.corners, axis=0)))

    def holds(self, points: Array) -> Flags:
        """Whether each of the points (n, 3) is inside: the triangles, whatever their orientation as a whole, wind around it."""
        return np.asarray(np.abs(winding_number(self.triangles, points)) > 0.5)


Surface = Body | Soup
"""What a body is before it is known whether it has to be wrapped."""
