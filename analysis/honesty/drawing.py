"""Draws sizes, sensors and bodies by chance. Metres, degrees; the sensor lies in the plane z = 0 and looks along +z."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from geometries.scene.poses import AxisRotation, Pose, Vector3
from geometries.scene.scene import Object, Plate, Sensor
from geometries.scene.shapes import (
    Arc,
    Capsule,
    Cone,
    Cuboid,
    Cylinder,
    Disc,
    Ellipsoid,
    PlateShape,
    RoundedCuboid,
    Shape,
    Sphere,
)

Chance = random.Random
"""Python promises that its numbers stay the same in all versions."""

_DIGITS = 4
_SEGMENTS = (24, 48)
_UPRIGHT = AxisRotation()


def logarithmic(chance: Chance, low: float, high: float) -> float:
    """Draws a number uniformly in its logarithm, so that small and large ones are equally frequent; four digits."""
    return float(f"{math.exp(chance.uniform(math.log(low), math.log(high))):.{_DIGITS}g}")


def uniform(chance: Chance, low: float, high: float) -> float:
    """Draws a number uniformly; four digits."""
    return float(f"{chance.uniform(low, high):.{_DIGITS}g}")


def turn(chance: Chance) -> AxisRotation:
    """Draws a rotation by up to half a turn about any axis."""
    x, y, z = (chance.gauss(0, 1) for _ in range(3))
    return AxisRotation(
        (round(x, _DIGITS), round(y, _DIGITS), round(z, _DIGITS) or 1.0), uniform(chance, 0, 180)
    )


def sensor(chance: Chance, name: str = "front", x: float = 0.0) -> Sensor:
    """Draws a sensor of one rectangle of 2 to 15 cm, centred at (x, 0, 0)."""
    width, height = (logarithmic(chance, 0.02, 0.15) for _ in range(2))
    corner = (x - width / 2, -height / 2, 0.0)
    return Sensor(name, (Plate(corner, (width, 0.0, 0.0), (0.0, height, 0.0)),))


def angular(chance: Chance) -> Shape:
    """Draws a plate or a box with sides of 2 to 30 cm."""
    x, y, z = (logarithmic(chance, 0.02, 0.3) for _ in range(3))
    return PlateShape((x, y)) if chance.random() < 0.3 else Cuboid((x, y, z))


def round_body(chance: Chance, low: float = 0.02, high: float = 0.3, is_solid: bool = False) -> Shape:
    """Draws a body with a curved surface, whose sizes are in this range; a sheet only if it need not be solid."""
    a, b, c = (logarithmic(chance, low, high) for _ in range(3))
    segments = chance.choice(_SEGMENTS)
    shapes: list[Shape] = [
        Sphere(a / 2, segments),
        Cylinder(a / 2, b, segments),
        Capsule(a / 4, b, segments),
        Ellipsoid((a / 2, b / 2, c / 2), segments),
        Cone(a / 2, b, segments),
        Arc(a / 4, a / 2, b / 4, chance.choice((120.0, 360.0)), segments),
        RoundedCuboid((a, b, c), min(a, b, c) / 4, segments),
    ]
    if not is_solid:
        shapes.append(Disc(a / 2, segments))
    return chance.choice(shapes)


def before(
    name: str,
    shape: Shape,
    gap: float,
    aside: tuple[float, float] = (0.0, 0.0),
    rotation: AxisRotation = _UPRIGHT,
    **more: Any,
) -> Object:
    """Returns a body whose lowest corner is at z = `gap`, centred at `aside`; `more` are fields of Object."""
    low = float((shape.triangles().reshape(-1, 3) @ rotation.matrix().T)[:, 2].min())
    place: Vector3 = (*aside, round(gap - low, 6))
    return Object(name, shape, pose=Pose(place, rotation), **more)


def aside(chance: Chance, reach: float = 0.05) -> tuple[float, float]:
    """Draws how far a body is beside the sensor's middle along x and y."""
    return uniform(chance, -reach, reach), uniform(chance, -reach, reach)


def radius_of(shape: Shape) -> float:
    """Returns the radius of the smallest ball about the origin of the shape's frame that contains its triangles."""
    return float(np.linalg.norm(shape.triangles().reshape(-1, 3), axis=1).max())
