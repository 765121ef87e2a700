"""Stated errors of changes beside true ones, in random poses of targets before small machines whose truth is cheap.

`python3 -m analysis measure stated --poses 500 --seed 1` prints a row for each method: the part of the poses in which the error stated is at least the
true one, the least ratio of both, rms and worst error, and processor time. The truth is that of boundary elements asked for 1e-3; a difference within what the truth itself states is none.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.pipeline import model_stage
from geometries.common.arguments import positive_integer, positive_number
from geometries.scene.poses import AxisRotation, Pose
from geometries.scene.scene import Object, Plate, Scene, Sensor
from geometries.scene.shapes import Cuboid, PlateShape, Shape, Sphere
from geometries.scene.writer import canonical

_TRUTH_RTOL = 1e-3
_BALL_SEGMENTS = 16
_SHARES = (0.6, 0.9)
"""Parts of the poses whose targets are boxes, and boxes or plates; the others are balls."""
_MOST_TRUTH_ERROR = 1e-2
"""Relative error of a truth beyond which a pose is not counted."""
METHODS: dict[str, dict[str, Any]] = {
    "reduced:2": {"method": "reduced:2"},
    "boundary elements, rtol 0.03": {"method": "boundary-elements", "rtol": 3e-2},
    "formula, rtol 0.02": {"correction": "formula", "rtol": 2e-2},
    "formula": {"correction": "formula"},
}


@dataclass(frozen=True)
class Answer:
    """An error relative to the true change: the actual one, less that of the truth, and the one stated; and seconds of processor time."""

    error: float
    stated: float
    seconds: float


def scene(seed: int, number: int) -> Scene:
    """Returns a sensor of 4 to 12 cm, in two of three poses before a housing, and one or two targets at 1 to 20 cm before it."""
    random = np.random.default_rng((seed, number))
    width, height = random.uniform(0.04, 0.12, 2)
    sensor = Sensor("sensor", (Plate((-width / 2, -height / 2, 0.0), (width, 0.0, 0.0), (0.0, height, 0.0)),))
    bodies = []
    if random.random() < 2 / 3:
        depth, behind = random.uniform(0.03, 0.1), random.uniform(0.003, 0.01)
        size = (float(width * random.uniform(1, 1.6)), float(height * random.uniform(1, 1.6)), float(depth))
        bodies.append(Object("housing", Cuboid(size), None, Pose((0.0, 0.0, -float(behind + depth / 2)))))
    count = 1 + int(random.random() < 0.3)
    gap, kind = float(0.01 * 20 ** random.random()), random.random()
    for target in range(count):
        shape = _shape(random, kind)
        turn = AxisRotation(_unit(random), float(random.uniform(0, 180)))
        corners = shape.triangles().reshape(-1, 3) @ turn.matrix().T
        side = float(random.uniform(-0.1, 0.1))
        # Two targets are kept apart by a plane.
        x = side if count == 1 else float((1 - 2 * target) * (0.01 + corners[:, 0].max() + abs(side)))
        place = (x, float(random.uniform(-0.08, 0.08)), gap - float(corners[:, 2].min()))
        bodies.append(Object(f"target {target + 1}", shape, None, Pose(place, turn), target=True))
    return Scene(sensors=(sensor,), objects=tuple(bodies))


def _unit(random: np.random.Generator) -> tuple[float, float, float]:
    x, y, z = random.normal(size=3)
    length = math.sqrt(x * x + y * y + z * z)
    return float(x / length), float(y / length), float(z / length)


def _shape(random: np.random.Generator, kind: float) -> Shape:
    if kind < _SHARES[0]:
        x, y, z = random.uniform(0.02, 0.15, 3)
        return Cuboid((float(x), float(y), float(z)))
    if kind < _SHARES[1]:
        x, y = random.uniform(0.02, 0.15, 2)
        return PlateShape((float(x), float(y)))
    return Sphere(float(random.uniform(0.02, 0.07)), _BALL_SEGMENTS)


def measured(seed: int, number: int) -> dict[str, Answer]:
    """Answers one pose by all methods; none if its truth is not known well enough."""
    model = model_stage.model_module()
    text = canonical(scene(seed, number))
    truth = model.Scene.loads(text).readings("boundary-elements", rtol=_TRUTH_RTOL)["sensor"]
    scale = abs(truth.change)
    if not truth.error["change"] <= _MOST_TRUTH_ERROR * scale:
        return {}
    result = {}
    for name, options in METHODS.items():
        before = time.process_time()
        reading = model.Scene.loads(text).readings(**options)["sensor"]
        seconds = time.process_time() - before
        difference = max(abs(reading.change - truth.change) - truth.error["change"], 0.0)
        stated = reading.error["change"]
        result[name] = Answer(difference / scale, math.inf if stated is None else stated / scale, seconds)
    return result


def row(name: str, answers: list[Answer]) -> str:
    """Returns a row of the table in model/CORRECTIONS.md; errors in %."""
    errors, stated = np.array([each.error for each in answers]), np.array([each.stated for each in answers])
    wrong = errors > 0
    least = (stated[wrong] / errors[wrong]).min() if wrong.any() else math.inf
    return (
        f"| {name} | {len(answers)} | {100 * np.mean(errors <= stated):.1f} | {least:.2f} | {100 * np.sqrt(np.mean(errors**2)):.2f} "
        f"| {100 * errors.max():.1f} | {100 * np.median(stated):.2f} | {np.mean([each.seconds for each in answers]):.2f} |"
    )


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what may be asked for."""
    parser.add_argument("--poses", type=positive_integer, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=positive_number, default=math.inf, help="ends after these seconds")


def measure(asked: argparse.Namespace) -> int:
    """Prints the poses in which an error is larger than stated, and the table."""
    begin, answers, count = time.monotonic(), {name: list[Answer]() for name in METHODS}, 0
    for number in range(asked.first, asked.first + asked.poses):
        if time.monotonic() - begin > asked.seconds:
            break
        count += 1
        for name, answer in measured(asked.seed, number).items():
            answers[name].append(answer)
            if answer.error > answer.stated:
                print(
                    f"pose {number}, {name}: error {answer.error:.3%}, stated {answer.stated:.3%}", flush=True
                )
    print(f"{count} poses")
    for name, own in answers.items():
        if own:
            print(row(name, own))
    return 0
