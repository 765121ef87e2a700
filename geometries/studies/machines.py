"""Machines: what stands around sensors and stays when the targets come and go, and what the electronics then measure. Metres.

The sensors lie in the plane z = 0 of the world, with normal +z. `size` below is the square root of the area of the rectangle
around all of them, which for one sensor is the sensor itself.

* none: sensors and targets in empty space
* housing: a grounded cuboid behind the sensors, twice as long and as wide as their rectangle and `size` deep, its face 0.2 `size`
  behind them
* housing+guard: the housing and, halfway before it, a plate 1.4 times as long and as wide as the sensors' rectangle, driven with
  the sensor that is read
* arm: on either side of the sensors, along y and 0.1 `size` beside them, one more sensor like the first one; and three grounded links, cuboids
  that overlap at the joints: the first, 0.2 `size` longer and wider than the rectangle of all sensors, lies 0.1 `size` behind it, the second leads away
  from it backwards, the third aside. Here `size` is that of the first sensor
* table: a grounded cuboid before sensors and targets, 5 × 4 × 1 `size`, its face one `size` behind the target's farthest point
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from geometries.scene.poses import Pose, Vector3
from geometries.scene.scene import Object, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid, PlateShape

NONE, HOUSING, GUARD, ARM, TABLE = "none", "housing", "housing+guard", "arm", "table"
MACHINES = (NONE, HOUSING, GUARD, ARM, TABLE)

# Lengths relative to the sensors', as in geometries/scenes/guarded_sensor.toml: of housing and guard along x and y relative to the
# rectangle of the sensors, all others relative to its size.
_HOUSING, _HOUSING_DEPTH, _HOUSING_BEHIND = 2.0, 1.0, 0.2
_GUARD, _GUARD_BEHIND = 1.4, 0.1
_TABLE, _TABLE_BEHIND = (5.0, 4.0, 1.0), 1.0
_ARM_MARGIN, _ARM_BEHIND, _ARM_THICK, _ARM_LONG, _ASIDE = 0.1, 0.1, 0.6, 3.0, 0.1


def around(scene: Scene, machine: str) -> Scene:
    """Returns sensors and targets in front of a machine, one of MACHINES; with "none" the scene itself."""
    if machine == NONE:
        return scene
    if machine == TABLE:
        return before(scene, (_table_of(scene),))
    if machine == ARM:
        scene = replace(scene, sensors=(*scene.sensors, *_beside(scene.sensors)))
        return before(scene, arm(scene.sensors))
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


def arm(sensors: tuple[Sensor, ...]) -> tuple[Object, ...]:
    """Returns the grounded links of an arm that carries sensors on its first link. Their size is that of one sensor's rectangle."""
    (x, y), (length, width), _ = _rectangle(sensors)
    size = _rectangle(sensors[:1])[2]
    thick, margin, long = _ARM_THICK * size, 2 * _ARM_MARGIN * size, _ARM_LONG * size
    top = -_ARM_BEHIND * size
    end = x + (length + margin) / 2
    first = Cuboid((length + margin, width + margin, thick))
    # Each joint is half a link's thickness inside both links.
    second = Cuboid((thick, thick, long))
    third = Cuboid((long, 0.8 * thick, 0.8 * thick))
    return (
        Object("link 1", first, pose=Pose((x, y, top - thick / 2))),
        Object("link 2", second, pose=Pose((end - thick, y, top - thick / 2 - long / 2))),
        Object("link 3", third, pose=Pose((end - thick + long / 2, y, top - long))),
    )


def guard(sensors: tuple[Sensor, ...]) -> Object:
    """Returns the guard between sensors and housing: an electrode."""
    (x, y), (length, width), size = _rectangle(sensors)
    shape = PlateShape((_GUARD * length, _GUARD * width))
    return Object("guard", shape, pose=Pose((x, y, -_GUARD_BEHIND * size)), potential="electrode")


def table(size: Vector3, x: float, y: float, near: float) -> Object:
    """Returns a grounded table of a size, centred at x and y, its face towards the sensors at z = `near`."""
    return Object("table", Cuboid(size), pose=Pose((x, y, near + size[2] / 2)))


def _beside(sensors: tuple[Sensor, ...]) -> tuple[Sensor, ...]:
    """Returns two sensors like the first one, beside the rectangle around all of them at its ends along y."""
    (_, y), (_, width), _ = _rectangle(sensors)
    _, (_, own), size = _rectangle(sensors[:1])
    offset = width / 2 + _ASIDE * size
    (plate,) = sensors[0].plates
    x, _, z = plate.corner
    return tuple(
        Sensor(name, (replace(plate, corner=(x, start, z)),))
        for name, start in (("left", y - offset - own), ("right", y + offset))
    )


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
