"""How families turn a target, the box around it then, and whether it lies astride the sensor's border. Metres, degrees."""

from __future__ import annotations

import functools
import math

import numpy as np

from geometries.common.arrays import Array
from geometries.scene.poses import AxisRotation, QuaternionRotation, Rotation
from geometries.scene.shapes import PlateShape


# Cached: a sweep has few plates and angles, and many positions.
@functools.lru_cache(maxsize=1024)
def box(shape: PlateShape, turned: Rotation) -> Array:
    """Returns the bounding box (2, 3) of a rotated plate, lowest and highest coordinates."""
    vertices = shape.triangles().reshape(-1, 3) @ turned.matrix().T
    found = np.array([vertices.min(axis=0), vertices.max(axis=0)])
    found.flags.writeable = False
    return found


def rotation(tilt_degrees: float, turn_degrees: float) -> Rotation:
    """Returns the rotation that tilts about −y, so that the +x end rises, then turns about z."""
    if turn_degrees == 0:
        return AxisRotation((0.0, -1.0, 0.0), tilt_degrees) if tilt_degrees else AxisRotation()
    if tilt_degrees == 0:
        return AxisRotation((0.0, 0.0, 1.0), turn_degrees)
    tilt, turn = math.radians(tilt_degrees) / 2, math.radians(turn_degrees) / 2
    # The product of the quaternions (cos turn, 0, 0, sin turn) and (cos tilt, 0, −sin tilt, 0).
    return QuaternionRotation(
        (
            math.cos(turn) * math.cos(tilt),
            math.sin(turn) * math.sin(tilt),
            -math.cos(turn) * math.sin(tilt),
            math.sin(turn) * math.cos(tilt),
        )
    )


def straddles(outline: Array, half_size: Array) -> bool:
    """Tells whether a convex outline (n, 2) lies partly over the rectangle |x| < half_size and partly outside it.

    They overlap when none of the normals of their sides separates them. A side of the target without length (a plate
    that stands upright) has no normal and separates nothing.
    """
    if (np.abs(outline) <= half_size).all():
        return False
    sides = np.diff(outline[[0, 1, 2]], axis=0)
    normals = [np.array([1.0, 0.0]), np.array([0.0, 1.0]), *(np.array([-side[1], side[0]]) for side in sides)]
    for normal in normals:
        reach = float(np.abs(normal) @ half_size)
        shadow = outline @ normal
        if shadow.min() >= reach > 0 or shadow.max() <= -reach < 0:
            return False
    return True
