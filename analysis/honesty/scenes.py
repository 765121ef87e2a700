"""Random scenes whose answers are not known: one function for each kind, and how sizes, sensors and bodies are drawn by chance. Metres, degrees; the sensor lies in the plane
z = 0 and looks along +z."""

import hashlib
import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from geometries.common.arrays import Array
from geometries.scene import meshes, shapes
from geometries.scene.covers import covers
from geometries.scene.person import Person
from geometries.scene.poses import AxisRotation, Joint, Pose, Vector3
from geometries.scene.scene import Link, Medium, Object, Plate, Reading, Scene, Sensor
from geometries.studies.machines import ARM, GUARD, HOUSING, NONE, around, before as with_readings

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
    x, y, z = (round(chance.gauss(0, 1), _DIGITS) for _ in range(3))
    return AxisRotation((x, y, z or 1.0), uniform(chance, 0, 180))


def sensor(chance: Chance, name: str = "front", x: float = 0.0) -> Sensor:
    """Draws a sensor of one rectangle of 2 to 15 cm, centred at (x, 0, 0)."""
    width, height = (logarithmic(chance, 0.02, 0.15) for _ in range(2))
    corner = (x - width / 2, -height / 2, 0.0)
    return Sensor(name, (Plate(corner, (width, 0.0, 0.0), (0.0, height, 0.0)),))


def angular(chance: Chance) -> shapes.Shape:
    """Draws a plate or a box with sides of 2 to 30 cm."""
    x, y, z = (logarithmic(chance, 0.02, 0.3) for _ in range(3))
    return shapes.PlateShape((x, y)) if chance.random() < 0.3 else shapes.Cuboid((x, y, z))


def round_body(chance: Chance, low: float = 0.02, high: float = 0.3, is_solid: bool = False) -> shapes.Shape:
    """Draws a body with a curved surface, whose sizes are in this range; a sheet only if it need not be solid."""
    a, b, c = (logarithmic(chance, low, high) for _ in range(3))
    segments = chance.choice(_SEGMENTS)
    bodies: list[shapes.Shape] = [
        shapes.Sphere(a / 2, segments),
        shapes.Cylinder(a / 2, b, segments),
        shapes.Capsule(a / 4, b, segments),
        shapes.Ellipsoid((a / 2, b / 2, c / 2), segments),
        shapes.Cone(a / 2, b, segments),
        shapes.Arc(a / 4, a / 2, b / 4, chance.choice((120.0, 360.0)), segments),
        shapes.RoundedCuboid((a, b, c), min(a, b, c) / 4, segments),
    ]
    if not is_solid:
        bodies.append(shapes.Disc(a / 2, segments))
    return chance.choice(bodies)


def before(
    name: str,
    shape: shapes.Shape,
    gap: float,
    aside: tuple[float, float],
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


_GAPS = (0.005, 0.3)
TARGET = "target"


def on_machine(chance: Chance, scene: Scene, *machines: str) -> Scene:
    """Draws one of the machines around sensors and targets. Without one, targets are marked and readings named in half of the scenes:
    some methods answer for changes only where a scene asks for them."""
    machine = chance.choice(machines)
    return with_readings(scene, ()) if machine == NONE and chance.random() < 0.5 else around(scene, machine)


def plates(chance: Chance) -> Scene:
    """A sensor by itself before a plate in any direction."""
    size = logarithmic(chance, 0.02, 0.3), logarithmic(chance, 0.02, 0.3)
    rotation = turn(chance)
    target = before(TARGET, shapes.PlateShape(size), _gap(chance), aside(chance), rotation)
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), NONE)


def sizes(chance: Chance) -> Scene:
    """A machine before a wall, a box, a ball or a person of 1 cm to 5 m."""
    gap, size = logarithmic(chance, 0.005, 0.5), logarithmic(chance, 0.01, 5.0)
    tall = min(max(size, 0.4), 1.9)
    bodies: dict[str, shapes.Shape] = {
        "wall": shapes.Cuboid((size, size, 0.1)),
        "box": shapes.Cuboid((size, uniform(chance, 0.3, 1) * size, uniform(chance, 0.3, 1) * size)),
        "ball": shapes.Sphere(size / 2, 48),
        "person": Person(tall, posture=chance.choice(("standing", "lying", "arm_stretched"))),
    }
    target = before(TARGET, bodies[chance.choice(sorted(bodies))], gap, aside(chance, 0.3 * size))
    scene = Scene(sensors=(sensor(chance),), objects=(target,))
    return on_machine(chance, scene, HOUSING, GUARD, ARM)


def round_targets(chance: Chance) -> Scene:
    """A sensor, alone or before a housing, and a body with a curved surface."""
    target = before(TARGET, round_body(chance), _gap(chance), aside(chance), turn(chance))
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), NONE, HOUSING)


