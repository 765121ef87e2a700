"""The set-ups on machines: sensors on a housing, a table, an arm, a robot, and hands or persons before them. Metres, farads.

Definitions of the families: MACHINES.md. The last third of each family is sealed: no rule of the model is chosen by looking at it.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

from analysis.pipeline.set_up_stages import OfScene
from analysis.topics.draw import DIGITS, length
from analysis.topics.machines import bodies
from geometries.scene.poses import Pose
from geometries.scene.scene import Object, Plate, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid
from geometries.studies import machines
from geometries.studies.families import FLOATING

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
    near = bodies.farthest(hand[0], 2) + length(chance, _TABLE_BEHIND)
    table = machines.table(_TABLE, x, y, round(near, DIGITS))
    return _Parts(sensors, _mounted_on_a_box(chance, sensors), (table,), hand)


def _arm(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, 3)
    links = bodies.chain(chance, 3, size, -length(chance, _BEHIND))
    return _Parts(sensors, links[:1], links[1:], (_hand(chance, size),))


def _person(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, 1)
    own = _mounted_on_a_box(chance, sensors)
    gap, shift = length(chance, _GAPS), _shift(chance, size)
    person = bodies.person(chance, "person", gap, shift)
    return _Parts(sensors, own, (), _connected(person, chance))


def _robot(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, chance.choice((1, 2, 3)))
    links = bodies.chain(chance, chance.choice((2, 3, 4, 5)), size, -length(chance, _BEHIND))
    hand = _hand(chance, size)
    beside = max(bodies.farthest(hand, 0), size) + length(chance, (0.02, 0.3))
    folded = Cuboid((0.08, 0.08, length(chance, (0.1, 0.5))))
    second = Object(
        "folded link",
        folded,
        pose=Pose((round(beside + 0.04, DIGITS), 0.0, round(folded.size[2] / 2, DIGITS))),
    )
    others = (*links[1:], second) if chance.random() < 0.5 else links[1:]
    return _Parts(sensors, links[:1], others, _connected((hand,), chance))


def _transmit(chance: random.Random) -> _Parts:
    sensors, size = _sensors(chance, chance.choice((2, 3)))
    own = bodies.chain(chance, 1, size, -length(chance, _BEHIND))
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
    sensors = tuple(
        Sensor(f"sensor {number}", (Plate((start, -depth / 2, 0.0), *edges),))
        for number, start in enumerate(starts, start=1)
    )
    return sensors, math.sqrt(((count - 1) * step + width) * depth)


def _mounted_on_a_box(chance: random.Random, sensors: tuple[Sensor, ...]) -> tuple[Object, ...]:
    """Draws the grounded box below one sensor."""
    (plate,) = sensors[0].plates
    width, depth = plate.edge_u[0], plate.edge_v[1]
    along, across = (round(chance.uniform(1.1, 3) * side, DIGITS) for side in (width, depth))
    thick = length(chance, (0.01, 0.2))
    below = length(chance, _BEHIND)
    return (
        Object(
            "housing", Cuboid((along, across, thick)), pose=Pose((0.0, 0.0, -round(below + thick / 2, 5)))
        ),
    )


def _hand(chance: random.Random, size: float) -> Object:
    gap = length(chance, _GAPS)
    return bodies.hand(chance, "hand", gap, _shift(chance, size))


def _shift(chance: random.Random, size: float) -> tuple[float, float]:
    x, y = (round(_SHIFT * size * chance.uniform(-1, 1), DIGITS) for _ in range(2))
    return x, y


def _connected(targets: tuple[Object, ...], chance: random.Random) -> tuple[Object, ...]:
    """Grounds the targets, or lets them float with a capacitance to the ground, each in half of the cases."""
    if chance.random() < 0.5:
        return targets
    to_ground = chance.choice(_TO_GROUND)
    return tuple(replace(body, potential=FLOATING, to_ground=to_ground) for body in targets)
