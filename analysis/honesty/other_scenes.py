"""Random scenes of hollow bodies, of arms, and without any sensor: one function for each kind."""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

import numpy as np

from analysis.honesty.before_sensors import TARGET, hand, on_machine
from analysis.honesty.drawing import (
    Chance,
    angular,
    aside,
    before,
    logarithmic,
    radius_of,
    round_body,
    sensor,
    turn,
    uniform,
)
from geometries.common.arrays import Array
from geometries.scene import meshes
from geometries.scene.joints import Joint
from geometries.scene.poses import AxisRotation, Pose, Vector3
from geometries.scene.scene import Link, Medium, Object, Plate, Reading, Scene, Sensor
from geometries.scene.shapes import Capsule, Cuboid, Cylinder, MeshShape, PlateShape
from geometries.studies.machines import HOUSING, NONE

_SEGMENTS = 24
_ROWS = 8


def revolved(outline: list[tuple[float, float]], segments: int = _SEGMENTS) -> Array:
    """Returns the triangles (n, 3, 3) of the polygon `outline` of (distance from the axis, z), turned about z; its sides follow
    each other so that their left side is outside."""
    angles = 2 * math.pi * np.arange(segments + 1) / segments
    rings = [
        np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full_like(angles, z)]) for r, z in outline
    ]
    for ring in rings:
        ring[-1] = ring[0]
    triangles = []
    for (r, _), (s, _), a, b in zip(outline, outline[1:], rings, rings[1:]):
        if r > 0:
            triangles.append(np.stack([a[:-1], a[1:], b[1:]], axis=1))
        if s > 0:
            triangles.append(np.stack([a[:-1], b[1:], b[:-1]], axis=1))
    return np.concatenate(triangles)


def mesh(triangles: Array, folder: Path) -> MeshShape:
    """Writes triangles to a file in the folder that is named by their content; returns them as a shape."""
    name = hashlib.sha256(np.ascontiguousarray(triangles).tobytes()).hexdigest()[:16]
    file = folder.resolve() / f"{name}.ply"
    if not file.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        meshes.write(triangles, file)
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    return MeshShape(str(file), digest, 1.0, meshes.read_triangles(file))


def bowl(radius: float, half_angle: float, segments: int, rows: int) -> Array:
    """Returns the triangles of the part of a sphere within `half_angle` (rad) of the lowest point; vertices on the sphere."""
    angles = half_angle * np.arange(rows + 1) / rows
    outline = [(float(radius * math.sin(angle)), float(-radius * math.cos(angle))) for angle in angles]
    return revolved([(0.0, -radius), *outline[1:]], segments)


def hollow(chance: Chance, folder: Path) -> Scene:
    """A sensor, alone or before a housing, and a tube, a cup, a bowl or a tray, which opens in any direction."""
    radius, height = logarithmic(chance, 0.02, 0.12), logarithmic(chance, 0.03, 0.3)
    kind = chance.choice(("tube", "cup", "thick cup", "bowl", "tray"))
    gap, at, rotation = logarithmic(chance, 0.005, 0.2), aside(chance), turn(chance)
    if kind == "tray":
        objects = _tray(radius, height, gap, at)
    else:
        low, high, wall = -height / 2, height / 2, 0.1 * radius
        outlines = {
            "tube": [(radius, low), (radius, high)],
            "cup": [(0.0, low), (radius, low), (radius, high)],
            "thick cup": [(0.0, low), (radius, low), (radius, high), (radius - wall, high)]
            + [(radius - wall, low + wall), (0.0, low + wall)],
        }
        triangles = (
            bowl(radius, uniform(chance, 0.5, 2.5), _SEGMENTS, _ROWS)
            if kind == "bowl"
            else revolved(outlines[kind])
        )
        objects = (before(TARGET, mesh(triangles, folder), gap, at, rotation),)
    scene = Scene(sensors=(sensor(chance),), objects=objects)
    return on_machine(chance, scene, NONE, HOUSING)


