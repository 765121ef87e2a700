"""The truth that the stress program judges by, against a quadrature written apart from it.

`plate_integral_stress --only-truth` prints triangles and plates as they are, and integrals to 25 digits. Here the same
integrals are taken in another way: straight lines sweep the whole triangle from one of its vertices, whatever cells of the
plate they pass, and the distance to the rectangle is clamped at every point. The geometry is done by mpmath, the sums in
NumPy's extended precision. The lines are broken where they cross the planes that stand on the plate's edges, because the
distance has kinks there, and every panel is halved until it is no longer than its distance from the plate.
"""

import subprocess
from pathlib import Path
from typing import NamedTuple

import mpmath
import numpy as np
import numpy.typing as npt
import pytest

from tests.by_night import all_but
from tests.waiting import DEADLINE

PROGRAM = Path(__file__).resolve().parents[3] / "build" / "bin" / "plate_integral_stress"

Vector = tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]

DIGITS = 40
# Sums of some thousand terms in extended precision, and coordinates that cancel close to the plate's edges.
TOLERANCE = 1e-15
PER_CLASS = 2
# Where the lines pass along the plate at the distance of rounding, one triangle takes as many panels as a class elsewhere.
SLOW = ("touching-plate", "touching-edge", "touching-with-edge", "near-edge")
Extended = np.longdouble
Array = npt.NDArray[np.longdouble]

# Not edge-next-to-edge: where a line passes 1e-18 from the plate it would take panels as short; a closed form stands in for
# it (plate_integral_singular_test.cpp).
FINITE = [
    "random",
    "region-1",
    "region-2",
    "region-3",
    "nine-cells",
    "behind",
    "sliver",
    "parallel",
    "nearly-parallel",
    "near-plate",
    "near-edge",
    "near-corner",
    "passing-closely",
    "touching-plate",
    "touching-edge",
    "touching-corner",
    "touching-with-edge",
    "far",
    "one-kilometre-away",
    "one-micrometre",
    "huge",
    "in-the-plane",
    "edge-in-border-plane",
    "in-border-plane",
    "plane-through-corner",
    "plane-through-edge",
]


class Case(NamedTuple):
    triangle: list[Vector]
    corner: Vector
    edge_u: Vector
    edge_v: Vector
    truth: mpmath.mpf


def cases(name: str) -> list[Case]:
    count = 1 if name in SLOW else PER_CLASS
    command = [str(PROGRAM), "--only-truth", "--classes", name, "--count", str(count), "--seed", "11"]
    lines = subprocess.run(
        command, capture_output=True, text=True, check=True, timeout=DEADLINE
    ).stdout.splitlines()
    assert len(lines) == count
    return [parsed(line, name) for line in lines]


def parsed(line: str, name: str) -> Case:
    of_class, *numbers, truth = line.split()
    assert of_class == name
    assert len(numbers) == 18
    exact = [mpmath.mpf(float.fromhex(number)) for number in numbers]
    vectors: list[Vector] = [(exact[i], exact[i + 1], exact[i + 2]) for i in range(0, 18, 3)]
    corner, edge_u, edge_v = vectors[3:]
    return Case(vectors[:3], corner, edge_u, edge_v, mpmath.mpf(truth))


def dot(a: Vector, b: Vector) -> mpmath.mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a: Vector, factor: mpmath.mpf) -> Vector:
    return (factor * a[0], factor * a[1], factor * a[2])


def length(a: Vector) -> mpmath.mpf:
    return mpmath.sqrt(dot(a, a))


def extended(number: mpmath.mpf) -> np.longdouble:
    high = float(number)
    return Extended(high) + Extended(float(number - high))


def as_array(vector: Vector) -> Array:
    return np.array([extended(component) for component in vector])


def gauss_legendre(points: int) -> tuple[Array, Array]:
    """Nodes and weights on [-1, 1]."""
    nodes, weights = [], []
    with mpmath.workdps(DIGITS):
        for start in np.polynomial.legendre.leggauss(points)[0]:
            x = mpmath.findroot(lambda x: mpmath.legendre(points, x), mpmath.mpf(float(start)))
            slope = points * mpmath.legendre(points - 1, x) / (1 - x * x)
            nodes.append(extended(x))
            weights.append(extended(2 / ((1 - x * x) * slope * slope)))
    return np.array(nodes), np.array(weights)


# A panel no longer than its distance from the plate leaves 2.4^-48; where kinks lie close, more.
NODES, WEIGHTS = gauss_legendre(24)
# A panel this short adds nothing to an integral whose integrand is bounded.
SHORTEST = Extended(1e-17)
# Closer to a vertex on the plate, the distance has lost the digits that tell how fast it grows.
CLOSEST = Extended(1e-9)


