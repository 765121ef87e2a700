"""The set-ups on machines: sensors on a housing, a table, an arm, a robot, and hands or persons before them, with the bodies that these are made of, drawn at
random. Metres, farads, in the world's frame.

Definitions of the families: MACHINES.md. The last third of each family is sealed: no rule of the model is chosen by looking at it. The sensors lie in the plane
z = 0 and look in the direction of +z. Machines lie below that plane or beside the target, targets above it: so none of them touches another by chance."""

import hashlib
import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from analysis.pipeline.set_up_stages import OfScene
from analysis.topics.draw import DIGITS, Range, between, length, rotation
from geometries.common.arrays import Array
from geometries.scene.meshes import read_triangles
from geometries.scene.poses import AxisRotation, Pose, Rotation, Vector3
from geometries.scene.scene import Object, Plate, Reading, Scene, Sensor
from geometries.scene.shapes import Capsule, Cuboid, Cylinder, Ellipsoid, MeshShape, PlateShape, Shape, Sphere
from geometries.studies import machines
from geometries.studies.families import FLOATING

# Sides of a round shape: its triangles are the truth here, and more of them cost time only.
_SEGMENTS = 12
_LINKS = tuple(Path(__file__).parent / "links" / f"{name}.obj" for name in ("shell", "bracket"))
_UPRIGHT = AxisRotation((1.0, 0.0, 0.0), 90.0)
"""Turns the axis of a capsule or cylinder from z to y."""


def hand(chance: random.Random, name: str, gap: float, shift: tuple[float, float]) -> Object:
    """Draws a body of a hand's size, turned at random, whose lowest point is `gap` above z = 0 and whose centre is shifted along x and y."""
    shape = chance.choice(_OF_HANDS)(chance)
    body = Object(name, shape, pose=Pose((*shift, 0.0), rotation(chance)))
    return _raised(body, gap - lowest(body))


def person(
    chance: random.Random, conductor: str, gap: float, shift: tuple[float, float]
) -> tuple[Object, ...]:
    """Draws a person who stretches an arm towards the sensor: capsules and balls that overlap, one conductor. The hand's lowest point is `gap`
    above z = 0, the body stands upright along y behind it."""
    tall = between(chance, (1.5, 1.9)) / 1.75
    x, y = shift
    reach = gap + 0.68 * tall
    # Radius, length of the segment and centre of each part of a person of 1.75 m, scaled with the height.
    forearm = (0.04 * tall, 0.28 * tall, (x, y, gap + 0.18 * tall), AxisRotation())
    upper_arm = (0.05 * tall, 0.3 * tall, (x, y, gap + 0.48 * tall), AxisRotation())
    trunk = (0.15 * tall, 0.42 * tall, (x + 0.12 * tall, y - 0.18 * tall, reach + 0.1 * tall), _UPRIGHT)
    legs = (0.11 * tall, 0.62 * tall, (x + 0.12 * tall, y - 0.78 * tall, reach + 0.1 * tall), _UPRIGHT)
    parts = {"forearm": forearm, "upper arm": upper_arm, "trunk": trunk, "legs": legs}
    centre = (x + 0.12 * tall, y + 0.27 * tall, reach + 0.1 * tall)
    bodies = []
    for name, (radius, segment, middle, turn) in parts.items():
        capsule = Capsule(round(radius, DIGITS), round(segment, DIGITS), _SEGMENTS)
        bodies.append(Object(name, capsule, pose=Pose(_rounded(middle), turn), conductor=conductor))
    head = Sphere(round(0.11 * tall, DIGITS), _SEGMENTS)
    return (*bodies, Object("head", head, pose=Pose(_rounded(centre)), conductor=conductor))


