"""From a scene to the bodies of the field problem: which conductor is made of what, and whether it can be solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from fem_reference.bodies import Body, Cuboid, Disc, Rectangle, separation
from fem_reference.mesh import bounding_sphere
from geometries.errors import InputError
from geometries.scene import Object, Scene
from geometries.shapes import Cuboid as CuboidShape
from geometries.shapes import PlateShape

Array = NDArray[np.float64]

SMALLEST_GAP = 1e-3
"""Smallest gap over the smaller of two bodies' sizes. The mesh resolves every gap, and its size grows like the square of
size over gap: below this a case would not fit the machine."""


@dataclass(frozen=True)
class Conductors:
    """The conductors of a scene, sensors first; `bodies[k]` is a part of conductor `owner[k]`. Lengths over `unit`."""

    names: tuple[str, ...]
    sensors: int
    bodies: tuple[Body, ...]
    owner: tuple[int, ...]
    centre: Array
    unit: float

    def bodies_of(self, conductor: int) -> list[int]:
        return [k for k, owner in enumerate(self.owner) if owner == conductor]


def conductors(scene: Scene, source: str = "scene") -> Conductors:
    """The conductors of a scene, moved to the origin and scaled by the radius of their bounding sphere.

    So the mesh, and every number but the unit, is the same for a scene of twice the size or elsewhere. Raises InputError
    for what cannot be solved: no conductor, a shape or material the solver does not know, conductors that touch.
    """
    names: list[str] = []
    bodies: list[Body] = []
    owner: list[int] = []
    for sensor in scene.sensors:
        for corner, edge_u, edge_v in scene.sensor_rectangles(sensor.name):
            owner.append(len(names))
            bodies.append(rectangle(sensor.name, corner, edge_u, edge_v))
        names.append(sensor.name)
    for body in scene.objects:
        owner.append(len(names))
        bodies.append(_object_body(scene, body, source))
        names.append(body.name)
    if not scene.sensors:
        raise InputError(source, "sensor", "nothing to solve: the scene has no capacitive sensor")
    for first, second in combinations(range(len(bodies)), 2):
        if owner[first] != owner[second]:
            _refuse_contact(bodies[first], bodies[second], source)
    return normalised(names, len(scene.sensors), bodies, owner)


def normalised(
    names: Sequence[str], sensors: int, bodies: Sequence[Body], owner: Sequence[int]
) -> Conductors:
    """Conductors from bodies in metres: `bodies[k]` is a part of conductor `owner[k]`, the first `sensors` are sensors."""
    centre, unit = bounding_sphere(bodies)
    moved = tuple(_moved(body, centre, unit) for body in bodies)
    return Conductors(tuple(names), sensors, moved, tuple(owner), centre, unit)


def rectangle(name: str, corner: Array, edge_u: Array, edge_v: Array) -> Rectangle:
    """The rectangle corner + a·edge_u + b·edge_v, a and b in [0, 1]; edges at right angles, metres."""
    widths = float(np.linalg.norm(edge_u)), float(np.linalg.norm(edge_v))
    first, second = edge_u / widths[0], edge_v / widths[1]
    axes = np.array([first, second, np.cross(first, second)])
    return Rectangle(name, corner + (edge_u + edge_v) / 2, axes, (widths[0] / 2, widths[1] / 2))


def _object_body(scene: Scene, body: Object, source: str) -> Body:
    key = f'object "{body.name}"'
    if body.relative_permittivity is not None:
        raise InputError(source, f"{key}: material", "the field reference solves for conductors only")
    if body.potential != "grounded":
        raise InputError(source, f"{key}: potential", "the field reference solves for grounded objects only")
    rotation, translation = scene.pose_of_object(body.name)
    shape = body.shape
    if isinstance(shape, PlateShape):
        x, y = shape.size
        return Rectangle(body.name, translation, rotation.T, (x / 2, y / 2))
    if isinstance(shape, CuboidShape):
        x, y, z = shape.size
        return Cuboid(body.name, translation, rotation.T, (x / 2, y / 2, z / 2))
    raise InputError(source, f"{key}: shape.type", "the field reference knows plates and cuboids only")


def _refuse_contact(first: Body, second: Body, source: str) -> None:
    assert not isinstance(first, Disc) and not isinstance(second, Disc), "scenes have no discs"
    gap = separation(first, second)
    size = min(first.size, second.size)
    key = f'"{first.name}" and "{second.name}"'
    if gap <= 1e-9 * size:
        raise InputError(
            source, key, "the conductors touch or cross: their capacitance is infinite or meaningless"
        )
    if gap < SMALLEST_GAP * size:
        raise InputError(
            source,
            key,
            f"the gap of {gap:.3g} m is below {SMALLEST_GAP:g} of the smaller size, too narrow to mesh",
        )


def _moved(body: Body, centre: Array, unit: float) -> Body:
    origin = (body.centre - centre) / unit
    if isinstance(body, Disc):
        return replace(body, centre=origin, radius=body.radius / unit)
    return replace(body, centre=origin, half_widths=tuple(width / unit for width in body.half_widths))
