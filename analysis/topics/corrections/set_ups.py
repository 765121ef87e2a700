"""The set-ups for fitting and testing corrections: plates and boxes before one rectangular sensor, drawn with a fixed seed; the methods' estimates of all of them with
their errors, and the tables of errors in model/CORRECTIONS.md: `python3 -m analysis measure corrections`.

A third of them is sealed for testing. The rule depends on the name alone, and the names are older than any correction."""

import argparse
import hashlib
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.pipeline.model_stage import model_module, options
from analysis.pipeline.set_up_stages import OfScene
from analysis.results.statistics import grouped
from analysis.results.store import Document
from analysis.results.units import percent
from analysis.topics.stored import Stored, rounded
from geometries.common.errors import InputError
from geometries.common.installation import ROOT
from geometries.scene.poses import Pose, QuaternionRotation
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import Cuboid, PlateShape
from geometries.studies import families

SEED = 20240611
COUNTS = {"parallel": 80, "inclined": 50, "edge": 50, "corner": 50, "straddle": 60, "plates": 90, "boxes": 70}

# Lengths in metres: the thesis' sensor, its half, strips.
_SENSORS = ((0.1, 0.1), (0.1, 0.1), (0.05, 0.05), (0.05, 0.2), (0.08, 0.12))
_SMALLEST, _LARGEST = 0.02, 0.3
_LEAST_GAP, _MOST_GAP = 0.003, 0.2

Draw = np.random.Generator
Vector2 = tuple[float, float]


@dataclass(frozen=True)
class SetUp(OfScene):
    """A scene with one sensor, "sensor", and one object, "target"."""

    family: str
    number: int

    @property
    def name(self) -> str:
        return f"{self.family}-{self.number:03d}"

    @property
    def sealed(self) -> bool:
        """Kept from all fitting: sha256 of the name, as a number, is divisible by three."""
        return int(hashlib.sha256(self.name.encode()).hexdigest(), 16) % 3 == 0


def set_ups(module: Any) -> Iterator[SetUp]:
    """Returns all set-ups in their order. `module` is the model's, which computes the distance of bodies."""
    for index, (family, count) in enumerate(COUNTS.items()):
        draw = np.random.default_rng([SEED, index])
        scenes = (_drawn(family, draw, module) for _ in itertools.count())
        accepted = (scene for scene in scenes if scene is not None)
        for number, scene in enumerate(itertools.islice(accepted, count)):
            yield SetUp(scene, family, number)


def _drawn(family: str, draw: Draw, module: Any) -> Scene | None:
    """Draws one set-up; None if the random numbers give no valid set-up of the family."""
    try:
        if family in _FAMILIES:
            return _FAMILIES[family](draw, _sensor(draw))
        return _posed(draw, module, _shape(family, draw))
    except InputError:
        return None


def _between(draw: Draw, least: float, most: float) -> float:
    """Draws a number uniformly in its logarithm, rounded to a few digits that a person can copy."""
    return float(f"{np.exp(draw.uniform(np.log(least), np.log(most))):.3g}")


def _sensor(draw: Draw) -> Vector2:
    return _SENSORS[draw.integers(len(_SENSORS))]


def _target(draw: Draw, sensor: Vector2) -> Vector2:
    """Draws the target's size; every third target is as large as the sensor."""
    if draw.random() < 1 / 3:
        return sensor
    return _between(draw, _SMALLEST, _LARGEST), _between(draw, _SMALLEST, _LARGEST)


def _degrees(draw: Draw, most: float) -> float:
    return float(np.round(draw.uniform(0, most), 1))


def _gap(draw: Draw) -> float:
    return _between(draw, _LEAST_GAP, _MOST_GAP)


def _edge(draw: Draw, sensor: Vector2) -> Scene:
    target = (_between(draw, _SMALLEST, _LARGEST), _between(draw, _SMALLEST, sensor[1]))
    height = 0.0 if draw.random() < 1 / 3 else _gap(draw)
    return families.edge(sensor, target, _gap(draw), height, _degrees(draw, 90))


def _corner(draw: Draw, sensor: Vector2) -> Scene:
    height = 0.0 if draw.random() < 1 / 3 else _gap(draw)
    gap, target = (_gap(draw), _gap(draw)), _target(draw, sensor)
    return families.corner(sensor, target, gap, height, _degrees(draw, 90), _degrees(draw, 360))


