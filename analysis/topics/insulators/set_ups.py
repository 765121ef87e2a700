"""The set-ups of Experiment VIII: a sensor and a hand with an insulator between, and the same without it. Metres, farads.

The sensor's plate is centred in the plane z = 0 and looks in the direction of +z. Half of the covered sensors have a grounded housing behind.

True readings by boundary elements are stored: `python3 -m analysis measure truths insulators`, a quarter of an hour. So are the field solver's readings of some:
`python3 -m analysis measure field-check insulators`, minutes for each set-up. The hand of each is moved to the sensor's axis, so that the field solver meshes a
quarter of space only."""

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import OfScene, SetUpStages
from analysis.results.answers import Estimate, ReadingAnswer
from analysis.results.store import Document
from analysis.topics import stored
from analysis.topics.draw import DIGITS, between, length, logarithmic
from geometries.scene.covers import covers
from geometries.scene.poses import Pose, Vector3
from geometries.scene.scene import Object, Plate, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid
from geometries.scene.writer import canonical

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
    """A scene with the insulator (relative permittivity, thickness in m) and the one without it. `gap` (m) is
    from the plate to the hand. Without the insulator an insulating target is a grounded one."""

    family: str
    number: int
    permittivity: float
    thickness: float
    gap: float
    size: float
    without: Scene

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
        scenes = replace(scene, objects=tuple(objects)), replace(scene, objects=(*behind, *parts.without))
        size = round(math.sqrt(width * depth), 6)
        numbers = parts.permittivity, parts.thickness, parts.gap, size
        yield SetUp(scenes[0], family, number, *numbers, scenes[1])


def _covered(chance: random.Random, sensor: Sensor, thickness: float, permittivity: float) -> _Parts:
    gap = round(thickness + length(chance, _GAPS), DIGITS)
    hand = (_hand(chance, sensor, gap),)
    return _Parts(permittivity, thickness, gap, hand, (*covers(sensor, thickness, permittivity), *hand))


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
    COVER: lambda chance, sensor: _covered(
        chance, sensor, length(chance, (0.5e-3, 10e-3)), round(chance.uniform(2, 6), 1)
    ),
    FILM: lambda chance, sensor: _covered(chance, sensor, FILM_THICKNESS, FILM_PERMITTIVITY),
    MATTRESS: _mattress,
    BLANKET: _blanket,
    TARGET: _target,
}


def _hand(chance: random.Random, sensor: Sensor, gap: float) -> Object:
    (plate,) = sensor.plates
    width, depth, height = (between(chance, ends) for ends in _HAND)
    sides = plate.edge_u[0], plate.edge_v[1]
    x, y = (round(_SHIFT * side * chance.uniform(-1, 1), DIGITS) for side in sides)
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


RTOL = 5e-2
"""Relative accuracy asked of every entry of the Maxwell matrix and of the reading's change."""
RTOL_OF_LAYERS = 3e-2
"""The same of covers and films, by which the layer rule is measured."""
_DESCRIPTION = (
    "Readings (F) of set-ups with insulators by boundary elements, by the hash of the scene, with stated errors: value without the target and change "
    "by it; with the insulator and without. Made by python3 -m analysis measure truths insulators."
)


@dataclass(frozen=True)
class Truth:
    """The reading without the target, and its change by the target."""

    background: Estimate
    change: Estimate


@dataclass(frozen=True)
class Truths:
    """A set-up's truth with the insulator and without it."""

    insulated: Truth
    without: Truth


@cache
def load() -> dict[str, Truths]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    return {identity: read(record) for identity, record in STORED.records().items()}


def solved(model: Any, set_up: SetUp) -> Truths:
    """Solves a set-up with the insulator and without it. `model` is the model's module."""
    rtol = RTOL_OF_LAYERS if set_up.family in (COVER, FILM) else RTOL
    return Truths(_solved(model, set_up.scene, rtol), _solved(model, set_up.without, rtol))


def _solved(model: Any, scene: Scene, rtol: float) -> Truth:
    (reading,) = model.Scene.loads(canonical(scene)).maxwell(rtol=rtol)["readings"]
    found = ReadingAnswer.of(reading)
    return Truth(found.background, found.change)


def read(record: Document) -> Truths:
    """Reads stored truths."""
    parts = {place: {key: Estimate(**each) for key, each in own.items()} for place, own in record.items()}
    return Truths(Truth(**parts["insulated"]), Truth(**parts["without"]))


