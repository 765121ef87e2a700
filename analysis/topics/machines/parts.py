"""The model's error in the change of a reading on a machine, as a sum of named parts. Definitions: MACHINES.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from itertools import combinations

from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.results.table import DELTA_SELF
from analysis.topics.errors.parts import PARTS, QUANTITY, REST, Part, Split, Truth, parts, shares
from analysis.topics.machines.set_ups import SetUp
from geometries.scene.scene import Object, Scene, Sensor
from geometries.studies.families import GROUNDED

OWN, OTHERS, SENSORS, MERGED, GROUNDING = (
    "the machine behind the sensor",
    "other bodies",
    "other sensors",
    "target of several bodies",
    "the target's grounding",
)
COMPANY = (OWN, OTHERS, SENSORS, MERGED, GROUNDING)
"""What a model of pairs neglects, each a difference between true changes."""
TURNED_AWAY = "faces turned away"
NOT_KNOWN = "no model of readings between sensors"
"""The change by sensors and target by themselves, of which the plain model gives nothing if it is between two sensors."""
ALL_PARTS = (*COMPANY, NOT_KNOWN, TURNED_AWAY, *PARTS[DELTA_SELF])
"""Every part, in the order in which they are shown. Those after COMPANY are of sensor and target by themselves: for a plate the parts of `errors`,
for any other target the faces turned away, another quantity and the rest, and for a reading between sensors that it is not known."""


@dataclass(frozen=True)
class OnMachine:
    """The true changes (F) of a set-up for each choice of what is included, by the names of that in the order of COMPANY."""

    changes: dict[tuple[str, ...], Estimate]

    @staticmethod
    def read(documents: Iterable[Document]) -> OnMachine:
        """Reads what `documents` returns."""
        changes = {tuple(each["included"]): Estimate(each["value"], each["error"]) for each in documents}
        return OnMachine(changes)

    def documents(self) -> list[Document]:
        """Returns the changes as they are stored."""
        return [{"included": list(chosen), **asdict(value)} for chosen, value in self.changes.items()]

    @property
    def included(self) -> tuple[str, ...]:
        """What there is to include."""
        return max(self.changes, key=len)

    @property
    def full(self) -> Estimate:
        return self.changes[self.included]

    @property
    def alone(self) -> Estimate:
        """The change with nothing included: by what is sensed and driven and the target by themselves."""
        return self.changes[()]

    def company(self) -> dict[str, Part]:
        """Returns by how much each thing lowers the change, in the mean over all orders of including them (F); 0 for what is not there."""

        def change(chosen: frozenset[str]) -> float:
            return self.changes[tuple(name for name in COMPANY if name in chosen)].value

        found = shares(self.included, change)
        return {name: found.get(name, Part(0.0, 0.0, 0.0)) for name in COMPANY}


@dataclass(frozen=True)
class Pairs:
    """Sensor and target by themselves: the truth for each body of the target, grounded and alone with the sensor, and the model's change (F) with
    all triangles and with those that face the sensor. `split` is that of one plate before another, else None.
    """

    truths: tuple[Truth, ...]
    every: float
    facing: float
    split: Split | None

    @property
    def delta_self(self) -> Estimate:
        """The sum of the true changes."""
        return added(truth.delta_self for truth in self.truths)

    @staticmethod
    def read(document: Document) -> Pairs:
        """Reads a stored answer."""
        apart = Split.read(document["split"]) if document["split"] else None
        truths = tuple(map(Truth.read, document["truths"]))
        return Pairs(truths, document["every"], document["facing"], apart)

    def parts(self) -> dict[str, float]:
        """Returns the parts (F) of the model's change minus the sum of the true ones, which add up to it."""
        if self.split is not None:
            return parts(self.split, self.truths[0], DELTA_SELF)
        mutual = added(truth.mutual for truth in self.truths).value
        away, quantity = self.every - self.facing, mutual - self.delta_self.value
        return {TURNED_AWAY: away, QUANTITY: quantity, REST: self.facing - mutual}


def added(values: Iterable[Estimate]) -> Estimate:
    """Adds values of different solutions; their errors may have the same sign, so that the sizes are added."""
    every = list(values)
    return Estimate(sum(each.value for each in every), sum(each.error for each in every))


def included(set_up: SetUp) -> tuple[str, ...]:
    """Returns what a model of pairs neglects in a set-up, in the order of COMPANY."""
    there = {
        OWN: bool(set_up.own),
        OTHERS: bool(set_up.others),
        SENSORS: len(set_up.scene.sensors) > len(_used(set_up.scene)),
        MERGED: len(set_up.targets) > 1,
        GROUNDING: any(body.potential != GROUNDED for body in set_up.targets),
    }
    return tuple(name for name in COMPANY if there[name])


def choices(set_up: SetUp) -> Iterator[tuple[str, ...]]:
    """Yields every choice of what is included, from nothing to all."""
    names = included(set_up)
    for count in range(len(names) + 1):
        yield from combinations(names, count)


def scenes(set_up: SetUp, chosen: tuple[str, ...]) -> list[Scene]:
    """Returns the scenes whose changes add up to that of a choice: one, or one for each body of the target if MERGED is not chosen."""
    whole = set_up.scene
    kept = (set_up.own if OWN in chosen else ()) + (set_up.others if OTHERS in chosen else ())
    machine = tuple(body for body in whole.objects if not body.target and body.name in kept)
    targets = set_up.targets if GROUNDING in chosen else grounded(set_up.targets)
    groups = [targets] if MERGED in chosen else [(body,) for body in targets]
    sensors = whole.sensors if SENSORS in chosen else _used(whole)
    return [replace(whole, sensors=sensors, objects=(*group, *machine)) for group in groups]


def _used(scene: Scene) -> tuple[Sensor, ...]:
    """Returns the sensors that the reading senses or drives."""
    (reading,) = scene.readings
    return tuple(sensor for sensor in scene.sensors if sensor.name in (reading.sense, *reading.drive))


def grounded(bodies: tuple[Object, ...]) -> tuple[Object, ...]:
    """Returns the same bodies connected to the ground."""
    return tuple(replace(body, potential=GROUNDED, to_ground=0.0) for body in bodies)
