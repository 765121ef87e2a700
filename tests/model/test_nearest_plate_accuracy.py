"""The division among nearest plates against multiprecision quadrature of 1/min d, d the clamped distances themselves.

A triangle is swept by lines parallel to one of its edges. Along a line each squared distance is a piecewise quadratic
polynomial; between the zeros that end its pieces, and those of the differences of any two, the integrand is smooth, and
Gauss-Legendre quadrature in 25 digits integrates it. Across the lines, quadrature is halved until two orders agree.
"""

import itertools
from collections.abc import Callable
from pathlib import Path

import pytest
from mpmath import mp, mpf

import fringe
from tests.by_night import all_but

Vector = tuple[mpf, mpf, mpf]
VACUUM_PERMITTIVITY = mpf("8.8541878128e-12")

# Corner, edge_u, edge_v of each plate, and the triangle's vertices, in units that scene files hold exactly.
CASES = {
    "at an angle": (
        [((0, 0, 0), (1, 0, 0), (0, 1, 0)), ((1.25, 0, 0), (0.75, 0, 1), (0, 1, 0))],
        [(-0.5, -0.25, 0.5), (2.0, 0.5, 1.25), (0.5, 1.5, 0.75)],
    ),
    "at different heights": (
        [((0, 0, 0), (1, 0, 0), (0, 1, 0)), ((1.25, 0.25, 0.25), (1, 0, 0), (0, 0.5, 0))],
        [(-0.25, -0.5, 0.75), (2.5, 0.25, 0.5), (1.0, 1.75, 1.0)],
    ),
    "three around": (
        [
            ((0, 0, 0), (1, 0, 0), (0, 1, 0)),
            ((2, 0, 0.5), (0, 1, 0), (0, 0, 1)),
            ((0, 2, 0.25), (1, 0, 0), (0, 0, 1)),
        ],
        [(0.25, 0.25, 0.75), (1.75, 0.5, 1.5), (0.5, 1.75, 1.0)],
    ),
}

Case = tuple[list[tuple[tuple[float, ...], ...]], list[tuple[float, ...]]]


def dot(a: Vector, b: Vector) -> mpf:
    return sum((x * y for x, y in zip(a, b, strict=True)), mpf(0))


def combine(a: Vector, b: Vector, share: mpf) -> Vector:
    return tuple(x + share * (y - x) for x, y in zip(a, b, strict=True))


def squared_distance(plate: list[Vector], point: Vector) -> mpf:
    corner, edge_u, edge_v = plate
    away = tuple(x - y for x, y in zip(point, corner, strict=True))
    for edge in (edge_u, edge_v):
        share = min(max(dot(away, edge) / dot(edge, edge), mpf(0)), mpf(1))
        away = tuple(x - share * y for x, y in zip(away, edge, strict=True))
    return dot(away, away)


def roots_of_parabola(values: tuple[mpf, mpf, mpf]) -> list[mpf]:
    """The zeros in (0, 1) of the quadratic polynomial with these values at 0, 1/2 and 1."""
    start, middle, end = values
    a, b, c = 2 * (start + end) - 4 * middle, 4 * middle - 3 * start - end, start
    if abs(a) < mpf(10) ** -20:
        roots = [] if b == 0 else [-c / b]
    else:
        square = b * b - 4 * a * c
        roots = [] if square < 0 else [(-b + sign * mp.sqrt(square)) / (2 * a) for sign in (1, -1)]
    return [root for root in roots if 0 < root < 1]


def pieces(ends: list[mpf]) -> list[tuple[mpf, mpf]]:
    return list(itertools.pairwise(sorted({mpf(0), mpf(1), *ends})))


