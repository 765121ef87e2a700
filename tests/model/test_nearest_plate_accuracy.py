"""The division among nearest plates against multiprecision quadrature of 1/min d, d the clamped distances themselves.

The truths were computed in 25 digits: a triangle is swept by lines parallel to one of its edges. Along a line each squared distance is a
piecewise quadratic polynomial; between the zeros that end its pieces, and those of the differences of any two, the integrand is smooth, and
Gauss-Legendre quadrature integrates it. Across the lines, quadrature was halved until two orders agreed to 1e-10.
"""

from pathlib import Path

import fringe
import pytest

from tests import scenes

VACUUM_PERMITTIVITY = 8.8541878128e-12
ACCURACY = 1e-10
Points = list[list[float]]

# Corner, edge_u, edge_v of each plate, the triangle's vertices, and the integral of 1/min d over it, in units of length.
CASES: dict[str, tuple[list[Points], Points, float]] = {
    "at an angle": (
        [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1.25, 0, 0], [0.75, 0, 1], [0, 1, 0]]],
        [[-0.5, -0.25, 0.5], [2.0, 0.5, 1.25], [0.5, 1.5, 0.75]],
        2.8524763962375,
    ),
    "at different heights": (
        [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1.25, 0.25, 0.25], [1, 0, 0], [0, 0.5, 0]]],
        [[-0.25, -0.5, 0.75], [2.5, 0.25, 0.5], [1.0, 1.75, 1.0]],
        4.7494145414129,
    ),
    "three around": (
        [
            [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
            [[2, 0, 0.5], [0, 1, 0], [0, 0, 1]],
            [[0, 2, 0.25], [1, 0, 0], [0, 0, 1]],
        ],
        [[0.25, 0.25, 0.75], [1.75, 0.5, 1.5], [0.5, 1.75, 1.0]],
        1.5607022446218,
    ),
}


@pytest.mark.parametrize(("plates", "triangle", "truth"), CASES.values(), ids=CASES)
def test_the_nearest_plate_counts(
    plates: list[Points], triangle: Points, truth: float, tmp_path: Path
) -> None:
    mesh = "".join(f"v {x} {y} {z}\n" for x, y, z in triangle) + "f 1 2 3\n"
    (tmp_path / "triangle.obj").write_text(mesh)
    text = scenes.sensor("s", *plates) + scenes.body("o", "mesh", file="triangle.obj")
    scene = fringe.Scene.loads(text, tmp_path)
    for tolerance, slack in ((0.0, 1e-12), (1e-4, 1e-4)):
        (target,) = scene.capacitance("exact+nearest", tolerance=tolerance)["sensors"][0]["objects"]
        found, bound = (target[key] / VACUUM_PERMITTIVITY for key in ("capacitance", "bound"))
        assert bound <= slack * truth
        assert found <= truth + 2 * ACCURACY
        assert truth <= found + bound + 2 * ACCURACY
