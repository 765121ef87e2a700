"""What is held before a machine, and where: probes by a text such as `sphere:0.02` or a name such as `finger`; places on the machine's surface, the directions away
from it, and how far they are free."""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from geometries.common.arrays import Array, Flags, Indices
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


_PLACES = 2000
"""The number of places, about, if no grid is asked for."""
_LIFT = 1e-6
"""Distance of a ray's origin from its surface, over the size of the machine."""
_TOGETHER = 200_000
"""Number of pairs of rays and triangles at once."""
_GOLDEN = (0.7548776662466927, 0.5698402909980532)
"""The two-dimensional golden ratio: multiples of it spread evenly."""


@dataclass(frozen=True)
class Places:
    """Points (n, 3) in metres with the directions away from the machine (n, 3), the names of what they lie on, and the free length (n,)
    until the machine comes again, infinite where it does not."""

    points: Array
    normals: Array
    owners: tuple[str, ...]
    free: Array

    def rotations(self) -> Array:
        """Returns rotations (n, 3, 3) that turn the z axis into each direction, and the x axis as far towards the world's as it can be; of a
        direction along x, towards the world's y axis."""
        z = self.normals
        along = np.where(np.abs(z[:, :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
        x = along - np.einsum("ni,ni->n", along, z)[:, None] * z
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        return np.stack([x, np.cross(z, x), z], axis=2)


def spread(conductors: dict[str, Array], sheets: frozenset[str], grid: float | None) -> Places:
    """Spreads places over all surfaces, one for each square of side `grid` (m) if given, on both sides of sheets; none where the way out is blocked at
    once, as of faces within other bodies. The same scene has the same places."""
    inwards = {name for name, own in conductors.items() if name not in sheets and _faces_inwards(own)}
    triangles = np.concatenate([own[:, ::-1] if k in inwards else own for k, own in conductors.items()])
    names = [name for name, own in conductors.items() for _ in own]
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    doubled = np.linalg.norm(cross, axis=1)
    sound = doubled > 0
    count = max(1, round(float(doubled.sum()) / 2 / grid**2)) if grid else _PLACES
    ends = np.cumsum(doubled)
    chosen = np.searchsorted(ends, (np.arange(count) + 0.5) * ends[-1] / count)
    chosen = chosen[sound[np.minimum(chosen, len(sound) - 1)]]
    u, v = (np.arange(len(chosen))[:, None] * np.array(_GOLDEN) % 1).T
    folded = u + v > 1
    u, v = np.where(folded, 1 - u, u), np.where(folded, 1 - v, v)
    a, b, c = triangles[chosen].transpose(1, 0, 2)
    points = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    normals = cross[chosen] / doubled[chosen, None]
    owners = [names[k] for k in chosen]
    behind = [k for k, name in enumerate(owners) if name in sheets]
    points, normals = np.concatenate([points, points[behind]]), np.concatenate([normals, -normals[behind]])
    owners += [owners[k] for k in behind]
    lift = _LIFT * float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    is_sheet = np.array([name in sheets for name in names])[sound]
    free, is_inside = _free_length(points + lift * normals, normals, triangles[sound], is_sheet, lift)
    kept = ~is_inside
    return Places(points[kept], normals[kept], tuple(np.array(owners)[kept]), free[kept])


def _faces_inwards(triangles: Array) -> bool:
    return bool(np.linalg.det(triangles - triangles[0, 0]).sum() < 0)


def _free_length(
    origins: Array, directions: Array, triangles: Array, is_sheet: Flags, least: float
) -> tuple[Array, Flags]:
    """Returns how far rays go until they meet a triangle, and whether the first one, of no sheet, is met from behind: then the ray began inside.
    Triangles next to each other in the list, as those of a body are, are left out for the rays that miss the box around them.
    """
    free, is_inside = np.full(len(origins), np.inf), np.zeros(len(origins), dtype=bool)
    for k in range(0, len(triangles), _TRIANGLES):
        own = triangles[k : k + _TRIANGLES]
        low, high = own.min(axis=(0, 1)) - least, own.max(axis=(0, 1)) + least
        met = np.flatnonzero(_meets_box(origins, directions, low, high))
        step = max(1, _TOGETHER // len(own))
        for some in np.split(met, range(step, len(met), step)):
            length, first, leaves = _first_hit(origins[some], directions[some], own, least)
            nearer = length < free[some]
            chosen = some[nearer]
            free[chosen] = length[nearer]
            is_inside[chosen] = leaves[nearer] & ~is_sheet[k + first[nearer]]
    return free, is_inside


_TRIANGLES = 64
"""Number of triangles that share a box."""


def _meets_box(origins: Array, directions: Array, low: Array, high: Array) -> Flags:
    """Returns which rays meet a box: the intervals within its three slabs have a common part (Kay and Kajiya 1986)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (low - origins) / directions, (high - origins) / directions
    parallel = directions == 0
    within = (origins >= low) & (origins <= high)
    enter = np.where(parallel, np.where(within, -np.inf, np.inf), np.minimum(one, other)).max(axis=1)
    leave = np.where(parallel, np.where(within, np.inf, -np.inf), np.maximum(one, other)).min(axis=1)
    return np.asarray((leave >= enter) & (leave >= 0))


def _first_hit(
    origins: Array, directions: Array, triangles: Array, least: float
) -> tuple[Array, Indices, Flags]:
    """Returns for each ray the length to the first triangle, infinite without any, its number, and whether the ray meets it from behind.
    Möller and Trumbore (1997)."""
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    origin, direction = origins[:, None], directions[:, None]
    across = np.cross(direction, v)
    volume = np.einsum("nti,ti->nt", across, u)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / volume
        offset = origin - a
        s = np.einsum("nti,nti->nt", offset, across) * inverse
        turned = np.cross(offset, u)
        t = np.einsum("ni,nti->nt", directions, turned) * inverse
        length = np.einsum("ti,nti->nt", v, turned) * inverse
        hits = (s >= 0) & (t >= 0) & (s + t <= 1) & (length > least)
    length = np.where(hits, length, np.inf)
    first = length.argmin(axis=1)
    rows = np.arange(len(first))
    # The determinant is negative where the ray goes along the normal: it leaves a body.
    return length[rows, first], first, volume[rows, first] < 0