class Plate:
    """The rectangle in coordinates of its own, and distances to it."""

    def __init__(self, case: Case) -> None:
        self.lengths = (length(case.edge_u), length(case.edge_v))
        normal = cross(case.edge_u, case.edge_v)
        u, n = scaled(case.edge_u, 1 / self.lengths[0]), scaled(normal, 1 / length(normal))
        self.axes = (u, cross(n, u), n)
        self.bounds = [(Extended(0), extended(side)) for side in self.lengths]

    def local(self, point: Vector) -> Vector:
        return (dot(self.axes[0], point), dot(self.axes[1], point), dot(self.axes[2], point))

    def distance(self, points: Array) -> Array:
        beside = [points[..., i] - np.clip(points[..., i], *self.bounds[i]) for i in range(2)]
        return np.sqrt(beside[0] ** 2 + beside[1] ** 2 + points[..., 2] ** 2)

    def crossings(self, start: Array, step: Array) -> list[np.longdouble]:
        """Where start + s step, 0 < s < 1, crosses the planes that stand on the edges; with the ends 0 and 1."""
        shares = [
            (bound - start[axis]) / step[axis]
            for axis in range(2)
            for bound in self.bounds[axis]
            if step[axis]
        ]
        return sorted([Extended(0), Extended(1), *(s for s in shares if 0 < s < 1)])


class Sweep:
    """The triangle swept by lines from its vertex nearest to the plate to the opposite edge."""

    def __init__(self, case: Case) -> None:
        self.plate = Plate(case)
        vertices = [self.plate.local(minus(vertex, case.corner)) for vertex in case.triangle]
        nearest = int(np.argmin([self.plate.distance(as_array(vertex)) for vertex in vertices]))
        apex, base, end = (vertices[(nearest + i) % 3] for i in range(3))
        # Differences first, rounding after: far from the plate's corner a triangle may be small.
        self.apex, self.to_base, self.edge = (
            as_array(apex),
            as_array(minus(base, apex)),
            as_array(minus(end, base)),
        )
        self.edge_length = np.sqrt(np.sum(self.edge**2))
        self.doubled_area = length(cross(minus(base, apex), minus(end, apex)))

    def line(self, t: np.longdouble) -> tuple[np.longdouble, np.longdouble]:
        """The integral of s/distance along a line, and the smallest distance/s on it."""
        step = self.to_base + t * self.edge
        speed = np.sqrt(np.sum(step**2))
        ends = np.array(self.plate.crossings(self.apex, step))
        low, high = ends[:-1], ends[1:]
        done: list[tuple[Array, Array]] = []
        while low.size:
            middle, width = (low + high) / 2, high - low
            distance = self.plate.distance(self.apex + middle[:, None] * step)
            fine = (width * speed <= distance) | (width < SHORTEST)
            done.append((middle[fine], width[fine]))
            low, middle, high = low[~fine], middle[~fine], high[~fine]
            low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        middles, widths = (np.concatenate(parts) for parts in zip(*done))
        s = middles[:, None] + widths[:, None] / 2 * NODES
        distances = self.plate.distance(self.apex + s[..., None] * step)
        return np.sum(widths[:, None] / 2 * WEIGHTS * s / distances), np.min((distances / s)[s > CLOSEST])

    def corner_lines(self) -> list[np.longdouble]:
        """The lines that pass over a corner of the plate: the integral along them has kinks there."""
        found = []
        for x in self.plate.bounds[0]:
            for y in self.plate.bounds[1]:
                to_x, to_y = x - self.apex[0], y - self.apex[1]
                slope = self.edge[0] * to_y - self.edge[1] * to_x
                if slope:
                    found.append((self.to_base[1] * to_x - self.to_base[0] * to_y) / slope)
        return [t for t in found if 0 < t < 1]

    def parallel_lines(self) -> list[np.longdouble]:
        """Where a line, continued, becomes parallel to a border plane: the point where it crosses has a pole there."""
        return [
            -self.to_base[axis] / self.edge[axis]
            for axis in range(2)
            if self.edge[axis] and self.apex[axis] not in self.plate.bounds[axis]
        ]

    def integral(self) -> mpmath.mpf:
        ends = sorted([*self.plate.crossings(self.apex + self.to_base, self.edge), *self.corner_lines()])
        panels = list(zip(ends, ends[1:]))
        total = Extended(0)
        while panels:
            low, high = panels.pop()
            middle, width = (low + high) / 2, high - low
            near = width * self.edge_length > self.line(middle)[1]
            if width > SHORTEST and (near or any(abs(middle - t) < width for t in self.parallel_lines())):
                panels += [(low, middle), (middle, high)]
            else:
                values = [self.line(middle + width / 2 * node)[0] for node in NODES]
                total += width / 2 * np.sum(WEIGHTS * np.array(values))
        high_part = float(total)
        return self.doubled_area * (mpmath.mpf(high_part) + float(total - Extended(high_part)))


@pytest.mark.parametrize("name", all_but(["near-plate", "touching-plate"], FINITE))
def test_truth_agrees_with_mpmath(name: str) -> None:
    with mpmath.workdps(DIGITS):
        for case in cases(name):
            assert abs(Sweep(case).integral() / case.truth - 1) <= TOLERANCE


@pytest.mark.parametrize(("name", "expected"), [("no-area", 0), ("crossing", "inf"), ("on-the-plate", "inf")])
def test_truth_of_what_has_no_area_or_touches_the_plate(name: str, expected: str) -> None:
    assert [case.truth for case in cases(name)] == [mpmath.mpf(expected)] * PER_CLASS
