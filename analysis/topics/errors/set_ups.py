"""The set-ups of the error study with their truth and the parts of their error: three
maps, the default study's pairs of plates, and random poses. Metres, degrees."""

import random
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import OfScene, SetUpStages
from analysis.results.answers import Estimate
from analysis.results.set_up import describe, rectangles
from analysis.results.statistics import Spread, spread
from analysis.results.store import Document
from analysis.results.study_results import Results
from analysis.results.table import MUTUAL
from analysis.results.units import in_words
from analysis.topics.draw import logarithmic, rotation
from analysis.topics.errors import parts
from analysis.topics.errors.parts import Split, Truth
from geometries.scene.poses import Pose
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import PlateShape
from geometries.studies import families, study
from geometries.studies.study import Parameter

SIZE_MAP, TILT_MAP, OFFSET_MAP = "size map", "tilt map", "offset map"
MAPS = (SIZE_MAP, TILT_MAP, OFFSET_MAP)
DEFAULT, RANDOM = "default study", "random poses"

SIDE = 0.1
"""The sensor's sides (m) in the maps."""
_RATIOS = (0.2, 0.35, 0.6, 1.0, 1.6, 2.5, 4.0)
_GAPS = (0.03, 0.06, 0.12, 0.25, 0.5, 1.0, 2.0)
_TILTS = (0.0, 10.0, 20.0, 35.0, 50.0, 70.0, 90.0)
_OFFSETS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.25, 1.5, 2.0)
_RANDOM_COUNT, _SEED = 160, 6
# Range of the random plates' sides (m), and their least distance relative to the smallest side.
_SIDES, _CLOSEST = (0.02, 0.3), 0.02
_SHORT = 4
"""Digits of an identity that distinguish some hundred set-ups for a reader."""
_REACH = 0.15
"""Largest distance (m), along every axis, of a random target's centre from the sensor's."""


@dataclass(frozen=True)
class SetUp(OfScene):
    """One sensor plate and one target plate. `place` is the place on its map: gap over the sensor's size, and the other axis'
    value; None off the maps."""

    group: str
    family: str
    parameters: dict[str, Parameter]
    place: tuple[float, float] | None

    @property
    def name(self) -> str:
        """The set-up in words. Random poses have nothing but their number."""
        words = in_words(self.parameters) or self.id[:_SHORT]
        return f"{self.group}: {words}"


@cache
def all_set_ups() -> tuple[SetUp, ...]:
    """Returns every set-up, in the order of its groups. A set-up on two maps appears in both."""
    square = (SIDE, SIDE)
    found: list[SetUp] = []
    for gap in _GAPS:
        for ratio in _RATIOS:
            target = (ratio * SIDE, ratio * SIDE)
            found.append(_on_map(SIZE_MAP, (gap, ratio), families.parallel, square, target, gap * SIDE))
        for tilt in _TILTS:
            found.append(_on_map(TILT_MAP, (gap, tilt), families.inclined, square, square, gap * SIDE, tilt))
        for offset in _OFFSETS:
            values = (square, square, gap * SIDE, (offset * SIDE, 0.0))
            found.append(_on_map(OFFSET_MAP, (gap, offset), families.parallel, *values))
    found += [
        SetUp(case.scene, DEFAULT, case.family, case.parameters, None)
        for case in study.load(study.find("default")).sweeps
        if describe(case.scene) is not None
    ]
    found += [SetUp(scene, RANDOM, "random", {}, None) for scene in _random_scenes()]
    return tuple(sorted(found, key=lambda each: (*MAPS, DEFAULT, RANDOM).index(each.group)))


def _on_map(
    group: str, place: tuple[float, float], family: Callable[..., Scene], *values: Parameter
) -> SetUp:
    names = family.__code__.co_varnames
    return SetUp(family(*values), group, family.__name__, dict(zip(names, values)), place)


def _random_scenes() -> Iterator[Scene]:
    """Draws plates of any shape and orientation before or beside the sensor, at least a fraction of the smallest side away.
    Python promises that the generator's numbers stay the same."""
    chance, made = random.Random(_SEED), 0
    while made < _RANDOM_COUNT:
        sensor, target = ((logarithmic(chance, _SIDES), logarithmic(chance, _SIDES)) for _ in range(2))
        centre = tuple(_REACH * chance.uniform(least, 1) for least in (-1, -1, 0))
        shape = PlateShape(target)
        pose = Pose((centre[0], centre[1], centre[2]), rotation(chance))
        scene = replace(families.empty(sensor), objects=(Object("target", shape, pose=pose),))
        described = describe(scene)
        if described is not None and described.gap > _CLOSEST * min(*sensor, *target):
            made += 1
            yield scene


