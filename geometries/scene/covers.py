"""Covers of sensors: a layer of a dielectric on the front of each plate, written as a key of the sensor and read as dielectric bodies."""

from __future__ import annotations

import math

import numpy as np

from geometries.common.arrays import Array
from geometries.common.tables import Table
from geometries.scene.poses import Pose, QuaternionRotation
from geometries.scene.scene import Object, Plate, Scene, Sensor
from geometries.scene.shapes import Cuboid


def read_cover(table: Table, sensor: Sensor) -> tuple[Object, ...]:
    """Returns the bodies of a sensor's key `cover`, one for each plate, in the plates' order; none without the key."""
    if not table.has("cover"):
        return ()
    cover = table.table("cover")
    thickness = cover.positive_length("thickness")
    permittivity = cover.positive("relative_permittivity")
    if permittivity < 1:
        raise cover.error("relative_permittivity", "a cover's must be at least 1")
    cover.finish()
    return covers(sensor, thickness, permittivity)


def covers(sensor: Sensor, thickness: float, permittivity: float) -> tuple[Object, ...]:
    """Returns the bodies of a cover (m, relative permittivity at least 1) on a sensor, one for each plate, in the plates' order."""
    return tuple(
        _layer(sensor, plate, _name(sensor, index), thickness, permittivity)
        for index, plate in enumerate(sensor.plates)
    )


def is_cover(body: Object) -> bool:
    """Tells whether a body is the cover of a sensor's plate: a dielectric body of the sensor's conductor. It is never a target."""
    return body.relative_permittivity is not None and body.conductor is not None


def cover_of(scene: Scene, sensor: Sensor) -> tuple[float, float] | None:
    """Returns the thickness (m) and relative permittivity of the cover of a sensor's plates; None without."""
    for body in scene.objects:
        if is_cover(body) and body.conductor == sensor.name and isinstance(body.shape, Cuboid):
            assert body.relative_permittivity is not None
            return body.shape.size[2], body.relative_permittivity
    return None


def _name(sensor: Sensor, index: int) -> str:
    return f"{sensor.name} cover" if index == 0 else f"{sensor.name} cover {index + 1}"


def _layer(sensor: Sensor, plate: Plate, name: str, thickness: float, permittivity: float) -> Object:
    edge_u, edge_v = np.asarray(plate.edge_u), np.asarray(plate.edge_v)
    length_u, length_v = float(np.linalg.norm(edge_u)), float(np.linalg.norm(edge_v))
    u, v = edge_u / length_u, edge_v / length_v
    normal = np.cross(u, v)
    x, y, z = np.asarray(plate.corner) + (edge_u + edge_v) / 2 + thickness / 2 * normal
    return Object(
        name=name,
        shape=Cuboid((length_u, length_v, thickness)),
        link=sensor.link,
        pose=Pose((float(x), float(y), float(z)), _rotation(np.column_stack([u, v, normal]))),
        relative_permittivity=permittivity,
        collides=False,
        conductor=sensor.name,
    )


def _rotation(matrix: Array) -> QuaternionRotation:
    """Returns a rotation matrix as a quaternion, by its largest component."""
    r = matrix
    squares = 1 + np.array(
        [
            r[0, 0] + r[1, 1] + r[2, 2],
            r[0, 0] - r[1, 1] - r[2, 2],
            r[1, 1] - r[0, 0] - r[2, 2],
            r[2, 2] - r[0, 0] - r[1, 1],
        ]
    )
    largest = int(squares.argmax())
    root = 2 * math.sqrt(float(squares[largest]))
    rows = (
        (root / 4, (r[2, 1] - r[1, 2]) / root, (r[0, 2] - r[2, 0]) / root, (r[1, 0] - r[0, 1]) / root),
        ((r[2, 1] - r[1, 2]) / root, root / 4, (r[0, 1] + r[1, 0]) / root, (r[0, 2] + r[2, 0]) / root),
        ((r[0, 2] - r[2, 0]) / root, (r[0, 1] + r[1, 0]) / root, root / 4, (r[1, 2] + r[2, 1]) / root),
        ((r[1, 0] - r[0, 1]) / root, (r[0, 2] + r[2, 0]) / root, (r[1, 2] + r[2, 1]) / root, root / 4),
    )
    w, x, y, z = (float(value) for value in rows[largest])
    return QuaternionRotation((w, x, y, z))
