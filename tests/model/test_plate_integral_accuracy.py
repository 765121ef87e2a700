"""`fringe.plate_integral` against 50-digit quadrature of the clamped distance itself.

The truth uses no closed form. The triangle is cut at the planes that stand on the plate's edges, because the distance has
kinks there; on every piece 1/distance is smooth and a product Gauss-Legendre rule is applied. Two orders must agree to
1e-15, else the piece is cut into four and each is done again.
"""

import random
from collections.abc import Callable, Iterator
from functools import lru_cache

import mpmath
import numpy as np
import pytest

import fringe

Point = tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]
Polygon = list[Point]
Triangle = tuple[Point, Point, Point]

DIGITS = 50
LOW_ORDER, HIGH_ORDER = 16, 24
AGREEMENT = mpmath.mpf("1e-15")
TOLERANCE = 1e-12
SEED = 20240617


@lru_cache
def gauss_legendre(points: int) -> list[tuple[mpmath.mpf, mpmath.mpf]]:
    """Nodes and weights on [0, 1], the roots refined by Newton at full precision."""
    rule = []
    for i in range(points):
        x = mpmath.cos(mpmath.pi * (i + mpmath.mpf(3) / 4) / (points + mpmath.mpf(1) / 2))
        for _ in range(8):
            previous, current = mpmath.mpf(1), x
            for n in range(2, points + 1):
                previous, current = current, ((2 * n - 1) * x * current - (n - 1) * previous) / n
            derivative = points * (x * current - previous) / (x * x - 1)
            x -= current / derivative
        rule.append(((1 + x) / 2, 1 / ((1 - x * x) * derivative**2)))
    return rule


def between(a: Point, b: Point, t: mpmath.mpf) -> Point:
    return (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]))


def half(polygon: Polygon, axis: int, bound: mpmath.mpf, sign: int) -> Polygon:
    """The part of a convex polygon where sign * (coordinate - bound) >= 0."""
    kept: Polygon = []
    for current, following in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        here, there = sign * (current[axis] - bound), sign * (following[axis] - bound)
        if here >= 0:
            kept.append(current)
        if here * there < 0:
            kept.append(between(current, following, here / (here - there)))
    return kept


def pieces(triangle: Triangle, lengths: tuple[mpmath.mpf, mpmath.mpf]) -> Iterator[Triangle]:
    """The triangles into which the four planes that stand on the plate's edges cut a triangle."""
    polygons: list[Polygon] = [list(triangle)]
    for axis, length in enumerate(lengths):
        for bound in (mpmath.mpf(0), length):
            polygons = [half(polygon, axis, bound, sign) for polygon in polygons for sign in (-1, 1)]
    for polygon in polygons:
        for i in range(1, len(polygon) - 1):
            yield polygon[0], polygon[i], polygon[i + 1]


def twice_area(triangle: Triangle) -> mpmath.mpf:
    a, b, c = triangle
    u = [b[i] - a[i] for i in range(3)]
    v = [c[i] - a[i] for i in range(3)]
    cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return mpmath.sqrt(sum(x * x for x in cross))


def product_rule(triangle: Triangle, integrand: Callable[[Point], mpmath.mpf], points: int) -> mpmath.mpf:
    """A product Gauss rule on the square that the triangle's first vertex is stretched to."""
    total = mpmath.mpf(0)
    for u, weight_u in gauss_legendre(points):
        start, end = between(triangle[0], triangle[1], u), between(triangle[0], triangle[2], u)
        for v, weight_v in gauss_legendre(points):
            total += weight_u * weight_v * u * integrand(between(start, end, v))
    return twice_area(triangle) * total


def quadrature(triangle: Triangle, integrand: Callable[[Point], mpmath.mpf], depth: int = 0) -> mpmath.mpf:
    low = product_rule(triangle, integrand, LOW_ORDER)
    high = product_rule(triangle, integrand, HIGH_ORDER)
    if abs(high - low) <= AGREEMENT * high:
        return high
    assert depth < 6, "the quadrature does not converge"
    a, b, c = triangle
    middle = mpmath.mpf(1) / 2
    ab, bc, ca = between(a, b, middle), between(b, c, middle), between(c, a, middle)
    quarters = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    return sum((quadrature(quarter, integrand, depth + 1) for quarter in quarters), mpmath.mpf(0))


