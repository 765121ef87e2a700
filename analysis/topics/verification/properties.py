"""Properties that hold for any capacitances: reciprocity, symmetry, scaling, motion, monotony, repeatability."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.topics.verification.set_ups import SetUp, alone, hinged, pair, plate, squares
from fem_reference.bodies.shapes import Body, Cuboid, Rectangle
from fem_reference.solve.level import Level, solve_level
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.mesh.size_rules import Sizing
from fem_reference.solve.field_problem import FieldProblem
from fem_reference.bodies.symmetry import mirror_planes
from geometries.scene.poses import AxisRotation

Array = NDArray[np.float64]
ROUNDING = 1e-11
"""Relative rounding error after a few thousand operations, in the same order in the linear solver."""
COARSEST = 2e-3
"""Relative error of a coarsest mesh, by its rule of sizes (`fem_reference/NUMERICS.md`, section 2)."""
COARSEST_WORDS = "a coarsest mesh's own error"
SOLVER = 2e-6
"""Twice the relative residual at which conjugate gradients stop."""


@dataclass(frozen=True)
class Statement:
    """A measured number and its limit."""

    words: str
    measured: float
    allowed: float
    because: str

    def document(self) -> dict[str, Any]:
        return asdict(self)


def _coarse(set_up: SetUp, symmetric: bool = True, enclosed: bool = False) -> Level:
    """Solves on the coarsest mesh; without `symmetric` on the whole of space."""
    problem = set_up.conductors()
    planes = mirror_planes(problem.bodies, problem.owner) if symmetric else ()
    return solve_level(problem, 1.0, Sizing(), "enclosure" if enclosed else "none", planes)


def _difference(first: Array, second: Array) -> float:
    return float(np.max(np.abs(first - second) / np.abs(second)))


def _same(words: str, first: SetUp, second: SetUp, turned: bool = False) -> Statement:
    """Compares two set-ups of one truth, each on its coarsest mesh; `turned`: their conductors are in opposite orders."""
    one, other = _coarse(first, enclosed=True), _coarse(second, enclosed=True)
    assert one.enclosure is not None and other.enclosure is not None
    order = slice(None, None, -1) if turned else slice(None)
    size = np.abs(other.maxwell)
    off = np.abs(one.maxwell[order, order] - other.maxwell) / size
    allowed = (one.enclosure.half_width[order, order] + other.enclosure.half_width) / size
    worst = np.unravel_index(np.argmax(off / allowed), off.shape)
    return Statement(words, float(off[worst]), float(allowed[worst]), "half the widths of both enclosures")


def reciprocity() -> list[Statement]:
    """Checks symmetry on one mesh, where charges are sums of reactions, and on two meshes with sensor and target exchanged."""
    set_up = hinged(0.2, 25.0)
    problem = set_up.conductors()
    field = FieldProblem(tagged_mesh(problem.bodies, problem.owner, Sizing()), problem.parts)
    charges = []
    for potential in field.potentials(range(2), 2):
        source, reaction = field.stiffness.createVecRight(), field.stiffness.createVecLeft()
        source.array[:] = potential
        field.stiffness.mult(source, reaction)
        charges.append([float(reaction.array[own].sum()) for own in field.dofs])
    exchanged = SetUp(set_up.bodies[::-1], set_up.names[::-1])
    asymmetry = abs(charges[0][1] / charges[1][0] - 1)
    words = "charges of one by the other and back, as reactions on one mesh"
    return [
        Statement(words, asymmetry, SOLVER, "twice the linear solver's residual"),
        _same("sensor and target exchanged", exchanged, set_up, turned=True),
    ]


def symmetry() -> list[Statement]:
    """Compares one side of the planes of symmetry with the whole of space, and a set-up with its mirror image."""
    part, whole = (_coarse(squares(0.3), symmetric) for symmetric in (True, False))
    aside, mirrored = (
        pair(
            plate("sensor", (0, 0, 0), (0.5, 0.5)), plate("target", (side * 0.4, side * 0.2, 0.3), (0.5, 0.3))
        )
        for side in (1, -1)
    )
    off = _difference(part.maxwell, whole.maxwell)
    return [
        Statement("a quarter of space against the whole", off, COARSEST, COARSEST_WORDS),
        _same("a set-up and its mirror image", mirrored, aside),
    ]


def scaling() -> list[Statement]:
    """Compares a set-up with one of twice the size, and with one whose size is no power of two, so that coordinates are rounded anew."""
    found = []
    for factor, allowed, because in ((2.0, ROUNDING, "rounding"), (0.037, COARSEST, COARSEST_WORDS)):
        first, second = (
            _coarse(
                pair(
                    plate("a", (0, 0, 0), (0.5 * scale, 0.3 * scale)),
                    plate("b", (0, 0, 0.4 * scale), (0.4 * scale, 0.5 * scale)),
                )
            )
            for scale in (1.0, factor)
        )
        off = _difference(second.maxwell / factor, first.maxwell)
        words = f"{factor:g} times the size, {factor:g} times the capacitances"
        found.append(Statement(words, off, allowed, because))
    return found


def motion() -> list[Statement]:
    """Compares a set-up with itself moved and turned about an axis that is not one of its own."""
    set_up = hinged(0.2, 25.0)
    matrix = AxisRotation((1.0, 2.0, -0.5), 33.0).matrix()
    moved = SetUp(tuple(_moved(body, matrix) for body in set_up.bodies), set_up.names)
    return [_same("turned by 33° about (1, 2, −0.5) and moved", moved, set_up)]


def _moved(body: Body, matrix: Array) -> Body:
    assert isinstance(body, Rectangle)
    centre = matrix @ body.centre + np.array([3.0, -1.0, 0.5])
    return Rectangle(body.name, centre, body.axes @ matrix.T, body.half_widths)


def monotony() -> list[Statement]:
    """Checks that C11 grows with a conductor: the smaller one's upper bound is below the lower bound of the one that contains it."""
    sides = (1.0, 1.03, 1.1)
    plates = [alone(plate(f"plate of {side:g}", (0, 0, 0), (side / 2, side / 2))) for side in sides]
    solids = [
        alone(Cuboid(f"cuboid of 1.1 × 1.1 × {height:g}", np.zeros(3), np.eye(3), (0.55, 0.55, height / 2)))
        for height in (0.1, 0.3)
    ]
    found = []
    levels = [(set_up.names[0], _coarse(set_up, enclosed=True)) for set_up in plates + solids]
    for (smaller, before), (larger, after) in zip(levels, levels[1:]):
        assert before.enclosure is not None and after.enclosure is not None
        ratio = float(before.enclosure.upper[0, 0] / after.enclosure.lower[0, 0])
        words = f"largest C11 of the {smaller} over smallest of the {larger}"
        found.append(Statement(words, ratio, 1.0, "the larger contains the smaller"))
    return found


def repetition() -> list[Statement]:
    """Compares two runs of the same case."""
    first, second = (_coarse(hinged(0.2, 25.0), enclosed=True) for _ in range(2))
    assert first.enclosure is not None and second.enclosure is not None
    off = max(
        _difference(first.maxwell, second.maxwell),
        _difference(first.enclosure.lower, second.enclosure.lower),
        _difference(first.enclosure.upper, second.enclosure.upper),
    )
    return [Statement("the same case solved twice: entries and bounds", off, 0.0, "the same numbers")]


PROPERTIES: dict[str, Callable[[], list[Statement]]] = {
    "reciprocity": reciprocity,
    "symmetry": symmetry,
    "scaling": scaling,
    "motion": motion,
    "monotony": monotony,
    "repetition": repetition,
}