def _straddle(draw: Draw, sensor: Vector2) -> Scene:
    offset = (float(np.round(draw.uniform(-0.1, 0.1), 4)), float(np.round(draw.uniform(-0.1, 0.1), 4)))
    turn = 0.0 if draw.random() < 1 / 3 else _degrees(draw, 360)
    target, gap = _target(draw, sensor), _gap(draw)
    return families.straddle(sensor, target, gap, offset, _degrees(draw, 90) * draw.integers(2), turn)


_FAMILIES: dict[str, Callable[[Draw, Vector2], Scene]] = {
    "parallel": lambda draw, sensor: families.parallel(sensor, _target(draw, sensor), _gap(draw)),
    "inclined": lambda draw, sensor: families.inclined(
        sensor, _target(draw, sensor), _gap(draw), _degrees(draw, 90)
    ),
    "edge": _edge,
    "corner": _corner,
    "straddle": _straddle,
}


def _shape(family: str, draw: Draw) -> PlateShape | Cuboid:
    """Draws a body of the families that pose one anywhere."""
    if family == "plates":
        return PlateShape((_between(draw, _SMALLEST, _LARGEST), _between(draw, _SMALLEST, _LARGEST)))
    x, y, z = (_between(draw, _SMALLEST, 0.2) for _ in range(3))
    return Cuboid((x, y, z))


def _posed(draw: Draw, module: Any, shape: PlateShape | Cuboid) -> Scene | None:
    """Returns the body in any orientation, a third of them as it is, moved along any line towards a point of the sensor up to a gap."""
    alone = families.empty(_sensor(draw))
    rotation = np.array([1.0, 0.0, 0.0, 0.0]) if draw.random() < 1 / 3 else np.round(draw.normal(size=4), 3)
    direction = draw.normal(size=3)
    direction /= np.linalg.norm(direction)
    aim = np.append((draw.random(2) - 0.5) * np.abs(np.asarray(alone.sensors[0].plates[0].corner)[:2]) * 2, 0)
    gap = _gap(draw)
    w, i, j, k = (float(number) for number in rotation)
    turned = QuaternionRotation((w, i, j, k))
    vertices = shape.triangles().reshape(-1, 3) @ turned.matrix().T
    plate = alone.conductors()["sensor"].reshape(-1, 3)

    def distance(along: float) -> float:
        return float(module.gjk_distance(plate, vertices + aim + along * direction)[0])

    near, far = 0.0, 2.0
    if distance(near) >= gap:
        return None
    for _ in range(50):
        middle = (near + far) / 2
        near, far = (middle, far) if distance(middle) < gap else (near, middle)
    x, y, z = (float(value) for value in np.round(aim + far * direction, 6))
    target = Object("target", shape, pose=Pose((x, y, z), turned))
    return Scene(sensors=alone.sensors, objects=(target,))


RTOL = 1e-4
_DESCRIPTION = (
    "Capacitances (F) of the set-ups for fitting and testing corrections by boundary elements, by the hash of the scene, with stated errors. "
    "Made by python3 -m analysis measure truths corrections."
)


@dataclass(frozen=True)
class Truth:
    """Farads: `mutual` with its `error`, the matrix' entry of the sensor, and what this is without the target."""

    mutual: float
    error: float
    sensor: float
    sensor_alone: float


def load() -> dict[str, Truth]:
    """Returns the truths by the identity of their set-up's scene."""
    return {identity: Truth(**record) for identity, record in STORED.records().items()}


def solved(module: Any, set_up: SetUp) -> Truth:
    answer: dict[str, Any] = module.Scene.loads(set_up.text).maxwell(rtol=RTOL)
    matrix, change = answer["maxwell"], answer["delta_self"]["sensor"]["value"]
    return Truth(*map(float, (-matrix[0, 1], answer["error"][0, 1], matrix[0, 0], matrix[0, 0] - change)))


STORED = Stored[SetUp](
    file=Path(__file__).with_name("truths.json"),
    description=_DESCRIPTION,
    chosen=lambda: set_ups(model_module()),
    solve=lambda each: rounded(asdict(solved(model_module(), each))),
)

