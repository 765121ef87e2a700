"""Corrections that were tried and failed, computed here only to show how far off they are (model/CORRECTIONS.md, sections 2, 3 and 6).

Each one replaces ε∫dA/d for one rectangular sensor and one plate or box, as the set-ups have them. The model's module has none of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.results.units import VACUUM_PERMITTIVITY
from analysis.topics.corrections.quadrature import adaptive_integral
from geometries.scene.scene import Scene

Array = NDArray[np.float64]

CONSTANT = 1.295
"""The factor of `constant`: mean logarithm of truth over model in the open set-ups."""
LATERAL_WEIGHT = 1.62
"""The weight of the distance beside a face relative to the height above it: least squares of the logarithm, open set-ups."""

_ROUNDING = 1e-12


@dataclass(frozen=True)
class Candidate:
    """What the tables say of a correction, and the function that computes it in m (capacitance over ε)."""

    name: str
    formula: str
    source: str
    constants: str
    evaluate: Callable[[Bodies], float]

    def description(self) -> dict[str, str]:
        """Returns what the registry says of the module's own corrections."""
        return {
            "name": self.name,
            "formula": self.formula,
            "source": self.source,
            "constants": self.constants,
            "cost": "not measured: it failed",
        }


@dataclass(frozen=True, eq=False)
class Face:
    """A flat convex face: its corners (n, 3) in order, in metres, and its unit normal (3,)."""

    corners: Array
    normal: Array

    @cached_property
    def frame(self) -> Array:
        """Unit vectors (3, 3) in the plane, twice, and along the normal."""
        along = self.corners[1] - self.corners[0]
        along = along / np.linalg.norm(along)
        return np.array([along, np.cross(self.normal, along), self.normal])

    @cached_property
    def outline(self) -> tuple[Array, Array]:
        """The corners (n, 2) relative to the first one, and the edges (n, 2) from each to the next, in the plane."""
        corners = (self.corners - self.corners[0]) @ self.frame[:2].T
        return corners, np.roll(corners, -1, axis=0) - corners


@dataclass(frozen=True, eq=False)
class Bodies:
    """A rectangular sensor and an object made of parallelograms; `integrals` (m) and `areas` (m²) are those of the object's triangles."""

    sensor: Face
    faces: tuple[Face, ...]
    closed: bool
    integrals: Array
    areas: Array
    normals: Array

    @property
    def plain(self) -> float:
        """∫dA/d over the object (m)."""
        return float(np.sum(self.integrals))

    @property
    def sides(self) -> tuple[float, float]:
        """The lengths of the sensor's sides (m)."""
        a, b, _, d = self.sensor.corners
        return float(np.linalg.norm(b - a)), float(np.linalg.norm(d - a))


def estimate(module: Any, scene: Scene, names: Sequence[str]) -> dict[str, float]:
    """Returns the estimates of `mutual` (F) by those candidates that are named, in a scene of one sensor and one target."""
    chosen = [each for each in CANDIDATES if each.name in names]
    if not chosen:
        return {}
    bodies = _bodies(module, scene)
    return {each.name: VACUUM_PERMITTIVITY * each.evaluate(bodies) for each in chosen}


def _bodies(module: Any, scene: Scene) -> Bodies:
    surfaces = scene.conductors()
    (sensor,) = _faces(surfaces["sensor"])
    object_ = surfaces["target"]
    corner, along_u, _, along_v = sensor.corners
    integrals = module.plate_integral(object_, corner, along_u - corner, along_v - corner)
    doubled = np.cross(object_[:, 1] - object_[:, 0], object_[:, 2] - object_[:, 0])
    lengths = np.linalg.norm(doubled, axis=1)
    faces = _faces(object_)
    return Bodies(sensor, faces, len(faces) > 1, integrals, lengths / 2, doubled / lengths[:, None])


def _faces(triangles: Array) -> tuple[Face, ...]:
    """Joins the two triangles of each parallelogram."""
    faces = []
    for (a, b, c), (_, _, d) in zip(triangles[::2], triangles[1::2]):
        normal = np.cross(b - a, c - a)
        faces.append(Face(np.array([a, b, c, d]), normal / np.linalg.norm(normal)))
    return tuple(faces)


def _constant(bodies: Bodies) -> float:
    return CONSTANT * bodies.plain


def _arc(bodies: Bodies) -> float:
    sines = np.linalg.norm(np.cross(bodies.normals, bodies.sensor.normal), axis=1)
    angles = np.arctan2(sines, np.abs(bodies.normals @ bodies.sensor.normal))
    return float(
        np.sum(bodies.integrals * np.divide(sines, angles, out=np.ones_like(angles), where=angles > 0))
    )


def _kirchhoff(bodies: Bodies) -> float:
    circumference = math.pi * math.sqrt(bodies.sides[0] * bodies.sides[1] / math.pi)
    distances = bodies.areas / bodies.integrals
    # Beyond the formula's range of validity the term would become negative.
    gain = distances / circumference * (np.log(16 * circumference / distances) - 1)
    return float(np.sum(bodies.integrals * (1 + np.maximum(gain, 0))))


def _palmer(bodies: Bodies) -> float:
    distances = bodies.areas / bodies.integrals
    factor = np.ones_like(distances)
    for length in bodies.sides:
        gain = distances / (math.pi * length) * (1 + np.log(2 * math.pi * length / distances))
        factor = factor * (1 + np.maximum(gain, 0))
    return float(np.sum(bodies.integrals * factor))


def _reciprocity(bodies: Bodies) -> float:
    on_sensor = _integral(bodies.sensor, lambda points: 1 / _distance(bodies.faces, points))
    return math.sqrt(bodies.plain * on_sensor)