def flat_boxes(chance: Chance) -> Scene:
    """A sensor, alone or before a housing, and boxes a tenth to a thousandth as thick as they are wide."""
    bodies = []
    for number in range(chance.choice((1, 1, 2))):
        width, depth = (logarithmic(chance, 0.03, 0.3) for _ in range(2))
        thickness = width * logarithmic(chance, 1e-3, 0.1)
        # The second one lies beyond the first, which lies flat.
        gap = _gap(chance) + 0.5 * number
        rotation = turn(chance) if number == 0 and chance.random() < 0.5 else _UPRIGHT
        name = TARGET if number == 0 else "second target"
        shape = shapes.Cuboid((width, depth, thickness))
        bodies.append(before(name, shape, gap, aside(chance), rotation))
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=tuple(bodies)), NONE, HOUSING)


def covered(chance: Chance) -> Scene:
    """Two sensors on a housing, of which one or both have a cover of an insulator."""
    thickness = logarithmic(chance, 0.0005, 0.004)
    pair = _pair(chance)
    gap = thickness + _gap(chance)
    shape = angular(chance) if chance.random() < 0.5 else round_body(chance)
    scene = Scene(sensors=pair, objects=(before(TARGET, shape, gap, aside(chance), turn(chance)),))
    whole = around(scene, HOUSING)
    chosen = chance.choice((pair[:1], pair[1:], pair[1:], pair))
    layers = tuple(layer for each in chosen for layer in covers(each, thickness, uniform(chance, 1.5, 10)))
    # Readers put covers first.
    return replace(whole, objects=(*layers, *whole.objects))


def insulators(chance: Chance) -> Scene:
    """A sensor, alone or before a housing, and a target of an insulator with a permittivity of 1 to 1e6."""
    shape = round_body(chance, is_solid=True) if chance.random() < 0.5 else _box(chance)
    material = 1.0 if chance.random() < 0.05 else logarithmic(chance, 1.05, 1e6)
    target = before(TARGET, shape, _gap(chance), aside(chance), turn(chance), relative_permittivity=material)
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), NONE, HOUSING)


def floating(chance: Chance) -> Scene:
    """A sensor on a machine, and a target that floats, or is connected to the ground through 0.01 to 100 pF."""
    shape = angular(chance) if chance.random() < 0.7 else round_body(chance)
    to_ground = chance.choice((0.0, logarithmic(chance, 1e-14, 1e-10)))
    grounding = {"potential": "floating", "to_ground": to_ground}
    target = before(TARGET, shape, _gap(chance), aside(chance), turn(chance), **grounding)
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), HOUSING, GUARD)


def guarded(chance: Chance) -> Scene:
    """A sensor before its guard and a housing, read with the guard driven, grounded, and driven alone."""
    target = before(TARGET, angular(chance), _gap(chance), aside(chance), turn(chance))
    scene = around(Scene(sensors=(sensor(chance),), objects=(target,)), GUARD)
    more = (Reading("guard grounded", "front", ("front",)), Reading("from the guard", "front", ("guard",)))
    return replace(scene, readings=(*scene.readings, *more))


def transmitted(chance: Chance) -> Scene:
    """Two sensors, alone or on a housing: each by itself, and one that senses what the other drives."""
    target = before(TARGET, angular(chance), _gap(chance), aside(chance), turn(chance))
    scene = on_machine(chance, Scene(sensors=_pair(chance), objects=(target,)), NONE, HOUSING)
    own = tuple(Reading(each.name, each.name, (each.name,)) for each in scene.sensors)
    return replace(scene, readings=(*own, Reading("transmitted", "front", ("beside",))))


def _pair(chance: Chance) -> tuple[Sensor, Sensor]:
    """Draws two sensors beside each other."""
    first = sensor(chance)
    second = sensor(chance, "beside")
    half = sum(each.plates[0].edge_u[0] / 2 for each in (first, second))
    shift = round(half + logarithmic(chance, 0.003, 0.05), 6)
    plate = second.plates[0]
    x, y, z = plate.corner
    return first, replace(second, plates=(replace(plate, corner=(x + shift, y, z)),))


def _box(chance: Chance) -> shapes.Cuboid:
    x, y, z = (logarithmic(chance, 0.02, 0.2) for _ in range(3))
    return shapes.Cuboid((x, y, z))


def _gap(chance: Chance) -> float:
    return logarithmic(chance, *_GAPS)


def hand(chance: Chance, link: str | None = None) -> Object:
    """Draws a hand: a box or a round body of 4 to 20 cm before the origin of a link."""
    shape = _box(chance) if chance.random() < 0.5 else round_body(chance, 0.04, 0.2, is_solid=True)
    return replace(before(TARGET, shape, _gap(chance), aside(chance), turn(chance), target=True), link=link)


_FACETS = 24
_ROWS = 8


