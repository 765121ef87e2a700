"""The kinds of random scenes, and the scene that a seed stands for."""

import itertools
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from analysis.honesty import scenes
from analysis.honesty.asking import has_readings
from analysis.honesty.closed_forms import FORMS, Known
from analysis.results.answers import Estimate
from geometries.scene.scene import Scene
from geometries.scene.shapes import ROUND_SHAPES
from geometries.scene.writer import canonical

_FINE_SEGMENTS, _MOST_FINER = 48, 2
"""Sides of round bodies for the finer answer by boundary elements, at least, where there are no more such bodies than this: with more
triangles it would have no time to refine."""


@dataclass(frozen=True)
class Drawn:
    """A random scene: its kind, its text, the same with finer round bodies, and what is known of it in closed form."""

    seed: int
    kind: str
    text: str
    finer: str
    has_readings: bool
    truths: dict[str, Estimate]


def _alone(make: Callable[[scenes.Chance], Scene]) -> Callable[[scenes.Chance, Path], Known]:
    return lambda chance, folder: Known(make(chance), {})


KINDS: dict[str, Callable[[scenes.Chance, Path], Known]] = {
    "plates": _alone(scenes.plates),
    "sizes": _alone(scenes.sizes),
    "round": _alone(scenes.round_targets),
    "flat-boxes": _alone(scenes.flat_boxes),
    "covers": _alone(scenes.covered),
    "insulators": _alone(scenes.insulators),
    "floating": _alone(scenes.floating),
    "guards": _alone(scenes.guarded),
    "transmit": _alone(scenes.transmitted),
    "hollow": lambda chance, folder: Known(scenes.hollow(chance, folder), {}),
    "no-sensors": _alone(scenes.unsensed),
    "robots": _alone(scenes.robot),
    "closed-forms": lambda chance, folder: chance.choice(FORMS)(chance, folder),
}
"""What is drawn, by the kinds' names: a seed's kind is its remainder by their number."""


def kind_of(seed: int) -> str:
    """Returns the kind of a seed's scene."""
    return list(KINDS)[seed % len(KINDS)]


def seeds(first: int, kinds: frozenset[str]) -> Iterator[int]:
    """Returns the seeds from the first one on whose scenes are of these kinds, without end."""
    return (seed for seed in itertools.count(first) if kind_of(seed) in kinds)


def drawn(seed: int, folder: Path) -> Drawn:
    """Draws a seed's scene; its meshes are files in the folder."""
    kind = kind_of(seed)
    known = KINDS[kind](random.Random(seed), folder)
    text = canonical(known.scene)
    return Drawn(seed, kind, text, canonical(_finer(known.scene)), has_readings(known.scene), known.truths)


def _finer(scene: Scene) -> Scene:
    """Returns the scene with round bodies of more sides."""
    objects, round_ones = list(scene.objects), 0
    for number, body in enumerate(scene.objects):
        if isinstance(body.shape, ROUND_SHAPES):
            finer = replace(body.shape, segments=max(_FINE_SEGMENTS, body.shape.segments))
            objects[number], round_ones = replace(body, shape=finer), round_ones + 1
    return scene if round_ones > _MOST_FINER else replace(scene, objects=tuple(objects))
