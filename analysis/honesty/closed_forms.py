"""Scenes whose answers are known in closed form, with these answers: capacitances over 4πε, which are lengths, with errors of
rounding, below 1e-9."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.constants import epsilon_0
from scipy.special import elliprf

from analysis.honesty.asking import entry, part_of
from analysis.honesty.scenes import Chance, bowl, logarithmic, mesh, turn, uniform
from analysis.results.answers import Estimate
from analysis.topics.verification import truths
from geometries.scene.poses import AxisRotation, Pose
from geometries.scene.scene import Medium, Object, Reading, Scene
from geometries.scene.shapes import Cuboid, Disc, Ellipsoid, PlateShape, Shape, Sphere


def of_ellipsoid(a: float, b: float, c: float) -> float:
    """Returns the capacitance of a conducting ellipsoid with these semi-axes, one of which may be 0: 1 / R_F(a², b², c²) (Carlson, SIAM J. Math.
    Anal. 8 (1977) 231; the integral is Maxwell's). A disc is the one with a third axis of 0."""
    return 1 / float(elliprf(a * a, b * b, c * c))


def of_two_spheres(a: float, b: float, gap: float) -> tuple[float, float, float]:
    """Returns C11, C22 and C12 (below 0) of spheres of radii a and b with this gap between them: Kelvin's images (Smythe, Static and
    Dynamic Electricity, 3rd edition, section 5.082), summed until the terms are below rounding."""
    distance = a + b + gap
    # cosh u − 1 without the cancellation of nearly touching spheres.
    excess = gap * (gap + 2 * (a + b)) / (2 * a * b)
    u = math.log1p(excess + math.sqrt(excess * (excess + 2)))
    n = np.arange(int(40 / u) + 2)
    now, following = np.sinh(n * u), np.sinh((n + 1) * u)
    scale = math.sinh(u)
    own = a * b * scale * float(np.sum(1 / (a * now + b * following)))
    other = a * b * scale * float(np.sum(1 / (b * now + a * following)))
    return own, other, -a * b / distance * scale * float(np.sum(1 / following))


def of_coaxial_discs(radius: float, gap: float) -> tuple[float, float]:
    """Returns C11 and C12 (below 0) of equal coaxial discs, by Love's equation for discs at opposite and at the same potential."""
    opposite, same = (truths.love(gap / radius, other) for other in (-1.0, 1.0))
    return radius * (same + opposite), radius * (same - opposite)


def of_bowl(radius: float, half_angle: float) -> float:
    """Returns the capacitance of the thin part of a sphere within `half_angle` (rad) of a point: Kelvin's bowl (Reprint of Papers on Electrostatics
    and Magnetism, 1872, section 233), (α + sin α)/π of the sphere's."""
    return radius * (half_angle + math.sin(half_angle)) / math.pi


def of_coated_sphere(radius: float, outer: float, permittivity: float) -> float:
    """Returns the capacitance of a sphere within a layer of an insulator up to the radius `outer`: shells in series, by Gauss's law."""
    return 1 / ((1 / radius - 1 / outer) / permittivity + 1 / outer)


def of_crossing_spheres(a: float, b: float) -> float:
    """Returns the capacitance of two spheres that cross at right angles: three images (Maxwell, Treatise, 3rd edition, section 168)."""
    return a + b - a * b / math.hypot(a, b)


def beside_insulator(radius: float, other: float, gap: float, permittivity: float) -> float:
    """Returns the capacitance of a sphere beside an insulating sphere of radius `other`: multipoles about both centres. The gap has to be at least
    a third of the smaller radius, for the error to be below 1e-9."""
    return truths.two_balls(radius, other, radius + other + gap, truths.dielectric(permittivity))[0]


Truths = dict[str, Estimate]
_UNIT = 4 * math.pi * epsilon_0
_ROUNDING = 1e-9
"""Relative error of a formula."""
_SEGMENTS = (16, 24, 48)
_BOWL_SEGMENTS, _BOWL_ROWS = 48, 16
_OF_FACETS = 0.2
"""Part of the area that a mesh lacks which its capacitance may still lack after its radius is enlarged to have the sphere's area."""


@dataclass(frozen=True)
class Known:
    """A scene with the answers that are known: by quantity, in F, with their errors."""

    scene: Scene
    truths: Truths


def one_body(chance: Chance, folder: Path) -> Known:
    """An ellipsoid of ratio 1 to 100, a disc, a cube or a square, alone."""
    size, ratio = logarithmic(chance, 0.01, 0.5), logarithmic(chance, 1, 100)
    middle = uniform(chance, size / ratio, size) if ratio > 1 else size
    segments, thin = chance.choice(_SEGMENTS), size / ratio

    def ellipsoid(a: float, b: float, c: float) -> tuple[Shape, float, float]:
        return Ellipsoid((a, b, c), segments), of_ellipsoid(a, b, c), _ROUNDING

    kinds: dict[str, tuple[Shape, float, float]] = {
        "sphere": (Sphere(size, segments), size, _ROUNDING),
        "flat": ellipsoid(size, size, thin),
        "long": ellipsoid(thin, thin, size),
        "three axes": ellipsoid(size, middle, thin),
        "disc": (Disc(size, segments), of_ellipsoid(size, size, 0), _ROUNDING),
        "cube": (Cuboid((size, size, size)), size * truths.UNIT_CUBE, _ROUNDING),
        "square": (PlateShape((size, size)), size * truths.UNIT_SQUARE_PLATE, truths.UNIT_SQUARE_PLATE_ERROR),
    }
    shape, length, error = kinds[chance.choice(sorted(kinds))]
    permittivity = uniform(chance, 1, 5) if chance.random() < 0.2 else 1.0
    body = Object("a", shape, pose=Pose((0.0, 0.0, 0.0), turn(chance)), potential="electrode")
    scene = Scene(medium=Medium(permittivity), objects=(body,))
    return Known(scene, {entry("a", "a"): _estimate(permittivity * length, error)})


def two_spheres(chance: Chance, folder: Path) -> Known:
    """Two spheres: the matrix, or what the second one changes of the first one's reading, grounded, floating or insulating."""
    a = logarithmic(chance, 0.01, 0.2)
    b = a * logarithmic(chance, 0.2, 5)
    gap = min(a, b) * logarithmic(chance, 0.03, 3)
    segments = chance.choice(_SEGMENTS)
    kind = chance.choice(("matrix", "grounded", "floating", "insulating"))
    if kind == "insulating":
        gap = max(gap, min(a, b) / 3)
    more: dict[str, dict[str, object]] = {
        "matrix": {"potential": "electrode"},
        "grounded": {"target": True},
        "floating": {"potential": "floating", "target": True},
        "insulating": {"relative_permittivity": logarithmic(chance, 1.5, 1e6), "target": True},
    }
    at = Pose((0.0, 0.0, round(a + b + gap, 9)))
    second = Object("b", Sphere(b, segments), pose=at, **more[kind])  # type: ignore[arg-type]
    first = Object("a", Sphere(a, segments), potential="electrode")
    gap = at.translation[2] - a - b
    own, other, between = of_two_spheres(a, b, gap)
    if kind == "matrix":
        return _pair((first, second), own, other, between)
    if second.relative_permittivity is not None:
        value = beside_insulator(a, b, gap, second.relative_permittivity)
    else:
        value = own if kind == "grounded" else own - between**2 / other
    return _read(first, second, value, a)


def coaxial_discs(chance: Chance, folder: Path) -> Known:
    """Two equal coaxial discs: the matrix."""
    radius, segments = logarithmic(chance, 0.02, 0.3), chance.choice((24, 48))
    gap = round(radius * logarithmic(chance, 0.06, 3), 9)
    own, between = of_coaxial_discs(radius, gap)
    discs = tuple(
        Object(name, Disc(radius, segments), pose=Pose((0.0, 0.0, height)), potential="electrode")
        for name, height in (("a", 0.0), ("b", gap))
    )
    return _pair(discs, own, own, between)


def bowls(chance: Chance, folder: Path) -> Known:
    """A bowl of a mesh whose area is that of the true one."""
    radius, angle = logarithmic(chance, 0.02, 0.3), uniform(chance, 0.4, 2.7)
    triangles = bowl(1.0, angle, _BOWL_SEGMENTS, _BOWL_ROWS)
    sides = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    share = float(np.linalg.norm(sides, axis=1).sum() / 2) / (2 * math.pi * (1 - math.cos(angle)))
    shape = mesh(radius / math.sqrt(share) * triangles, folder)
    body = Object("a", shape, pose=Pose((0.0, 0.0, 0.0), turn(chance)), potential="electrode")
    length = of_bowl(radius, angle)
    return Known(Scene(objects=(body,)), {entry("a", "a"): _estimate(length, _OF_FACETS * (1 - share))})


def coated_spheres(chance: Chance, folder: Path) -> Known:
    """A sphere in a layer of an insulator, which comes and goes."""
    radius, segments = logarithmic(chance, 0.02, 0.2), chance.choice(_SEGMENTS)
    outer, material = radius * (1 + logarithmic(chance, 0.01, 1)), logarithmic(chance, 1.5, 1e4)
    layer = Object("b", Sphere(outer, segments), relative_permittivity=material, target=True)
    value = of_coated_sphere(radius, outer, material)
    return _read(Object("a", Sphere(radius, segments), potential="electrode"), layer, value, radius)


def crossing_spheres(chance: Chance, folder: Path) -> Known:
    """Two spheres that cross at right angles, one conductor."""
    a, segments = logarithmic(chance, 0.02, 0.2), chance.choice(_SEGMENTS)
    b = a * logarithmic(chance, 0.3, 3)
    poses = (Pose(), Pose((0.0, 0.0, math.hypot(a, b)), AxisRotation((0.0, 0.0, 1.0), 3.0)))
    parts = tuple(
        Object(f"part {number}", Sphere(radius, segments), pose=pose, potential="electrode", conductor="a")
        for number, (radius, pose) in enumerate(zip((a, b), poses))
    )
    length = of_crossing_spheres(a, b)
    return Known(Scene(objects=parts), {entry("a", "a"): _estimate(length)})


def _pair(bodies: tuple[Object, ...], own: float, other: float, between: float) -> Known:
    """Returns the scene of two bodies with their matrix."""
    values = {entry("a", "a"): own, entry("b", "b"): other, entry("a", "b"): between}
    return Known(Scene(objects=bodies), {name: _estimate(value) for name, value in values.items()})


def _read(first: Object, second: Object, value: float, background: float) -> Known:
    """Returns a scene with a reading of the first body, which the second one changes."""
    scene = Scene(objects=(first, second), readings=(Reading("a", "a", ("a",)),))
    known = {
        part_of("a", "value"): _estimate(value),
        part_of("a", "background"): _estimate(background),
        part_of("a", "change"): Estimate(_UNIT * (value - background), _UNIT * value * _ROUNDING),
    }
    return Known(scene, known)


def _estimate(length: float, error: float = _ROUNDING) -> Estimate:
    return Estimate(_UNIT * length, abs(_UNIT * length) * error)


_OF_MANY: tuple[Callable[[Chance, Path], Known], ...] = (one_body, two_spheres)
FORMS = (*_OF_MANY, *_OF_MANY, coaxial_discs, bowls, coated_spheres, crossing_spheres)
"""What is drawn from; those of many shapes or roles are there twice."""
