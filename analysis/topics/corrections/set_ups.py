"""The set-ups for fitting and testing corrections: plates and boxes before one rectangular sensor, drawn with a fixed seed.

A third of them is sealed for testing. The rule depends on the name alone, and the names are older than any correction.
"""

from __future__ import annotations

import csv
import hashlib
import io
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.pipeline.model_stage import model_module
from analysis.pipeline.set_up_stages import OfScene
from analysis.results.store import write_text
from geometries.common.errors import InputError
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
        return _FAMILIES[family](draw, module)
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


def _parallel(draw: Draw, module: Any) -> Scene:
    sensor = _sensor(draw)
    return families.parallel(sensor, _target(draw, sensor), _gap(draw))


def _inclined(draw: Draw, module: Any) -> Scene:
    sensor = _sensor(draw)
    return families.inclined(sensor, _target(draw, sensor), _gap(draw), _degrees(draw, 90))


def _edge(draw: Draw, module: Any) -> Scene:
    sensor = _sensor(draw)
    target = (_between(draw, _SMALLEST, _LARGEST), _between(draw, _SMALLEST, sensor[1]))
    height = 0.0 if draw.random() < 1 / 3 else _gap(draw)
    return families.edge(sensor, target, _gap(draw), height, _degrees(draw, 90))


def _corner(draw: Draw, module: Any) -> Scene:
    sensor = _sensor(draw)
    height = 0.0 if draw.random() < 1 / 3 else _gap(draw)
    gap = (_gap(draw), _gap(draw))
    return families.corner(
        sensor, _target(draw, sensor), gap, height, _degrees(draw, 90), _degrees(draw, 360)
    )


def _straddle(draw: Draw, module: Any) -> Scene:
    sensor = _sensor(draw)
    offset = (float(np.round(draw.uniform(-0.1, 0.1), 4)), float(np.round(draw.uniform(-0.1, 0.1), 4)))
    turn = 0.0 if draw.random() < 1 / 3 else _degrees(draw, 360)
    return families.straddle(
        sensor, _target(draw, sensor), _gap(draw), offset, _degrees(draw, 90) * draw.integers(2), turn
    )


def _plates(draw: Draw, module: Any) -> Scene | None:
    return _posed(
        draw, module, PlateShape((_between(draw, _SMALLEST, _LARGEST), _between(draw, _SMALLEST, _LARGEST)))
    )


def _boxes(draw: Draw, module: Any) -> Scene | None:
    x, y, z = (_between(draw, _SMALLEST, 0.2) for _ in range(3))
    return _posed(draw, module, Cuboid((x, y, z)))


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


_FAMILIES: dict[str, Callable[[Draw, Any], Scene | None]] = {
    "parallel": _parallel,
    "inclined": _inclined,
    "edge": _edge,
    "corner": _corner,
    "straddle": _straddle,
    "plates": _plates,
    "boxes": _boxes,
}


FILE = Path(__file__).with_name("truths.csv")
RTOL = 1e-4
_COLUMNS = ("name", "mutual", "error", "sensor", "sensor_alone")


@dataclass(frozen=True)
class Truth:
    """Farads: `mutual` with its `error`, the matrix' entry of the sensor, and what this is without the target."""

    mutual: float
    error: float
    sensor: float
    sensor_alone: float


def load(file: Path = FILE) -> dict[str, Truth]:
    """Returns the truths by the set-up's name."""
    with file.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    return {row["name"]: Truth(*(float(row[column]) for column in _COLUMNS[1:])) for row in rows}


def make(file: Path = FILE) -> int:
    """Solves every set-up and writes the file; returns the number of set-ups."""
    module = model_module()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    count = 0
    for count, set_up in enumerate(set_ups(module), start=1):
        truth = solved(module, set_up)
        numbers = [f"{getattr(truth, column):.7g}" for column in _COLUMNS[1:]]
        writer.writerow([set_up.name, *numbers])
    write_text(file, text.getvalue())
    return count


def solved(module: Any, set_up: SetUp) -> Truth:
    answer: dict[str, Any] = module.Scene.loads(set_up.text).maxwell(rtol=RTOL)
    matrix, change = answer["maxwell"], answer["delta_self"]["sensor"]["value"]
    return Truth(-matrix[0, 1], answer["error"][0, 1], matrix[0, 0], matrix[0, 0] - change)