def revolved(outline: list[tuple[float, float]], segments: int = _FACETS) -> Array:
    """Returns the triangles (n, 3, 3) of the polygon `outline` of (distance from the axis, z), turned about z; its sides follow
    each other so that their left side is outside."""
    angles = 2 * math.pi * np.arange(segments + 1) / segments
    circle, heights = np.column_stack([np.cos(angles), np.sin(angles)]), np.ones((segments + 1, 1))
    circle[-1] = circle[0]
    rings = [np.hstack([r * circle, z * heights]) for r, z in outline]
    triangles = []
    for (r, _), (s, _), a, b in zip(outline, outline[1:], rings, rings[1:]):
        if r > 0:
            triangles.append(np.stack([a[:-1], a[1:], b[1:]], axis=1))
        if s > 0:
            triangles.append(np.stack([a[:-1], b[1:], b[:-1]], axis=1))
    return np.concatenate(triangles)


def mesh(triangles: Array, folder: Path) -> shapes.MeshShape:
    """Writes triangles to a file in the folder that is named by their content; returns them as a shape."""
    name = hashlib.sha256(np.ascontiguousarray(triangles).tobytes()).hexdigest()[:16]
    file = folder.resolve() / f"{name}.ply"
    if not file.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        meshes.write(triangles, file)
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    return shapes.MeshShape(str(file), digest, 1.0, meshes.read_triangles(file))


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
        is_bowl = kind == "bowl"
        half_angle = uniform(chance, 0.5, 2.5) if is_bowl else 0.0
        triangles = bowl(radius, half_angle, _FACETS, _ROWS) if is_bowl else revolved(outlines[kind])
        objects = (before(TARGET, mesh(triangles, folder), gap, at, rotation),)
    scene = Scene(sensors=(sensor(chance),), objects=objects)
    return on_machine(chance, scene, NONE, HOUSING)


def _tray(radius: float, height: float, gap: float, at: tuple[float, float]) -> tuple[Object, ...]:
    """Returns five plates, one conductor, that are a box which opens towards the sensor."""
    x, y = at
    middle = gap + height / 2
    about_x, about_y = (AxisRotation(axis, 90.0) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    sides = ((-radius, 0.0), (radius, 0.0), (0.0, -radius), (0.0, radius))
    walls = []
    for number, (dx, dy) in enumerate(sides):
        # A plate turned about y by 90 degrees has its x along -z, one about x its y along z.
        shape = shapes.PlateShape((height, 2 * radius) if dx else (2 * radius, height))
        pose = Pose((x + dx, y + dy, middle), about_y if dx else about_x)
        walls.append(Object(f"side {number}", shape, pose=pose, conductor=TARGET))
    bottom = shapes.PlateShape((2 * radius, 2 * radius))
    return (Object("bottom", bottom, pose=Pose((x, y, gap + height)), conductor=TARGET), *walls)


def unsensed(chance: Chance) -> Scene:
    """Two to four bodies in a row, the first an electrode, and no sensor: the Maxwell matrix is asked for."""
    bodies: list[Object] = []
    reach = 0.0
    for number in range(chance.choice((2, 2, 3, 4))):
        shape = angular(chance) if chance.random() < 0.6 else round_body(chance)
        # That of the smallest ball about the origin of the shape's frame that contains its triangles.
        radius = float(np.linalg.norm(shape.triangles().reshape(-1, 3), axis=1).max())
        gap = radius * logarithmic(chance, 0.05, 2.0)
        x = 0.0 if number == 0 else round(reach + gap + radius, 6)
        reach = x + radius
        potentials = ("electrode", "electrode", "grounded", "floating")
        potential = "electrode" if number == 0 else chance.choice(potentials)
        pose = Pose((x, 0.0, 0.0), turn(chance))
        bodies.append(Object(f"body {number}", shape, pose=pose, potential=potential))
    medium = Medium(uniform(chance, 1, 80)) if chance.random() < 0.2 else Medium()
    return Scene(medium=medium, objects=tuple(bodies))


def robot(chance: Chance) -> Scene:
    """An arm of three or four links of boxes and cylinders, a sensor on its tool or on the link before it, and a hand."""
    count = chance.choice((3, 4))
    links = [Link("base")]
    thick = logarithmic(chance, 0.05, 0.12)
    objects = [Object("foot", shapes.Cylinder(thick, 0.1, _FACETS), "base", Pose((0.0, 0.0, 0.05)))]
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
    sensor, reading = Sensor("front", (plate,), "tool"), Reading("front", "front", ("front",))
    bodies = (*objects, hand(chance, "hand"))
    return Scene(links=tuple(links), sensors=(sensor,), objects=bodies, readings=(reading,))


def _limb(chance: Chance, name: str, link: str, thick: float, long: float) -> Object:
    """Draws a limb from the link's origin along z that reaches half its thickness beyond `long`."""
    length, radius = long + thick / 2, thick / 2
    kinds: tuple[shapes.Shape, ...] = (
        shapes.Cuboid((thick, thick, length)),
        shapes.Cylinder(radius, length, _FACETS),
        shapes.Capsule(radius, length - 2 * radius, _FACETS),
    )
    return Object(name, chance.choice(kinds), link, Pose((0.0, 0.0, length / 2)))
