"""Families of set-ups: a rectangular sensor, a target, a few named lengths and angles.

The sensor "sensor" is the rectangle of `sensor_size` = (x, y) centred at the origin in the plane z = 0, with normal +z.
The target "target" is a plate of `target_size`, unless a family says otherwise. Lengths are in metres, angles in degrees.
Space around the sensor has three regions: I in front of the plate, II beside an edge, III diagonal to a corner. Parameters
outside the family are refused with an InputError that names the parameter.

The target of every family is of a `material`: grounded or floating, or, where it has a volume, dielectric. A floating target is
connected to the ground through the capacitance `to_ground` (F; 0: insulated). `machine` names what stands around sensor and target
(`geometries.studies.machines`): "none", or one before which the target alone comes and goes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene.poses import Pose
from geometries.scene.scene import Object, Plate, Scene, Sensor
from geometries.scene.shapes import Cuboid, PlateShape
from geometries.studies import machines, placement

Vector2 = tuple[float, float]

GROUNDED, FLOATING, DIELECTRIC = "grounded", "floating", "dielectric"
CONDUCTORS = (GROUNDED, FLOATING)
MATERIALS = (*CONDUCTORS, DIELECTRIC)
USUAL: dict[str, float | str] = {"material": GROUNDED, "to_ground": 0.0, "machine": machines.NONE}
"""The parameters that all families have, and their values if they are not given."""


def empty(sensor_size: Vector2) -> Scene:
    """Returns the sensor alone: the set-up that `delta_self` is measured against."""
    _check_size("sensor_size", sensor_size)
    x, y = sensor_size
    plate = Plate(corner=(-x / 2, -y / 2, 0.0), edge_u=(x, 0.0, 0.0), edge_v=(0.0, y, 0.0))
    return Scene(sensors=(Sensor("sensor", (plate,)),))


def parallel(
    sensor_size: Vector2,
    target_size: Vector2,
    gap: float,
    offset: Vector2 = (0.0, 0.0),
    material: str = GROUNDED,
    to_ground: float = 0.0,
    machine: str = machines.NONE,
) -> Scene:
    """Returns the target parallel to the sensor at height `gap`, its centre `offset` from the sensor's axis in x and y."""
    _check_at_least("gap", gap, 0.0, strictly=True)
    scene = _scene(sensor_size, target_size, 0.0, 0.0, lambda box: (offset[0], offset[1], gap))
    return _in_company(scene, material, to_ground, machine)


def inclined(
    sensor_size: Vector2,
    target_size: Vector2,
    hinge_gap: float,
    tilt_degrees: float,
    material: str = GROUNDED,
    to_ground: float = 0.0,
    machine: str = machines.NONE,
) -> Scene:
    """Returns the target that pivots about its edge above the sensor's edge x = −x/2, parallel to y (thesis 6.4, Experiment IV).

    The hinge stays at height `hinge_gap`; the target lies parallel to the sensor at 0 degrees and stands upright at 90.
    """
    _check_at_least("hinge_gap", hinge_gap, 0.0, strictly=True)
    hinge = -sensor_size[0] / 2
    scene = _scene(
        sensor_size,
        target_size,
        tilt_degrees,
        0.0,
        lambda box: (hinge - box[0, 0], 0.0, hinge_gap - box[0, 2]),
    )
    return _in_company(scene, material, to_ground, machine)


def edge(
    sensor_size: Vector2,
    target_size: Vector2,
    gap: float,
    height: float,
    tilt_degrees: float = 0.0,
    material: str = GROUNDED,
    to_ground: float = 0.0,
    machine: str = machines.NONE,
) -> Scene:
    """Returns the target beside the sensor's edge x = x/2, wholly in region II.

    `gap` is the lateral distance from that edge to the target's near edge, `height` the near edge's z (0: coplanar). The
    target is tilted upwards about its near edge. It may not be longer in y than the sensor: it would reach region III.
    """
    _check_at_least("gap", gap, 0.0, strictly=False)
    _check_at_least("height", height, 0.0, strictly=False)
    if gap == 0 and height == 0:
        raise InputError("", "gap", "must be greater than 0 at height 0: the target would touch the sensor")
    if target_size[1] > sensor_size[1]:
        raise InputError(
            "", "target_size[1]", "must be at most sensor_size[1]: the target would leave region II"
        )
    near = sensor_size[0] / 2 + gap
    scene = _scene(
        sensor_size, target_size, tilt_degrees, 0.0, lambda box: (near - box[0, 0], 0.0, height - box[0, 2])
    )
    return _in_company(scene, material, to_ground, machine)