def along_line(plates: list[list[Vector]], a: Vector, b: Vector, rule: list[tuple[mpf, mpf]]) -> mpf:
    """The integral of 1/min d over the segment from a to b, divided by its length."""
    borders = []
    for corner, *edges in plates:
        for edge in edges:
            start, end = (
                dot(tuple(x - y for x, y in zip(point, corner, strict=True)), edge) / dot(edge, edge)
                for point in (a, b)
            )
            borders += [(bound - start) / (end - start) for bound in (0, 1) if start != end]
    ends = [share for share in borders if 0 < share < 1]
    for low, high in pieces(list(ends)):
        for one, other in itertools.combinations(plates, 2):
            points = [combine(a, b, low + (high - low) * share) for share in (mpf(0), mpf(1) / 2, mpf(1))]
            first, second, third = (squared_distance(one, p) - squared_distance(other, p) for p in points)
            ends += [low + (high - low) * root for root in roots_of_parabola((first, second, third))]
    total = mpf(0)
    for low, high in pieces(ends):
        for node, weight in rule:
            point = combine(a, b, low + (high - low) * node)
            total += (high - low) * weight / mp.sqrt(min(squared_distance(plate, point) for plate in plates))
    return total


def gauss_rule(points: int) -> list[tuple[mpf, mpf]]:
    """Gauss-Legendre on [0, 1]."""
    rule = []
    for root in mp.polyroots(
        mp.taylor(lambda x: mp.legendre(points, x), 0, points)[::-1], maxsteps=500, extraprec=100
    ):
        slope = mp.diff(lambda x: mp.legendre(points, x), root)
        rule.append(((1 + root) / 2, 1 / ((1 - root**2) * slope**2)))
    return rule


def adaptive(
    function: Callable[[mpf], mpf],
    low: mpf,
    high: mpf,
    rules: tuple[list[tuple[mpf, mpf]], ...],
    allowed: mpf,
) -> mpf:
    coarse, fine = (
        (high - low) * sum(weight * function(low + (high - low) * node) for node, weight in rule)
        for rule in rules
    )
    if abs(fine - coarse) <= allowed:
        return fine
    middle = (low + high) / 2
    return adaptive(function, low, middle, rules, allowed / 2) + adaptive(
        function, middle, high, rules, allowed / 2
    )


def truth(case: Case, accuracy: float) -> mpf:
    """The integral of 1/min d over the triangle, in units of length."""
    plates = [[tuple(map(mpf, vector)) for vector in plate] for plate in case[0]]
    apex, left, right = (tuple(map(mpf, vertex)) for vertex in case[1])
    edges = [tuple(x - y for x, y in zip(end, apex, strict=True)) for end in (left, right)]
    twice_area = mp.sqrt(dot(edges[0], edges[0]) * dot(edges[1], edges[1]) - dot(edges[0], edges[1]) ** 2)
    inner = gauss_rule(10)

    def across(share: mpf) -> mpf:
        return share * along_line(plates, combine(apex, left, share), combine(apex, right, share), inner)

    return twice_area * adaptive(across, mpf(0), mpf(1), (gauss_rule(4), gauss_rule(7)), mpf(accuracy))


def scene_of(case: Case, folder: Path) -> fringe.Scene:
    mesh = "".join(f"v {x} {y} {z}\n" for x, y, z in case[1]) + "f 1 2 3\n"
    (folder / "triangle.obj").write_text(mesh)
    plates = ", ".join(
        f"{{ corner = {list(corner)}, edge_u = {list(edge_u)}, edge_v = {list(edge_v)} }}"
        for corner, edge_u, edge_v in case[0]
    )
    path = folder / "scene.toml"
    path.write_text(
        f'[[sensor]]\nname = "s"\nplates = [ {plates} ]\n'
        '[[object]]\nname = "o"\nshape = { type = "mesh", file = "triangle.obj" }\n'
    )
    return fringe.Scene.load(path)


@pytest.mark.parametrize("name", all_but(["at an angle"], CASES))
def test_the_nearest_plate_counts(name: str, tmp_path: Path) -> None:
    accuracy = 1e-9
    with mp.workdps(25):
        expected = truth(CASES[name], accuracy)
        scene = scene_of(CASES[name], tmp_path)
        for tolerance, slack in ((0.0, 1e-12), (1e-4, 1e-4)):
            (target,) = scene.capacitance("exact+nearest", tolerance=tolerance)["sensors"][0]["objects"]
            found, bound = (mpf(target[key]) / VACUUM_PERMITTIVITY for key in ("capacitance", "bound"))
            print(f"{name}, tolerance {tolerance}: error {float(found / expected - 1):.1e}")
            assert bound <= slack * expected
            assert found <= expected + 2 * accuracy
            assert expected <= found + bound + 2 * accuracy