def chain(chance: random.Random, joints: int, size: float, top: float) -> tuple[Object, ...]:
    """Draws the links of an arm that overlap at the joints, from the one below the sensor, whose face is at z = `top` < 0, downwards and aside.
    A link is a box, a cylinder, a capsule or a mesh of about `size`; the first one is a box, on which the sensor is mounted.
    """
    depth = between(chance, (0.4 * size, size))
    along, across = length(chance, (1.2 * size, 2.5 * size)), between(chance, (1.1 * size, 1.6 * size))
    first = Cuboid((along, across, depth))
    found = [Object("link 1", first, pose=Pose((0.0, 0.0, round(top - depth / 2, DIGITS))))]
    # Each joint is deeper than half of the next link is thick, so that no link reaches the plane of the sensor.
    place = np.array([first.size[0] / 2, 0.0, top - depth])
    for number in range(2, joints + 1):
        shape = chance.choice(_OF_LINKS)(chance, size)
        points = shape.triangles().reshape(-1, 3)
        along = float(np.ptp(points[:, 2]))
        direction = _downwards(chance)
        pose = Pose(_rounded(tuple(place + direction * 0.4 * along)), _turning_z_to(direction))
        body = Object(f"link {number}", shape, pose=pose)
        # One whose highest point is above the face is lowered.
        body = _raised(body, min(0.0, top - farthest(body, 2)))
        found.append(body)
        place = np.asarray(body.pose.translation) + direction * 0.4 * along
    return tuple(found)


def lowest(body: Object) -> float:
    """Returns the height (m) of the lowest point of a body that is fixed to the world."""
    return float(_points(body)[:, 2].min())


def farthest(body: Object, axis: int) -> float:
    """Returns the largest coordinate (m) of a body that is fixed to the world."""
    return float(_points(body)[:, axis].max())


def _points(body: Object) -> Array:
    transform = body.pose.transform()
    return np.asarray(transform.points(body.shape.triangles()).reshape(-1, 3))


def _raised(body: Object, by: float) -> Object:
    x, y, z = body.pose.translation
    return replace(body, pose=Pose((x, y, round(z + by, DIGITS)), body.pose.rotation))


def _rounded(point: tuple[float, ...]) -> Vector3:
    x, y, z = (round(float(value), DIGITS) for value in point)
    return x, y, z


def _downwards(chance: random.Random) -> Array:
    """Draws a direction that points at least 15 degrees downwards."""
    height, turn = chance.uniform(math.sin(math.radians(15)), 1), 2 * math.pi * chance.random()
    across = math.sqrt(1 - height**2)
    return np.array([across * math.cos(turn), across * math.sin(turn), -height])


def _turning_z_to(direction: Array) -> Rotation:
    axis = np.cross((0.0, 0.0, 1.0), direction)
    if not np.any(np.abs(axis) > 1e-9):
        return AxisRotation((1.0, 0.0, 0.0), 180.0)
    x, y, z = (round(float(value), 6) for value in axis)
    return AxisRotation((x, y, z), round(math.degrees(math.acos(float(direction[2]))), 2))


def _lengths(chance: random.Random, x: Range, y: Range, z: Range) -> Vector3:
    return length(chance, x), length(chance, y), length(chance, z)


_OF_HANDS: tuple[Callable[[random.Random], Shape], ...] = (
    lambda chance: Cuboid(_lengths(chance, (0.05, 0.12), (0.08, 0.2), (0.02, 0.06))),
    lambda chance: Capsule(length(chance, (0.01, 0.05)), length(chance, (0.05, 0.3)), _SEGMENTS),
    lambda chance: Ellipsoid(_lengths(chance, (0.03, 0.06), (0.04, 0.1), (0.015, 0.03)), _SEGMENTS),
    lambda chance: Sphere(length(chance, (0.01, 0.1)), _SEGMENTS),
    lambda chance: PlateShape((length(chance, (0.03, 0.2)), length(chance, (0.03, 0.2)))),
)


def _link_box(chance: random.Random, size: float) -> Shape:
    thick = between(chance, (0.5 * size, size))
    return Cuboid((thick, thick, between(chance, (1.5 * size, 4 * size))))


def _radius(chance: random.Random, size: float) -> float:
    return between(chance, (0.25 * size, 0.5 * size))


def _link_mesh(chance: random.Random, size: float) -> Shape:
    whole = _mesh(chance.randrange(len(_LINKS)))
    return replace(whole, scale=round(size * chance.uniform(1.5, 4), DIGITS))