def corner(
    sensor_size: Vector2,
    target_size: Vector2,
    gap: Vector2,
    height: float,
    tilt_degrees: float = 0.0,
    turn_degrees: float = 0.0,
    material: str = GROUNDED,
    to_ground: float = 0.0,
    machine: str = machines.NONE,
) -> Scene:
    """Returns the target diagonal to the sensor's corner (x/2, y/2), wholly in region III.

    `gap` holds the lateral distances along x and y from that corner to the box around the target, `height` is the z of
    the target's lowest point (0: coplanar). The target is tilted about its y axis, then turned about z.
    """
    for axis in (0, 1):
        _check_at_least(f"gap[{axis}]", gap[axis], 0.0, strictly=False)
    _check_at_least("height", height, 0.0, strictly=False)
    if gap[0] == 0 and gap[1] == 0 and height == 0:
        raise InputError("", "gap", "must be greater than 0 at height 0: the target would touch the sensor")
    near_x, near_y = sensor_size[0] / 2 + gap[0], sensor_size[1] / 2 + gap[1]
    scene = _scene(
        sensor_size,
        target_size,
        tilt_degrees,
        turn_degrees,
        lambda box: (near_x - box[0, 0], near_y - box[0, 1], height - box[0, 2]),
    )
    return _in_company(scene, material, to_ground, machine)


def straddle(
    sensor_size: Vector2,
    target_size: Vector2,
    gap: float,
    offset: Vector2,
    tilt_degrees: float = 0.0,
    turn_degrees: float = 0.0,
    material: str = GROUNDED,
    to_ground: float = 0.0,
    machine: str = machines.NONE,
) -> Scene:
    """Returns the target partly over the sensor, partly beside it: in several regions at once.

    `gap` is the height of its lowest point, `offset` its centre from the sensor's axis in x and y. It is tilted about
    its y axis, then turned about z.
    """
    _check_at_least("gap", gap, 0.0, strictly=True)
    scene = _scene(
        sensor_size,
        target_size,
        tilt_degrees,
        turn_degrees,
        lambda box: (offset[0], offset[1], gap - box[0, 2]),
    )
    outline = scene.conductors()["target"][:, :, :2].reshape(-1, 2)
    if not placement.straddles(outline, np.asarray(sensor_size) / 2):
        raise InputError("", "offset", "the target must lie partly over the sensor and partly beside it")
    return _in_company(scene, material, to_ground, machine)


def sensors(
    sensor_size: Vector2,
    target_size: Vector2,
    separation: float,
    gap: float,
    offset: Vector2 = (0.0, 0.0),
    material: str = GROUNDED,
    to_ground: float = 0.0,
    machine: str = machines.NONE,
) -> Scene:
    """Returns two equal sensors side by side in z = 0, and the target parallel to them at height `gap`.

    "sensor" is at the origin, "neighbour" beside its edge x = x/2, `separation` away from it. The target's centre is `offset`
    from the axis of "sensor".
    """
    _check_at_least("separation", separation, 0.0, strictly=True)
    scene = parallel(sensor_size, target_size, gap, offset)
    (x, y), start = sensor_size, sensor_size[0] / 2 + separation
    plate = Plate(corner=(start, -y / 2, 0.0), edge_u=(x, 0.0, 0.0), edge_v=(0.0, y, 0.0))
    scene = replace(scene, sensors=(*scene.sensors, Sensor("neighbour", (plate,))))
    return _in_company(scene, material, to_ground, machine)