STORED = stored.Stored[SetUp](
    file=Path(__file__).with_name("truths.json"),
    description=_DESCRIPTION,
    chosen=all_set_ups,
    solve=lambda each: stored.rounded(asdict(solved(model_stage.model_module(), each))),
)

REDUCED, IGNORING = "reduced", "reduced without the layer"

_RTOL = 0.1
"""Relative error asked of the reduced method, which then prepares a set-up in less than a second."""
_SECONDS = 0.3


def answer(set_up: SetUp, _: Path) -> Document:
    """Computes the model's changes (F) of the reading beside the true ones, which are solved only if they are not stored."""
    model = model_stage.model_module()
    true = load().get(set_up.identity) or solved(model, set_up)
    changes = {IGNORING: _change(model, set_up.without)}
    # A dielectric body of the machine takes the reduced method longer to prepare than boundary elements take.
    is_slow = set_up.family == MATTRESS
    changes[REDUCED] = {"refused": "left to boundary elements"} if is_slow else _change(model, set_up.scene)
    return {"truths": asdict(true), "changes": changes}


def _change(model: Any, scene: Scene) -> Document:
    try:
        reading = model.Scene.loads(canonical(scene)).readings(method=REDUCED, rtol=_RTOL)[READING]
    except ValueError as error:
        return {"refused": str(error)}
    if reading.error["change"] is None:
        return {"refused": "its error is not known"}
    return {"value": float(reading.change), "error": float(reading.error["change"])}


STAGES = SetUpStages[SetUp](
    name="insulators",
    what="set-ups with insulators",
    rtol=RTOL,
    sources=tuple(f"analysis/topics/insulators/{name}" for name in ("set_ups.py", "truths.json")),
    seconds=lambda _: _SECONDS,
    answer=answer,
)

RTOL_OF_CHECKS = 1e-2
"""Relative accuracy asked of both methods."""
_DESCRIPTION_OF_CHECKS = (
    "Readings (F) of set-ups of Experiment VIII, their hands on the sensors' axes, by the field solver and by boundary elements asked for 1e-2, by the hash "
    "of the scene, with stated errors. Made by python3 -m analysis measure field-check insulators."
)


@cache
def chosen() -> tuple[SetUp, ...]:
    """Returns the insulating targets, covers and films with their hands on the axis: those first that take the fewest cells."""
    found = [centred(each) for each in all_set_ups() if each.family in (COVER, FILM, TARGET)]
    return tuple(sorted(found, key=lambda each: each.size / each.thickness))


def centred(set_up: SetUp) -> SetUp:
    """Returns the set-up with its hand on the sensor's axis, with the insulator only."""
    moved = tuple(
        replace(body, pose=replace(body.pose, translation=(0.0, 0.0, body.pose.translation[2])))
        for body in set_up.scene.objects
    )
    return replace(set_up, scene=replace(set_up.scene, objects=moved))


def checked(set_up: SetUp) -> Document:
    """Solves a set-up by both methods; NoAnswer if the field solver has none."""
    asked = ("--columns", set_up.scene.sensors[0].name, "--rtol", repr(RTOL_OF_CHECKS))
    reading, document = stored.solved(set_up, *asked)
    return {
        "field": stored.rounded(stored.quantities_of(reading)),
        "seconds": round(document["seconds"], 1),
        "unknowns": document["unknowns"],
        **by_boundary_elements(set_up),
    }


def solve_again() -> int:
    """Solves the set-ups that have a record anew by boundary elements; returns how many."""
    kept = CHECK.records()
    recorded = [each for each in chosen() if each.identity in kept]
    for each in recorded:
        kept[each.identity] |= by_boundary_elements(each)
        CHECK.write(kept)
    return len(recorded)


def by_boundary_elements(set_up: SetUp) -> Document:
    """Returns what a record has of a set-up by boundary elements."""
    scene = model_stage.model_module().Scene.loads(set_up.text)
    return {"boundary": stored.rounded(stored.by_boundary_elements(scene, READING, RTOL_OF_CHECKS))}


CHECK = stored.FieldCheck[SetUp](
    file=Path(__file__).with_name("field_checks.json"),
    description=_DESCRIPTION_OF_CHECKS,
    chosen=chosen,
    solve=checked,
    kind=lambda each: each.family,
    described=(("set-up", lambda each: each.name),),
    explanation="The hands are moved to the sensors' axes, where the field solver meshes a quarter of space.",
    both=True,
)