PLAIN, FORMULA, REDUCED = "exact", "formula", "reduced"
METHODS = (PLAIN, FORMULA, REDUCED)
"""The plain model, and what comes closer."""


def estimate(module: Any) -> list[Document]:
    """Returns every set-up with its scene, its truth and the estimates of `mutual` by every method, as plain data: farads, metres."""
    truths = load()
    return [_estimated(module, set_up, truths) for set_up in set_ups(module)]


def _estimated(module: Any, set_up: SetUp, truths: dict[str, Truth]) -> Document:
    if set_up.identity not in truths:
        again = "python3 -m analysis measure truths corrections makes them anew"
        raise KeyError(f"{set_up.name} has no truth: {again}")
    scene, truth = module.Scene.loads(set_up.text), truths[set_up.identity]
    (plate,), bodies = set_up.scene.sensors[0].plates, set_up.scene.conductors()
    points = [bodies[name].reshape(-1, 3) for name in ("sensor", "target")]
    return {
        "name": set_up.name,
        "family": set_up.family,
        "sealed": set_up.sealed,
        "distance": float(module.gjk_distance(*points)[0]),
        "sensor_size": float(np.sqrt(np.linalg.norm(plate.edge_u) * np.linalg.norm(plate.edge_v))),
        "truth": truth.mutual,
        "error": truth.error,
        "estimates": {
            method: float(scene.capacitance(**options(method))["sensors"][0]["total"]) for method in METHODS
        },
        "scene": set_up.text,
    }


def off(case: Document, method: str) -> float:
    """Returns (estimate − truth)/truth."""
    return float(case["estimates"][method] / case["truth"] - 1)


def evaluations(cases: Sequence[Document]) -> list[Document]:
    """Returns the statistics of each method's errors: of all set-ups, of the sealed third, on which no constant was fitted, and of each
    family."""
    families = grouped(cases, lambda case: str(case["family"]))
    return [
        {
            "name": method,
            "all": errors(cases, method),
            "sealed": errors([case for case in cases if case["sealed"]], method),
            "families": {family: errors(own, method) for family, own in families.items()},
        }
        for method in METHODS
    ]


def errors(cases: Sequence[Document], method: str) -> Document:
    """Returns the statistics of a method's relative errors over some set-ups."""
    size = np.abs([off(case, method) for case in cases])
    return {
        "count": len(size),
        "rms": float(np.sqrt(np.mean(size**2))),
        "median": float(np.median(size)),
        "percentile_95": float(np.quantile(size, 0.95)),
        "worst": float(np.max(size)),
    }


PAGE = ROOT / "model" / "CORRECTIONS.md"
_HEADER = ("| | rms | median | 95 % | worst | sealed rms / worst |", "|---|---|---|---|---|---|")


def errors_table(found: Sequence[Document]) -> list[str]:
    """Returns a row for each method, per cent of the truth."""
    lines = list(_HEADER)
    for each in found:
        cells = (_per_cent(each["all"][what]) for what in ("rms", "median", "percentile_95", "worst"))
        lines.append(f"| `{each['name']}` | {' | '.join(cells)} | {_both(each['sealed'])} |")
    return lines


def by_family(found: Sequence[Document]) -> str:
    """Returns the formula's errors by family."""
    (formula,) = (each for each in found if each["name"] == FORMULA)
    phrases = (f"{family} {_both(errors)}" for family, errors in formula["families"].items())
    return f"The formula by family, rms / worst: {', '.join(phrases)}."


def _both(errors: Document) -> str:
    return f"{_per_cent(errors['rms'])} / {_per_cent(errors['worst'])}"


def _per_cent(value: float) -> str:
    """Returns a number for a column in per cent."""
    return percent(value).removesuffix(" %")


def near_misses(cases: Sequence[Document]) -> int:
    """Counts the set-ups in which the reduced method is off by more than 1 %."""
    return sum(abs(off(case, REDUCED)) > 0.01 for case in cases)


def measure(_: argparse.Namespace) -> None:
    """Prints all lines; takes some seconds."""
    cases = estimate(model_module())
    evaluated = evaluations(cases)
    near = f"{near_misses(cases)} of {len(cases)} set-ups are more than 1 % off by reduced"
    print("\n".join([*errors_table(evaluated), near, by_family(evaluated)]))