def box(
    sensor_size: Vector2,
    target_size: Vector2,
    thickness: float,
    gap: float,
    offset: Vector2 = (0.0, 0.0),
    material: str = GROUNDED,
    relative_permittivity: float = 1.0,
    to_ground: float = 0.0,
    machine: str = machines.NONE,
) -> Scene:
    """Returns a cuboid as target, parallel to the sensor, `thickness` high, its lower face at height `gap`, `offset` from the axis.

    A dielectric target, and no other, has a `relative_permittivity`, other than 1.
    """
    _check_size("sensor_size", sensor_size)
    _check_size("target_size", target_size)
    _check_at_least("thickness", thickness, 0.0, strictly=True)
    _check_at_least("gap", gap, 0.0, strictly=True)
    _check_at_least("relative_permittivity", relative_permittivity, 0.0, strictly=True)
    if (material == DIELECTRIC) != (relative_permittivity != 1):
        raise InputError(
            "", "relative_permittivity", "must differ from 1 for a dielectric target, and only there"
        )
    target = Object(
        "target",
        Cuboid((*target_size, thickness)),
        pose=Pose((offset[0], offset[1], gap + thickness / 2)),
        relative_permittivity=relative_permittivity if material == DIELECTRIC else None,
    )
    scene = Scene(sensors=empty(sensor_size).sensors, objects=(target,))
    return _in_company(scene, material, to_ground, machine, MATERIALS)


FAMILIES: dict[str, Callable[..., Scene]] = {
    "parallel": parallel,
    "inclined": inclined,
    "edge": edge,
    "corner": corner,
    "straddle": straddle,
    "sensors": sensors,
    "box": box,
}


def _scene(
    sensor_size: Vector2,
    target_size: Vector2,
    tilt_degrees: float,
    turn_degrees: float,
    place: Callable[[Array], tuple[float, float, float]],
) -> Scene:
    """Returns the sensor with a target that is tilted about y (its +x end upwards), turned about z, then moved by `place`.

    `place` gets the bounding box (2, 3), lowest and highest coordinates, of the rotated target centred at the origin.
    """
    _check_size("target_size", target_size)
    if not 0 <= tilt_degrees <= 90:
        raise InputError("", "tilt_degrees", f"must be in 0 … 90, not {tilt_degrees!r}")
    sensor_alone = empty(sensor_size)
    shape = PlateShape(target_size)
    rotation = placement.rotation(tilt_degrees, turn_degrees)
    x, y, z = place(placement.box(shape, rotation))
    target = Object("target", shape, pose=Pose((float(x), float(y), float(z)), rotation))
    return Scene(sensors=sensor_alone.sensors, objects=(target,))


def _in_company(
    scene: Scene, material: str, to_ground: float, machine: str, materials: tuple[str, ...] = CONDUCTORS
) -> Scene:
    """Returns a scene with one grounded target, connected as `material` and `to_ground` say, before a machine."""
    _check_choice("material", material, materials)
    _check_choice("machine", machine, machines.MACHINES)
    _check_at_least("to_ground", to_ground, 0.0, strictly=False)
    if material == FLOATING:
        (target,) = scene.objects
        scene = replace(scene, objects=(replace(target, potential=FLOATING, to_ground=to_ground),))
    elif to_ground != 0:
        raise InputError("", "to_ground", f"connects floating targets to the ground; this one is {material}")
    return machines.around(scene, machine)


def _check_choice(name: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise InputError("", name, f"must be one of {', '.join(known)}, not {value!r}")


def _check_size(name: str, size: Vector2) -> None:
    for index, length in enumerate(size):
        if not (math.isfinite(length) and length > 0):
            raise InputError("", f"{name}[{index}]", f"must be greater than 0, not {length!r}")


def _check_at_least(name: str, value: float, least: float, strictly: bool) -> None:
    if not math.isfinite(value) or value < least or (strictly and value == least):
        relation = "greater than" if strictly else "at least"
        raise InputError("", name, f"must be {relation} {least:g}, not {value!r}")