def truth(triangle: np.ndarray, corner: np.ndarray, edge_u: np.ndarray, edge_v: np.ndarray) -> mpmath.mpf:
    """The integral of 1/(distance to the rectangle) over the triangle, from the doubles as they are."""

    def exact(vector: np.ndarray) -> list[mpmath.mpf]:
        return [mpmath.mpf(float(x)) for x in vector]

    def dot(a: list[mpmath.mpf], b: list[mpmath.mpf]) -> mpmath.mpf:
        return sum((x * y for x, y in zip(a, b, strict=True)), mpmath.mpf(0))

    u, v, origin = exact(edge_u), exact(edge_v), exact(corner)
    normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    axes = [[x / mpmath.sqrt(dot(axis, axis)) for x in axis] for axis in (u, v, normal)]
    lengths = (mpmath.sqrt(dot(u, u)), mpmath.sqrt(dot(v, v)))

    def local(vertex: np.ndarray) -> Point:
        from_corner = [x - y for x, y in zip(exact(vertex), origin, strict=True)]
        return dot(from_corner, axes[0]), dot(from_corner, axes[1]), dot(from_corner, axes[2])

    def inverse_distance(point: Point) -> mpmath.mpf:
        x = point[0] - min(max(point[0], 0), lengths[0])
        y = point[1] - min(max(point[1], 0), lengths[1])
        return 1 / mpmath.sqrt(x * x + y * y + point[2] * point[2])

    vertices = (local(triangle[0]), local(triangle[1]), local(triangle[2]))
    parts = (piece for piece in pieces(vertices, lengths) if twice_area(piece) > mpmath.mpf("1e-40"))
    return sum((quadrature(piece, inverse_distance) for piece in parts), mpmath.mpf(0))


# Regions of a plate of 0.1 m x 0.08 m: ranges of x and y in which the vertices lie. The heights are 0.03 m to 0.12 m.
LENGTHS = (0.1, 0.08)
IN_FRONT = {"x": (0.0, 0.1), "y": (0.0, 0.08)}
BESIDE = {"x": (-0.15, -0.02), "y": (0.0, 0.08)}
DIAGONAL = {"x": (-0.15, -0.02), "y": (0.1, 0.2)}
OVER_AN_EDGE = {"x": (-0.1, 0.08), "y": (0.01, 0.07)}
OVER_A_CORNER = {"x": (-0.1, 0.08), "y": (-0.1, 0.07)}


def random_triangle(
    generator: random.Random, ranges: dict[str, tuple[float, float]], parallel: bool
) -> np.ndarray:
    """Three vertices at random, of ordinary shape: the area is at least a tenth of the longest edge squared."""
    while True:
        heights = [generator.uniform(0.03, 0.12) for _ in range(3)]
        vertices = np.array(
            [
                [
                    generator.uniform(*ranges["x"]),
                    generator.uniform(*ranges["y"]),
                    heights[0 if parallel else i],
                ]
                for i in range(3)
            ]
        )
        edges = vertices - np.roll(vertices, 1, axis=0)
        longest = max(np.sum(edges**2, axis=1))
        if np.linalg.norm(np.cross(edges[0], edges[1])) / 2 > 0.1 * longest:
            return vertices


def rotation(generator: random.Random) -> np.ndarray:
    """A random rotation, from a random unit quaternion."""
    q = np.array([generator.gauss(0, 1) for _ in range(4)])
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


ALL_NINE = np.array([[-0.2, -0.1, 0.04], [0.35, -0.05, 0.09], [-0.06, 0.3, 0.06]])
ALL_NINE_PARALLEL = np.array([[-0.2, -0.1, 0.05], [0.35, -0.05, 0.05], [-0.06, 0.3, 0.05]])


def cases() -> Iterator[tuple[str, np.ndarray, bool]]:
    """(name, triangle in the plate's frame, whether everything is rotated and moved)"""
    generator = random.Random(SEED)
    classes = {
        "I": IN_FRONT,
        "II": BESIDE,
        "III": DIAGONAL,
        "over an edge": OVER_AN_EDGE,
        "over a corner": OVER_A_CORNER,
    }
    for name, ranges in classes.items():
        for i in range(5):
            yield f"{name} {i}", random_triangle(generator, ranges, parallel=False), i % 2 == 1
        for i in range(2):
            yield f"{name} parallel {i}", random_triangle(generator, ranges, parallel=True), i % 2 == 1
    for moved in (False, True):
        yield f"nine cells {moved}", ALL_NINE, moved
        yield f"nine cells parallel {moved}", ALL_NINE_PARALLEL, moved


@pytest.mark.parametrize(("name", "triangle", "moved"), [pytest.param(*case, id=case[0]) for case in cases()])
def test_exact_agrees_with_quadrature(name: str, triangle: np.ndarray, moved: bool) -> None:
    corner, edge_u, edge_v = np.zeros(3), np.array([LENGTHS[0], 0, 0]), np.array([0, LENGTHS[1], 0])
    if moved:
        generator = random.Random(name)
        turn, shift = rotation(generator), np.array([generator.uniform(-1, 1) for _ in range(3)])
        triangle, corner = triangle @ turn.T + shift, shift
        edge_u, edge_v = turn @ edge_u, turn @ edge_v
    with mpmath.workdps(DIGITS):
        expected = truth(triangle, corner, edge_u, edge_v)
        computed = fringe.plate_integral(triangle[None], corner, edge_u, edge_v)[0]
        error = abs(mpmath.mpf(float(computed)) - expected) / expected
    print(f"{name}: relative error {float(error):.1e}")
    assert error <= TOLERANCE
