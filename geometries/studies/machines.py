"""Machines: what stands around sensors and stays when the targets come and go, and what the electronics then measure. Metres.

The sensors lie in the plane z = 0 of the world, with normal +z. `size` below is the square root of the area of the rectangle
around all of them, which for one sensor is the sensor itself.

* none: sensors and targets in empty space
* housing: a grounded cuboid behind the sensors, twice as long and as wide as their rectangle and `size` deep, its face 0.2 `size`
  behind them
* housing+guard: the housing and, halfway before it, a plate 1.4 times as long and as wide as the sensors' rectangle, driven with
  the sensor that is read
* table: a grounded cuboid before sensors and targets, 5 × 4 × 1 `size`, its face one `size` behind the target's farthest point
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from geometries.scene.poses import Pose, Vector3
from geometries.scene.scene import Object, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid, PlateShape

NONE, HOUSING, GUARD, TABLE = "none", "housing", "housing+guard", "table"
MACHINES = (NONE, HOUSING, GUARD, TABLE)

# Lengths relative to the sensors', as in geometries/scenes/guarded_sensor.toml: of housing and guard along x and y relative to the
# rectangle of the sensors, all others relative to its size.
_HOUSING, _HOUSING_DEPTH, _HOUSING_BEHIND = 2.0, 1.0, 0.2
_GUARD, _GUARD_BEHIND = 1.4, 0.1
_TABLE, _TABLE_BEHIND = (5.0, 4.0, 1.0), 1.0


def around(scene: Scene, machine: str) -> Scene:
    """Returns sensors and targets in front of a machine, one of MACHINES; with "none" the scene itself."""
    if machine == NONE:
        return scene
    if machine == TABLE:
        return before(scene, (_table_of(scene),))
    parts = (housing(scene.sensors),)
    return before(scene, (*parts, guard(scene.sensors)) if machine == GUARD else parts)


def before(scene: Scene, machine: tuple[Object, ...]) -> Scene:
    """Returns the scene with its objects marked as targets, a machine, and a reading for each sensor with the sensor's name.

    A reading drives its sensor together with all electrodes of the machine.
    """
    driven = [body.name for body in machine if body.potential == "electrode"]
    return replace(
        scene,
        objects=(*(replace(body, target=True) for body in scene.objects), *machine),
        readings=tuple(Reading(sensor.name, sensor.name, (sensor.name, *driven)) for sensor in scene.sensors),
    )


def housing(sensors: tuple[Sensor, ...]) -> Object:
    """Returns the grounded housing behind sensors."""
    (x, y), (length, width), size = _rectangle(sensors)
    depth = size * _HOUSING_DEPTH
    shape = Cuboid((length * _HOUSING, width * _HOUSING, depth))
    return Object("housing", shape, pose=Pose((x, y, -_HOUSING_BEHIND * size - depth / 2)))


def guard(sensors: tuple[Sensor, ...]) -> Object:
    """Returns the guard between sensors and housing: an electrode."""
    (x, y), (length, width), size = _rectangle(sensors)
    shape = PlateShape((_GUARD * length, _GUARD * width))
    return Object("guard", shape, pose=Pose((x, y, -_GUARD_BEHIND * size)), potential="electrode")


def table(size: Vector3, x: float, y: float, near: float) -> Object:
    """Returns a grounded table of a size, centred at x and y, its face towards the sensors at z = `near`."""
    return Object("table", Cuboid(size), pose=Pose((x, y, near + size[2] / 2)))


def _table_of(scene: Scene) -> Object:
    (x, y), _, size = _rectangle(scene.sensors)
    farthest = max(_highest(scene, body) for body in scene.objects)
    length, width, thickness = _TABLE
    return table((length * size, width * size, thickness * size), x, y, farthest + _TABLE_BEHIND * size)


def _highest(scene: Scene, body: Object) -> float:
    rotation, translation = scene.pose_of_object(body.name)
    return float((body.shape.triangles() @ rotation.T + translation)[..., 2].max())


def _rectangle(sensors: tuple[Sensor, ...]) -> tuple[tuple[float, float], tuple[float, float], float]:
    """Returns the centre and the lengths along x and y of the rectangle around sensors that are fixed to the world, and its size."""
    plates = [plate for sensor in sensors for plate in sensor.plates]
    corners = np.array([plate.corner for plate in plates])[:, :2]
    ends = np.array([np.add(plate.edge_u, plate.edge_v) for plate in plates])[:, :2]
    low, high = corners.min(axis=0), (corners + ends).max(axis=0)
    (x, y), (length, width) = ((low + high) / 2).tolist(), (high - low).tolist()
    return (x, y), (length, width), math.sqrt(length * width)