@cache
def _mesh(number: int) -> MeshShape:
    """Returns a link of length 1 along z."""
    file = _LINKS[number]
    return MeshShape(str(file), hashlib.sha256(file.read_bytes()).hexdigest(), 1.0, read_triangles(file))


_OF_LINKS: tuple[Callable[[random.Random, float], Shape], ...] = (
    _link_box,
    lambda chance, size: Cylinder(_radius(chance, size), between(chance, (1.5 * size, 4 * size)), _SEGMENTS),
    lambda chance, size: Capsule(_radius(chance, size), between(chance, (1.0 * size, 3 * size)), _SEGMENTS),
    _link_mesh,
)

HOUSING, TABLE, ARM, PERSON, ROBOT, TRANSMIT = "housing", "table", "arm", "person", "robot", "transmit"
FAMILIES = (HOUSING, TABLE, ARM, PERSON, ROBOT, TRANSMIT)
READING = "reading"

_COUNT, _SEALED = 66, 22
"""Set-ups of a family, and how many of them are sealed."""
_SEEDS = {HOUSING: 71, TABLE: 72, ARM: 73, PERSON: 74, ROBOT: 75, TRANSMIT: 76}
# Ranges of a sensor's sides, of its distance from what it is mounted on, and of the target's from the sensor.
_SIDES, _BEHIND, _GAPS = (0.03, 0.15), (0.003, 0.03), (0.015, 0.15)
_SHIFT = 0.75
"""Largest shift of a target to the side, relative to the sensors' size."""
_ASIDE = (0.002, 0.03)
"""Distance between neighbouring sensors."""
_TABLE, _TABLE_BEHIND = (0.8, 0.6, 0.03), (0.02, 0.3)
_TO_GROUND = (0.0, 1e-11, 1e-10, 1e-9)


@dataclass(frozen=True)
class SetUp(OfScene):
    """A scene with one reading, which drives and senses the first sensor; in the family `transmit` it drives the second and senses the first.
    `own` names the bodies that the sensors are mounted on, `others` the other bodies of the machine and around it.
    """

    family: str
    number: int
    sealed: bool
    own: tuple[str, ...]
    others: tuple[str, ...]

    @property
    def name(self) -> str:
        """The set-up in words."""
        return f"{self.family} {self.number}"

    @property
    def is_between_sensors(self) -> bool:
        """Whether the reading drives another sensor than it senses."""
        (reading,) = self.scene.readings
        return reading.drive != (reading.sense,)

    @property
    def targets(self) -> tuple[Object, ...]:
        return tuple(body for body in self.scene.objects if body.target)


@dataclass(frozen=True)
class _Parts:
    """What a family draws: sensors, the first of which is sensed, the bodies below them, the others, and the targets."""

    sensors: tuple[Sensor, ...]
    own: tuple[Object, ...]
    others: tuple[Object, ...]
    targets: tuple[Object, ...]


@cache
def all_set_ups() -> tuple[SetUp, ...]:
    """Returns every set-up, family by family."""
    return tuple(each for family in FAMILIES for each in _of_family(family))


def _of_family(family: str) -> Iterator[SetUp]:
    """Draws a family. Python promises that the generator's numbers stay the same."""
    chance = random.Random(_SEEDS[family])
    for number in range(1, _COUNT + 1):
        parts = _DRAWN[family](chance)
        around = (*parts.own, *parts.others)
        scene = machines.before(Scene(sensors=parts.sensors, objects=parts.targets), around)
        driven = parts.sensors[1 if family == TRANSMIT else 0].name
        scene = replace(scene, readings=(Reading(READING, parts.sensors[0].name, (driven,)),))
        own, others = (tuple(body.name for body in some) for some in (parts.own, parts.others))
        yield SetUp(scene, family, number, number > _COUNT - _SEALED, own, others)


def _housing(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, 1)
    return _Parts(sensors, _mounted_on_a_box(chance, sensors), (), (_hand(chance, size),))


