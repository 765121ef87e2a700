"""Random machines: are the errors that the reduced method states of changes errors? `python3 -m tests.model.random_readings`.

A sensor of 4 to 12 cm alone, before a housing, with a guard or a table behind it, or beside a second sensor or a floating foil; a hand
of 2 to 20 cm, flat, box or round, grounded, floating or through a capacitor, 5 mm to 30 cm before, beside or behind it. Every reading's
change by the reduced method, asked for 1e-2, 1e-3 and 3e-4 of all entries, is held against that by boundary elements at 1e-3. `stated` are errors in per cent of the change.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "build" / "python"))

import fringe  # noqa: E402

RTOLS = {f"reduced, {rtol:g}": rtol for rtol in (1e-2, 1e-3, 3e-4)}
RTOL = 1e-3
PARTS = ("value", "background", "change")

SENSOR = """
[[sensor]]
name = "{name}"
plates = [ {{ corner = [{x}, {y}, 0], edge_u = [{width}, 0, 0], edge_v = [0, {height}, 0] }} ]
"""

OBJECT = """
[[object]]
name = "{name}"
shape = {shape}
translation = {centre}
rotation = {{ axis = {axis}, degrees = {degrees} }}
potential = "{potential}"
"""

READING = """
[[reading]]
name = "{name}"
sense = "front"
drive = {drive}
"""


def body(
    name: str,
    shape: str,
    centre: Any,
    potential: str = "grounded",
    turned: tuple[Any, float] = ([0, 0, 1], 0),
) -> str:
    axis, degrees = turned
    return OBJECT.format(
        name=name,
        shape=shape,
        centre=[float(x) for x in centre],
        axis=[float(x) for x in axis],
        degrees=float(degrees),
        potential=potential,
    )


def box(sizes: Any) -> str:
    return f'{{ type = "cuboid", size = {[float(x) for x in sizes]} }}'


def plate(sizes: Any) -> str:
    return f'{{ type = "plate", size = {[float(x) for x in sizes]} }}'


def machine(random: np.random.Generator, width: float, height: float) -> str:
    """What is always there, with the readings."""
    text = SENSOR.format(name="front", x=-width / 2, y=-height / 2, width=width, height=height)
    readings = READING.format(name="self", drive=["front"])
    behind = -random.uniform(0.002, 0.006)
    if random.random() < 0.4:
        text += body("guard", plate([1.3 * width, 1.3 * height]), [0, 0, behind], "electrode")
        readings += READING.format(name="guarded", drive=["front", "guard"])
        readings += READING.format(name="transmitted by the guard", drive=["guard"])
    if random.random() < 0.5:
        depth, gap = random.uniform(0.03, 0.15), random.uniform(0.003, 0.02)
        text += body("housing", box([1.8 * width, 1.8 * height, depth]), [0, 0, behind - gap - depth / 2])
        behind -= gap + depth
    if random.random() < 0.3:
        text += body("table", box([0.6, 0.4, 0.03]), [0.1, 0, behind - random.uniform(0.05, 0.2)])
    if random.random() < 0.3:
        beside = width / 2 + random.uniform(0.003, 0.03)
        text += SENSOR.format(name="side", x=beside, y=-height / 2, width=width / 2, height=height)
        readings += READING.format(name="transmitted by the side", drive=["side"])
    if random.random() < 0.2:
        beside = -width / 2 - random.uniform(0.02, 0.03)
        text += body("foil", plate([0.03, 0.05]), [beside, 0, 0.005], "floating", ([0, 1, 0], 30))
    return text + readings


def hand(random: np.random.Generator, width: float) -> str:
    """What comes and goes."""
    sizes = np.exp(random.uniform(np.log(0.02), np.log(0.2), 3))
    kind = random.random()
    shape = box(sizes)
    if kind < 0.3:
        shape = plate(sizes[:2])
    elif kind < 0.4:
        shape = f'{{ type = "sphere", radius = {sizes[0] / 2}, segments = 12 }}'
    elif kind < 0.45:
        shape = f'{{ type = "ellipsoid", semi_axes = {(sizes / 2).tolist()}, segments = 12 }}'
    elif kind < 0.5:
        shape = f'{{ type = "box", size = {sizes.tolist()}, rounding = {sizes.min() / 3}, segments = 8 }}'
    distance = np.exp(random.uniform(np.log(0.005), np.log(0.3)))
    centre = [
        *random.uniform(-1.2, 1.2, 2) * width,
        distance + (sizes[2] / 2 if 0.3 <= kind else sizes[0] / 2),
    ]
    turned = (random.normal(size=3), random.uniform(0, 180)) if random.random() < 0.5 else ([0, 0, 1], 0.0)
    if random.random() < 0.1:
        centre[2] = -0.3 - sizes.max()
    potential = str(random.choice(["grounded", "floating", "floating"]))
    text = body("hand", shape, centre, potential, turned) + "target = true\n"
    if potential == "floating" and random.random() < 0.5:
        text += f"to_ground = {np.exp(random.uniform(np.log(1e-13), np.log(1e-10)))}\n"
    return text


def random_scene(number: int, seed: int) -> str:
    random = np.random.default_rng([seed, number])
    width, height = random.uniform(0.04, 0.12, 2)
    return machine(random, width, height) + hand(random, width)


@dataclass(frozen=True)
class Compared:
    """A reading by the reduced method and by boundary elements."""

    name: str
    method: str
    change: float  # F, by boundary elements
    stated: float  # relative to the change
    difference: float  # relative to the change
    ratio: float  # the largest difference of value, background and change per stated errors


def compared(name: str, method: str, answer: Any, truth: Any) -> Compared:
    ratios = [
        abs(getattr(answer, part) - getattr(truth, part)) / (answer.error[part] + truth.error[part])
        for part in PARTS
    ]
    scale = max(abs(truth.change), 1e-5 * abs(truth.value))
    difference = abs(answer.change - truth.change)
    return Compared(
        name, method, truth.change, answer.error["change"] / scale, difference / scale, max(ratios)
    )


def outcomes(path: Path) -> list[Compared]:
    """The readings of a scene; none if bodies touch or boundary elements do not reach their accuracy."""
    scene = fringe.Scene.load(path)
    try:
        truth = scene.readings("boundary-elements", rtol=RTOL)
        answers = {name: scene.readings("reduced", rtol=rtol, entries=True) for name, rtol in RTOLS.items()}
    except fringe.InputError:
        return []
    return [
        compared(name, method, answer[name], truth[name])
        for method, answer in answers.items()
        for name in truth
        if np.isfinite(answer[name].error["change"])
    ]


def summary(found: list[Compared], method: str) -> str:
    of_method = [one for one in found if one.method == method]
    stated, difference = (
        100 * np.array([getattr(one, key) for one in of_method]) for key in ("stated", "difference")
    )
    ratio = np.array([one.ratio for one in of_method])
    return (
        f"{method}: {len(of_method)} readings, {np.sum(ratio > 1)} wrong, largest ratio {ratio.max():.2f}; "
        f"stated % median {np.median(stated):.3g}, 90 % below {np.quantile(stated, 0.9):.3g}; "
        f"difference % median {np.median(difference):.3g}, 90 % below {np.quantile(difference, 0.9):.3g}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=171)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    found: list[Compared] = []
    answered = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        for number in range(arguments.count):
            path.write_text(random_scene(number, arguments.seed))
            of_scene = outcomes(path)
            answered += bool(of_scene)
            found += of_scene
            for one in of_scene:
                if one.ratio > 1:
                    print(f"{number} {one}")
    print(f"{answered} of {arguments.count} scenes answered")
    for method in RTOLS:
        print(summary(found, method))


if __name__ == "__main__":
    main()