RTOL = 1e-4
"""Relative accuracy asked of boundary elements: far below the parts, which matter from a per cent on."""
_SOURCES = ("topics/errors/parts.py", "topics/errors/set_ups.py", "results/set_up.py")
# Expected seconds, the same for all set-ups: the run time cannot be predicted.
_SECONDS = 0.5


def answer(set_up: SetUp, scene: Path) -> Document:
    """Computes the truth with its error, and the parts of the model's error."""
    model = model_stage.model_module()
    plates = rectangles(set_up.scene)
    assert plates is not None
    solved = model.Scene.load(str(scene)).maxwell(rtol=RTOL)
    return {
        "reached": bool(solved["reached"]),
        "seconds": float(solved["seconds"]),
        "truth": asdict(Truth.of(solved, set_up.scene.sensors[0].name)),
        "split": asdict(parts.split(model, *plates)),
    }


STAGES = SetUpStages[SetUp](
    name="errors",
    what="set-ups taken apart",
    rtol=RTOL,
    sources=tuple(f"analysis/{source}" for source in _SOURCES),
    seconds=lambda _: _SECONDS,
    answer=answer,
)


@dataclass(frozen=True, eq=False)
class Entry:
    """A set-up with the parts of its error; `reached` tells whether the truth is as accurate as asked."""

    set_up: SetUp
    truth: Truth
    split: Split
    reached: bool

    def true(self, quantity: str) -> Estimate:
        return self.truth.mutual if quantity == MUTUAL else self.truth.delta_self

    def error(self, quantity: str) -> float:
        """Returns (model − truth)/truth."""
        return self.split.model / self.true(quantity).value - 1

    def parts(self, quantity: str) -> dict[str, float]:
        """Returns the parts of the relative error, which add up to it."""
        value = self.true(quantity).value
        return {name: part / value for name, part in parts.parts(self.split, self.truth, quantity).items()}

    def uncertainty(self, quantity: str) -> float:
        """Returns the largest uncertainty of any part, relative to the truth."""
        most = max(parts.uncertainty(self.split, self.truth, name) for name in parts.PARTS[quantity])
        return most / self.true(quantity).value

    def spread(self, name: str, quantity: str) -> float:
        """Returns the spread of an effect's part over the orders of correction, relative to the truth."""
        part = self.split.effects.get(name)
        return 0.0 if part is None else (part.greatest - part.least) / self.true(quantity).value

    def largest(self, quantity: str) -> str:
        """Returns the name of the largest part."""
        found = self.parts(quantity)
        return max(found, key=lambda name: abs(found[name]))


@dataclass(frozen=True)
class Statistics:
    """One part over set-ups, relative to each truth. `largest_in` counts where it is the greatest part, `size_there` is its median
    size among them (0 without any); `between_orders` is the median difference between the orders."""

    name: str
    spread: Spread
    mean: float
    worst_case: SetUp
    largest_in: int
    size_there: float
    between_orders: float


def once(found: list[Entry]) -> list[Entry]:
    """Removes repeated set-ups."""
    return list({entry.set_up.id: entry for entry in found}.values())


def statistics(found: list[Entry], quantity: str) -> list[Statistics]:
    """Computes the statistics of each part over at least one set-up."""
    return [_of_part(name, found, quantity) for name in parts.PARTS[quantity]]


def _of_part(name: str, found: list[Entry], quantity: str) -> Statistics:
    values = [entry.parts(quantity)[name] for entry in found]
    there = [abs(value) for entry, value in zip(found, values) if entry.largest(quantity) == name]
    of_all = spread(values)
    assert of_all is not None
    worst = found[int(np.argmax(np.abs(values)))].set_up
    size_there = float(np.median(there)) if there else 0.0
    between_orders = float(np.median([entry.spread(name, quantity) for entry in found]))
    return Statistics(name, of_all, float(np.mean(values)), worst, len(there), size_there, between_orders)


def by_reference(found: list[Entry], results: Results) -> list[tuple[Entry, Entry]]:
    """Pairs the entry of each set-up that a study has solved too with the same entry under the field solver's truth."""
    pairs = []
    for entry in once(found):
        case = results.cases.get(entry.set_up.id)
        if case is not None and (answer := case.reference) is not None:
            sensor, target = answer.conductors
            own = answer.delta_self[sensor], answer.self_capacitance(target)
            truth = Truth(answer.mutual(sensor, target), *own)
            pairs.append((entry, replace(entry, truth=truth, reached=answer.reached)))
    return pairs


def entry(set_up: SetUp, document: Document) -> Entry:
    """Returns a set-up with its answer; one on two maps appears twice among the entries."""
    return Entry(set_up, Truth.read(document["truth"]), Split.read(document["split"]), document["reached"])