def _table(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, 1)
    hand = _connected((_hand(chance, size),), chance)
    x, y = hand[0].pose.translation[:2]
    near = farthest(hand[0], 2) + length(chance, _TABLE_BEHIND)
    table = machines.table(_TABLE, x, y, round(near, DIGITS))
    return _Parts(sensors, _mounted_on_a_box(chance, sensors), (table,), hand)


def _arm(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, 3)
    links = chain(chance, 3, size, -length(chance, _BEHIND))
    return _Parts(sensors, links[:1], links[1:], (_hand(chance, size),))


def _person(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, 1)
    own = _mounted_on_a_box(chance, sensors)
    gap, shift = length(chance, _GAPS), _shift(chance, size)
    return _Parts(sensors, own, (), _connected(person(chance, "person", gap, shift), chance))


def _robot(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, chance.choice((1, 2, 3)))
    links = chain(chance, chance.choice((2, 3, 4, 5)), size, -length(chance, _BEHIND))
    hand = _hand(chance, size)
    beside = max(farthest(hand, 0), size) + length(chance, (0.02, 0.3))
    folded = Cuboid((0.08, 0.08, length(chance, (0.1, 0.5))))
    pose = Pose(_rounded((beside + 0.04, 0.0, folded.size[2] / 2)))
    second = Object("folded link", folded, pose=pose)
    others = (*links[1:], second) if chance.random() < 0.5 else links[1:]
    return _Parts(sensors, links[:1], others, _connected((hand,), chance))


def _transmit(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, chance.choice((2, 3)))
    own = chain(chance, 1, size, -length(chance, _BEHIND))
    return _Parts(sensors, own, (), _connected((_hand(chance, size),), chance))


_DRAWN: dict[str, Callable[[random.Random], _Parts]] = {
    HOUSING: _housing,
    TABLE: _table,
    ARM: _arm,
    PERSON: _person,
    ROBOT: _robot,
    TRANSMIT: _transmit,
}


def _sensors(chance: random.Random, count: int) -> tuple[tuple[Sensor, ...], float]:
    """Draws equal sensors side by side along x, centred at the origin, in a random order; and the size of the rectangle around them."""
    width, depth = (length(chance, _SIDES) for _ in range(2))
    step = width + length(chance, _ASIDE)
    starts = [round((place - (count - 1) / 2) * step - width / 2, 5) for place in range(count)]
    chance.shuffle(starts)
    edges = (width, 0.0, 0.0), (0.0, depth, 0.0)
    plates = [Plate((start, -depth / 2, 0.0), *edges) for start in starts]
    sensors = tuple(Sensor(f"sensor {number}", (plate,)) for number, plate in enumerate(plates, start=1))
    return sensors, math.sqrt(((count - 1) * step + width) * depth)


def _mounted_on_a_box(chance: random.Random, sensors: tuple[Sensor, ...]) -> tuple[Object, ...]:
    """Draws the grounded box below one sensor."""
    (plate,) = sensors[0].plates
    width, depth = plate.edge_u[0], plate.edge_v[1]
    along, across = (round(chance.uniform(1.1, 3) * side, DIGITS) for side in (width, depth))
    thick = length(chance, (0.01, 0.2))
    below = length(chance, _BEHIND)
    pose = Pose((0.0, 0.0, -round(below + thick / 2, 5)))
    return (Object("housing", Cuboid((along, across, thick)), pose=pose),)


def _hand(chance: random.Random, size: float) -> Object:
    return hand(chance, "hand", length(chance, _GAPS), _shift(chance, size))


def _shift(chance: random.Random, size: float) -> tuple[float, float]:
    x, y = (round(_SHIFT * size * chance.uniform(-1, 1), DIGITS) for _ in range(2))
    return x, y


def _connected(targets: tuple[Object, ...], chance: random.Random) -> tuple[Object, ...]:
    """Grounds the targets, or lets them float with a capacitance to the ground, each in half of the cases."""
    if chance.random() < 0.5:
        return targets
    to_ground = chance.choice(_TO_GROUND)
    return tuple(replace(body, potential=FLOATING, to_ground=to_ground) for body in targets)