def _two_sided_arc(bodies: Bodies) -> float:
    """√(A B), A and B each ∫dA (1/L_front + 1/L_back) over one surface; a face of a body has one of the two only."""
    sensor = (bodies.sensor,)
    seen = tuple(face for face in bodies.faces if not bodies.closed or _sees(face, sensor))
    return math.sqrt(_arcs(bodies.faces, bodies.closed, sensor) * _arcs(sensor, False, seen))


def _arcs(surface: Sequence[Face], closed: bool, others: Sequence[Face]) -> float:
    total = 0.0
    for face in surface:
        front = not closed or _sees(face, others)

        def inverse_lengths(points: Array) -> Array:
            found = 1 / _front_length(others, points, face.normal) if front else np.zeros(len(points))
            if not closed or not front:
                found = found + 1 / _back_length(face, closed, others, points)
            return np.asarray(found)

        total += _integral(face, inverse_lengths)
    return total


def _integral(face: Face, function: Callable[[Array], Array]) -> float:
    """Integrates a function of points (n, 3) over a parallelogram, as two triangles."""
    a, b, c, d = face.corners
    return adaptive_integral(np.array([[a, b, c], [a, c, d]]), function)


def _sees(face: Face, others: Sequence[Face]) -> bool:
    """Tells whether a corner of another face lies in front of this one."""
    corners = np.concatenate([other.corners for other in others])
    heights = (corners - face.corners[0]) @ face.normal
    return bool(np.max(heights) > _ROUNDING * np.max(np.abs(corners)))


def _front_length(faces: Sequence[Face], points: Array, normal: Array) -> Array:
    """Returns the length of the arc from each point (n, 3) of a surface with this normal to the nearest face (n,)."""
    least = np.full(len(points), np.inf)
    for face in faces:
        heights, beside = _heights_and_lateral(face, points)
        sine = float(np.linalg.norm(np.cross(normal, face.normal)))
        stretch = math.atan2(sine, abs(float(normal @ face.normal))) / sine if sine > 0 else 1.0
        least = np.minimum(least, np.hypot(stretch * heights, LATERAL_WEIGHT * beside))
    return least


def _back_length(own: Face, closed: bool, faces: Sequence[Face], points: Array) -> Array:
    """Returns the length of the shortest path from the back of a face around one of its edges, then along an arc (n,).

    At the edge of a sheet the path makes half a turn to the point's mirror image, at that of a body a quarter turn to the edge.
    """
    least = np.full(len(points), np.inf)
    for a, b in zip(own.corners, np.roll(own.corners, -1, axis=0)):
        to_edge = _nearest_on_segment(a, b, points) - points
        turns, reach = (math.pi / 2, 1) if closed else (math.pi, 2)
        around = turns * np.linalg.norm(to_edge, axis=1)
        least = np.minimum(least, around + _front_length(faces, points + reach * to_edge, own.normal))
    return least


def _distance(faces: Sequence[Face], points: Array) -> Array:
    """Returns the distance of each point (n, 3) from the nearest face (n,)."""
    found = (_heights_and_lateral(face, points) for face in faces)
    return np.asarray(np.min([np.hypot(heights, beside) for heights, beside in found], axis=0))


def _heights_and_lateral(face: Face, points: Array) -> tuple[Array, Array]:
    """Returns the heights over a face's plane (n,), and how far beside the outline the projections lie (n,), 0 inside."""
    x, y, heights = face.frame @ (points - face.corners[0]).T
    corners, edges = face.outline
    right, up = x[:, None] - corners[:, 0], y[:, None] - corners[:, 1]
    inside = np.all(edges[:, 0] * up - edges[:, 1] * right >= 0, axis=1)
    shares = np.clip((right * edges[:, 0] + up * edges[:, 1]) / (edges**2).sum(axis=1), 0, 1)
    beside = np.hypot(right - shares * edges[:, 0], up - shares * edges[:, 1]).min(axis=1)
    return heights, np.where(inside, 0.0, beside)


def _nearest_on_segment(a: Array, b: Array, points: Array) -> Array:
    shares = np.clip((points - a) @ (b - a) / float((b - a) @ (b - a)), 0, 1)
    return np.asarray(a + shares[:, None] * (b - a))


CANDIDATES = (
    Candidate(
        "constant",
        "c·ε∫dA/d",
        "one number for all that is missing",
        "c: mean logarithm of truth over model",
        _constant,
    ),
    Candidate(
        "arc",
        "ε Σ (sin θ/θ)∫dA/d, θ between triangle and plate",
        "field between the plates of a wedge",
        "",
        _arc,
    ),
    Candidate(
        "kirchhoff",
        "ε Σ I·[1 + (δ/πa)·(ln(16πa/δ) − 1)], I = ∫dA/d, δ = A/I, πa² the plate's area",
        "G. Kirchhoff, Monatsber. Akad. Wiss. Berlin 1877, 144",
        "",
        _kirchhoff,
    ),
    Candidate(
        "palmer",
        "ε Σ I·Π [1 + (δ/πL)·(1 + ln(2πL/δ))] over the plate's two lengths L",
        "H. B. Palmer, Trans. AIEE 56 (1937) 363",
        "",
        _palmer,
    ),
    Candidate(
        "reciprocity",
        "ε√(∫dA/d over the object · ∫dA/d over the sensor)",
        "Green: the true matrix is symmetric",
        "",
        _reciprocity,
    ),
    Candidate(
        "two-sided-arc",
        "ε√(A B), A and B each ∫dA·(1/L_front + 1/L_back) over one surface",
        "model/CORRECTIONS.md: field lines as arcs, also around edges",
        "k: least squares of the logarithm",
        _two_sided_arc,
    ),
)
"""All corrections that failed, in the order of the notes."""
