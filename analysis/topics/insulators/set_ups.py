"""The set-ups of Experiment VIII: a sensor and a hand with an insulator between, and the same without it. Metres, farads.

The sensor's plate is centred in the plane z = 0 and looks in the direction of +z. Half of the covered sensors have a grounded housing behind.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

from analysis.pipeline.set_up_stages import OfScene
from analysis.topics.draw import DIGITS, between, length, logarithmic
from geometries.scene.covers import covers
from geometries.scene.poses import Pose, Vector3
from geometries.scene.scene import Object, Plate, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid

COVER, FILM, MATTRESS, BLANKET, TARGET = "cover", "wet film", "mattress", "blanket", "insulating target"
COUNTS = {COVER: 70, FILM: 30, MATTRESS: 30, BLANKET: 30, TARGET: 50}
"""Families and how many set-ups each has."""
SENSOR, HAND, READING = "sensor", "hand", "reading"
FILM_THICKNESS, FILM_PERMITTIVITY = 0.5e-3, 80.0

_SEEDS = {COVER: 81, FILM: 82, MATTRESS: 83, BLANKET: 84, TARGET: 85}
_SIDES, _GAPS = (0.04, 0.15), (0.01, 0.15)
_HAND: tuple[tuple[float, float], ...] = ((0.06, 0.12), (0.08, 0.2), (0.015, 0.04))
_SHIFT = 0.4
"""Largest shift of the hand to the side, relative to the sensor's size."""


@dataclass(frozen=True)
class SetUp(OfScene):
    """A scene with the insulator (relative permittivity, thickness in m) and the one without it.

    `gap` (m) is from the plate to the hand. Without the insulator an insulating target is a grounded one.
    """

    family: str
    number: int
    permittivity: float
    thickness: float
    gap: float
    size: float
    without: Scene

    @property
    def shift(self) -> float:
        """How far the layer rule moves the plate (m)."""
        return self.thickness * (1 - 1 / self.permittivity)

    @property
    def name(self) -> str:
        """The set-up in words."""
        return f"{self.family} {self.number}"


@dataclass(frozen=True)
class _Parts:
    """The insulator, and the bodies before it is there and with it."""

    permittivity: float
    thickness: float
    gap: float
    without: tuple[Object, ...]
    objects: tuple[Object, ...]


@cache
def all_set_ups() -> tuple[SetUp, ...]:
    """Returns every set-up, family by family."""
    return tuple(each for family in COUNTS for each in _of_family(family))


def _of_family(family: str) -> Iterator[SetUp]:
    """Draws a family. Python promises that the generator's numbers stay the same."""
    chance = random.Random(_SEEDS[family])
    for number in range(1, COUNTS[family] + 1):
        width, depth = (length(chance, _SIDES) for _ in range(2))
        plate = Plate((-width / 2, -depth / 2, 0.0), (width, 0.0, 0.0), (0.0, depth, 0.0))
        sensor = Sensor(SENSOR, (plate,))
        parts = _DRAWN[family](chance, sensor)
        behind = _housing(chance, sensor) if family in (COVER, FILM) and number % 2 == 0 else ()
        scene = Scene(sensors=(sensor,), readings=(Reading(READING, SENSOR, (SENSOR,)),))
        # Readers put covers first.
        objects = sorted((*behind, *parts.objects), key=lambda body: body.conductor != SENSOR)
        yield SetUp(
            family=family,
            number=number,
            permittivity=parts.permittivity,
            thickness=parts.thickness,
            gap=parts.gap,
            size=round(math.sqrt(width * depth), 6),
            scene=replace(scene, objects=tuple(objects)),
            without=replace(scene, objects=(*behind, *parts.without)),
        )


def _covered(chance: random.Random, sensor: Sensor, thickness: float, permittivity: float) -> _Parts:
    gap = round(thickness + length(chance, _GAPS), DIGITS)
    hand = (_hand(chance, sensor, gap),)
    return _Parts(permittivity, thickness, gap, hand, (*covers(sensor, thickness, permittivity), *hand))