def _tray(radius: float, height: float, gap: float, at: tuple[float, float]) -> tuple[Object, ...]:
    """Returns five plates, one conductor, that are a box which opens towards the sensor."""
    x, y = at
    middle = gap + height / 2
    sides: tuple[tuple[float, float, AxisRotation], ...] = (
        (-radius, 0.0, AxisRotation((0.0, 1.0, 0.0), 90.0)),
        (radius, 0.0, AxisRotation((0.0, 1.0, 0.0), 90.0)),
        (0.0, -radius, AxisRotation((1.0, 0.0, 0.0), 90.0)),
        (0.0, radius, AxisRotation((1.0, 0.0, 0.0), 90.0)),
    )
    # A plate turned about y by 90 degrees has its x along -z, one about x its y along z.
    walls = [
        Object(
            f"side {number}",
            PlateShape((height, 2 * radius) if rotation.axis[1] else (2 * radius, height)),
            pose=Pose((x + dx, y + dy, middle), rotation),
            conductor=TARGET,
        )
        for number, (dx, dy, rotation) in enumerate(sides)
    ]
    bottom = PlateShape((2 * radius, 2 * radius))
    return (Object("bottom", bottom, pose=Pose((x, y, gap + height)), conductor=TARGET), *walls)


def unsensed(chance: Chance, folder: Path) -> Scene:
    """Two to four bodies in a row, the first an electrode, and no sensor: the Maxwell matrix is asked for."""
    bodies: list[Object] = []
    reach = 0.0
    for number in range(chance.choice((2, 2, 3, 4))):
        shape = angular(chance) if chance.random() < 0.6 else round_body(chance)
        radius = radius_of(shape)
        gap = radius * logarithmic(chance, 0.05, 2.0)
        x = 0.0 if number == 0 else round(reach + gap + radius, 6)
        reach = x + radius
        potential = (
            "electrode" if number == 0 else chance.choice(("electrode", "electrode", "grounded", "floating"))
        )
        bodies.append(
            Object(f"body {number}", shape, pose=Pose((x, 0.0, 0.0), turn(chance)), potential=potential)
        )
    medium = Medium(uniform(chance, 1, 80)) if chance.random() < 0.2 else Medium()
    return Scene(medium=medium, objects=tuple(bodies))


def robot(chance: Chance, folder: Path) -> Scene:
    """An arm of three or four links of boxes and cylinders, a sensor on its tool or on the link before it, and a hand."""
    count = chance.choice((3, 4))
    links = [Link("base")]
    thick = logarithmic(chance, 0.05, 0.12)
    objects = [Object("foot", Cylinder(thick, 0.1, _SEGMENTS), "base", Pose((0.0, 0.0, 0.05)))]
    begin = 0.1 + thick
    for number in range(1, count + 1):
        axis: Vector3 = (0.0, 1.0, 0.0) if number > 1 else (0.0, 0.0, 1.0)
        rest = Pose((0.0, 0.0, begin))
        joint = Joint(f"joint {number}", "revolute", axis, rest, round(chance.uniform(-0.9, 0.9), 3))
        links.append(Link(f"link {number}", links[-1].name, joint.pose_at(joint.position), joint))
        long = logarithmic(chance, 0.15, 0.4)
        objects.append(_limb(chance, f"limb {number}", links[-1].name, thick, long))
        begin = long
    end = links[-1].name
    width, height = (logarithmic(chance, 0.03, thick) for _ in range(2))
    off = round(begin + thick / 2 + logarithmic(chance, 0.003, 0.02), 6)
    plate = Plate((-width / 2, -height / 2, 0.0), (width, 0.0, 0.0), (0.0, height, 0.0))
    # A target may not be on the link that carries a sensor.
    links += [Link("tool", end, Pose((0.0, 0.0, off))), Link("hand", "tool")]
    return Scene(
        links=tuple(links),
        sensors=(Sensor("front", (plate,), "tool"),),
        objects=(*objects, hand(chance, "hand")),
        readings=(Reading("front", "front", ("front",)),),
    )


def _limb(chance: Chance, name: str, link: str, thick: float, long: float) -> Object:
    """Draws a limb from the link's origin along z that reaches half its thickness beyond `long`."""
    kind = chance.choice(("box", "cylinder", "capsule"))
    length, radius = long + thick / 2, thick / 2
    pose = Pose((0.0, 0.0, length / 2))
    if kind == "box":
        return Object(name, Cuboid((thick, thick, length)), link, pose)
    if kind == "cylinder":
        return Object(name, Cylinder(radius, length, _SEGMENTS), link, pose)
    return Object(name, Capsule(radius, length - 2 * radius, _SEGMENTS), link, pose)
