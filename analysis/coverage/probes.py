"""Probes: what is held before a machine, by a text such as `sphere:0.02` or a name such as `finger`."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path


from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene import shapes
from geometries.scene.meshes import read_triangles
from geometries.scene.person import Person


_SEGMENTS = 16
_SHAPES: dict[str, tuple[tuple[str, ...], Callable[..., shapes.Shape]]] = {
    "sphere": (("R",), lambda radius: shapes.Sphere(radius, _SEGMENTS)),
    "capsule": (("R", "L"), lambda radius, length: shapes.Capsule(radius, length, _SEGMENTS)),
    "box": (("X", "Y", "Z"), lambda x, y, z: shapes.Cuboid((x, y, z))),
}
"""By the word that a text begins with: the lengths that follow it, and the shape of these lengths."""

NAMED: dict[str, shapes.Shape] = {
    "finger": shapes.Capsule(0.008, 0.06, _SEGMENTS),
    "fist": shapes.Sphere(0.045, _SEGMENTS),
    "hand": shapes.Cuboid((0.19, 0.085, 0.028)),
    "infant": Person(0.36, "infant", "lying"),
}
"""A forefinger that points at the machine, 16 mm thick and 76 mm long; a fist of 9 cm; a flat hand, 190 × 85 × 28 mm; an infant of 1 kg who
lies with the back to the machine. Breadths and lengths are those of grown-up men's hands (DIN 33402-2, 50th percentile), rounded."""
DEFAULT = ("sphere:0.02", "finger", "fist", "hand", "infant")


@dataclass(frozen=True)
class Probe:
    """A probe in its own frame, in metres: its z axis points away from the machine, and its lowest point is the one that comes nearest."""

    name: str
    shape: shapes.Shape

    @cached_property
    def triangles(self) -> Array:
        """(n, 3, 3)."""
        return self.shape.triangles()


def probe(name: str) -> Probe:
    """Returns the probe that a name or a text describes; InputError for one that is none."""
    kind, *rest = name.split(":")
    if name in NAMED:
        return Probe(name, NAMED[name])
    if kind == "mesh" and rest:
        file = Path(":".join(rest)).absolute()
        triangles = read_triangles(file)
        digest = hashlib.sha256(file.read_bytes()).hexdigest()
        return Probe(file.stem, shapes.MeshShape(str(file), digest, 1.0, triangles))
    if kind not in _SHAPES:
        forms = (f"{word}:{':'.join(names)}" for word, (names, _) in _SHAPES.items())
        raise InputError("--probe", "", f"{name!r} is none of {', '.join([*NAMED, *forms, 'mesh:FILE'])}")
    names, shape_of = _SHAPES[kind]
    try:
        lengths = [float(text) for text in rest]
    except ValueError:
        lengths = []
    if len(lengths) != len(names) or not all(0 < x < math.inf for x in lengths):
        raise InputError("--probe", "", f"{name!r} must be {kind}:{':'.join(names)}, lengths in metres")
    return Probe(name, shape_of(*lengths))