def _cover(chance: random.Random, sensor: Sensor) -> _Parts:
    return _covered(chance, sensor, length(chance, (0.5e-3, 10e-3)), round(chance.uniform(2, 6), 1))


def _film(chance: random.Random, sensor: Sensor) -> _Parts:
    return _covered(chance, sensor, FILM_THICKNESS, FILM_PERMITTIVITY)


def _mattress(chance: random.Random, sensor: Sensor) -> _Parts:
    thickness, permittivity = length(chance, (0.03, 0.12)), round(chance.uniform(1.05, 2), 2)
    below, above = (length(chance, (0.001, 0.01)) for _ in range(2))
    sides = [round(3 * edge, DIGITS) for edge in (sensor.plates[0].edge_u[0], sensor.plates[0].edge_v[1])]
    slab = _box("mattress", (sides[0], sides[1], thickness), (0.0, 0.0), below, permittivity)
    gap = round(below + thickness + above, DIGITS)
    hand = (_hand(chance, sensor, gap),)
    return _Parts(permittivity, thickness, gap, hand, (slab, *hand))


def _blanket(chance: random.Random, sensor: Sensor) -> _Parts:
    thickness, permittivity = length(chance, (0.002, 0.01)), round(chance.uniform(1.2, 2.5), 1)
    gap = round(thickness + length(chance, _GAPS), DIGITS)
    hand = _hand(chance, sensor, gap)
    assert isinstance(hand.shape, Cuboid)
    width, depth = (round(1.5 * side, DIGITS) for side in hand.shape.size[:2])
    x, y, _ = hand.pose.translation
    low = round(gap - thickness, DIGITS)
    layer = replace(_box("blanket", (width, depth, thickness), (x, y), low, permittivity), target=True)
    return _Parts(permittivity, thickness, gap, (hand,), (layer, hand))


def _target(chance: random.Random, sensor: Sensor) -> _Parts:
    gap = length(chance, _GAPS)
    hand = _hand(chance, sensor, gap)
    assert isinstance(hand.shape, Cuboid)
    permittivity = round(logarithmic(chance, (2, 80)), 1)
    insulating = replace(hand, relative_permittivity=permittivity)
    return _Parts(permittivity, hand.shape.size[2], gap, (hand,), (insulating,))


_DRAWN: dict[str, Callable[[random.Random, Sensor], _Parts]] = {
    COVER: _cover,
    FILM: _film,
    MATTRESS: _mattress,
    BLANKET: _blanket,
    TARGET: _target,
}


def _hand(chance: random.Random, sensor: Sensor, gap: float) -> Object:
    (plate,) = sensor.plates
    width, depth, height = (between(chance, ends) for ends in _HAND)
    x, y = (
        round(_SHIFT * edge * chance.uniform(-1, 1), DIGITS) for edge in (plate.edge_u[0], plate.edge_v[1])
    )
    return replace(_box(HAND, (width, depth, height), (x, y), gap, None), target=True)


def _housing(chance: random.Random, sensor: Sensor) -> tuple[Object, ...]:
    (plate,) = sensor.plates
    width, depth = (round(1.2 * edge, DIGITS) for edge in (plate.edge_u[0], plate.edge_v[1]))
    below = length(chance, (0.003, 0.03))
    return (_box("housing", (width, depth, 0.05), (0.0, 0.0), round(-below - 0.05, DIGITS), None),)


def _box(
    name: str, size: Vector3, centre: tuple[float, float], low: float, permittivity: float | None
) -> Object:
    """Returns a box whose lowest points are at z = `low`."""
    pose = Pose((*centre, round(low + size[2] / 2, 6)))
    return Object(name, Cuboid(size), pose=pose, relative_permittivity=permittivity)
