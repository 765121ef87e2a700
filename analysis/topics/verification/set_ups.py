"""The set-ups of the verification: those with known capacitances. One is solved in a process of its own: python3 -m analysis.topics.verification.set_ups ROW
prints JSON."""

import argparse
import itertools
import json
import logging
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from scipy.constants import epsilon_0

from analysis.topics.verification import truths
from fem_reference.answer.reference import ErrorKind, Reference, solve_conductors
from fem_reference.bodies.conductors import Conductors, Dielectric, scaled
from fem_reference.bodies.round_bodies import Cone, Cylinder, Sphere
from fem_reference.bodies.shapes import Body, Cuboid, Disc, Rectangle, rectangle
from geometries.common.arrays import Array
from geometries.scene.poses import AxisRotation

UNIT = 4 * np.pi * epsilon_0


@dataclass(frozen=True)
class SetUp:
    """Bodies, each a conductor unless said otherwise in `more`, the attributes of `Conductors` for those that float or are dielectric."""

    bodies: tuple[Body, ...]
    names: tuple[str, ...]
    sensors: int = 1
    more: dict[str, Any] = field(default_factory=dict)
    owner: tuple[int, ...] = ()
    """Which conductor each body is a part of; none: each is one."""

    def conductors(self) -> Conductors:
        owner = self.owner or tuple(range(len(self.bodies)))
        return scaled(Conductors(self.names, self.sensors, self.bodies, owner, **self.more))


@dataclass(frozen=True)
class Quantity:
    """A quantity: the function `of` the Maxwell matrix (F), monotone in every entry, with its true value (F) and relative error.
    Without `of` it is the first sensor's delta_self."""

    name: str
    of: Callable[[Array], float] | None
    truth: float
    truth_error: float


@dataclass(frozen=True)
class TrueCase:
    """A set-up with quantities that are known. With `longer`, the same with bodies twice and three times as long, the
    quantity is per length of infinitely long ones."""

    name: str
    source: str
    set_up: SetUp
    quantities: tuple[Quantity, ...]
    error: ErrorKind = "enclosure"
    length: float = 0.0
    longer: tuple[SetUp, ...] = ()


def plate(
    name: str, centre: Sequence[float], half_widths: tuple[float, float], tilt: float = 0.0
) -> Rectangle:
    """Returns a plate turned by `tilt` degrees about its own y axis."""
    axes = AxisRotation((0.0, 1.0, 0.0), -tilt).matrix().T
    return Rectangle(name, np.array(centre, dtype=float), axes, half_widths)


def pair(first: Body, second: Body, **more: Any) -> SetUp:
    return SetUp((first, second), (first.name, second.name), **more)


def entry(i: int, j: int) -> Callable[[Array], float]:
    return lambda maxwell: float(maxwell[i, j])


def opposite(maxwell: Array) -> float:
    """Returns the charge of the first of two equal conductors at 1 V and −1 V."""
    return float(maxwell[0, 0] - maxwell[0, 1])


@cache
def true_cases() -> dict[str, TrueCase]:
    """Returns every case whose truth is known without finite elements, by name."""
    of_plates = (_discs, _squares, _strips)
    builders = (_single_bodies, *of_plates, _balls, _sphere_and_plane, _boundary_elements, _rooms)
    return {case.name: case for builder in builders for case in builder()}


def _single_bodies() -> Iterator[TrueCase]:
    turned = AxisRotation((1.0, 2.0, -0.5), 33.0).matrix().T
    cylinder = truths.body_of_revolution([(0, -1), (1, -1), (1, 1), (0, 1)])
    cone = truths.body_of_revolution([(0, -0.5), (1, -0.5), (0, 0.5)])
    rings = "rings of charge, extrapolated"
    found: list[tuple[str, str, Body, float, float]] = [
        ("square plate", "two boundary-element computations", plate("plate", (0, 0, 0), (0.5, 0.5)),
         truths.UNIT_SQUARE_PLATE, truths.UNIT_SQUARE_PLATE_ERROR),
        ("cube", "Helsing & Perfekt 2013", Cuboid("cube", np.zeros(3), np.eye(3), (0.5, 0.5, 0.5)), truths.UNIT_CUBE, 1e-12),
        ("sphere", "its radius", Sphere("sphere", np.zeros(3), 1.0), 1.0, 0.0),
        ("cylinder", rings, Cylinder("cylinder", np.zeros(3), turned, 1.0, 2.0), cylinder, 1e-6),
        ("cone", rings, Cone("cone", np.zeros(3), turned, 1.0, 1.0), cone, 1e-6),
    ]  # fmt: skip
    for name, source, body, truth, error in found:
        known = Quantity("C11", entry(0, 0), UNIT * truth, error)
        # The apex of a cone needs so many curved cells that an enclosure takes minutes.
        kind: ErrorKind = "estimate" if isinstance(body, Cone) else "enclosure"
        yield TrueCase(name, source, SetUp((body,), (body.name,)), (known,), kind)


def _discs() -> Iterator[TrueCase]:
    for gap in (0.1, 0.2, 0.5, 1.0, 2.0):
        lower = Disc("lower", np.zeros(3), np.eye(3), 1.0)
        upper = Disc("upper", np.array([0, 0, gap]), np.eye(3), 1.0)
        known = Quantity("two-terminal C", truths.two_terminal, UNIT * truths.love(gap), 1e-9)
        name = f"coaxial discs, gap/radius {gap:g}"
        yield TrueCase(name, "Love's integral equation", pair(lower, upper), (known,))


def _squares() -> Iterator[TrueCase]:
    for gap, value in truths.PARALLEL_SQUARES.items():
        truth = epsilon_0 / gap * value
        known = Quantity("two-terminal C", truths.two_terminal, truth, truths.PARALLEL_SQUARES_ERROR)
        squares = pair(plate("lower", (0, 0, 0), (0.5, 0.5)), plate("upper", (0, 0, gap), (0.5, 0.5)))
        yield TrueCase(f"parallel squares, gap/side {gap:g}", "boundary elements", squares, (known,))


STRIP_LENGTH = 2.0
"""Length of the shortest strips relative to their width."""


def _strips() -> Iterator[TrueCase]:
    for ratio in (1.0, 5.0):
        first, *longer = (
            pair(
                plate("lower", (0, 0, 0), (0.5, factor * STRIP_LENGTH / 2)),
                plate("upper", (0, 0, 1 / ratio), (0.5, factor * STRIP_LENGTH / 2)),
            )
            for factor in (1, 2, 3)
        )
        known = (Quantity("C per length", truths.two_terminal, epsilon_0 * truths.strips(ratio), 1e-9),)
        name, source = f"facing strips, width/gap {ratio:g}", "elliptic integrals"
        yield TrueCase(name, source, first, known, "estimate", STRIP_LENGTH, tuple(longer))


def _balls() -> Iterator[TrueCase]:
    """Yields balls of 1 and 2 cm, centres 5 cm apart; the second grounded, floating, or dielectric."""
    bodies = (Sphere("first", np.zeros(3), 0.01), Sphere("second", np.array([0.03, 0.0, 0.04]), 0.02))
    entries = zip(("C11", "C22", "C12"), ((0, 0), (1, 1), (0, 1)), truths.LEKNER)
    known = tuple(Quantity(name, entry(*place), truth, 1e-9) for name, place, truth in entries)
    yield TrueCase("balls of radii 1 and 2, gap 2", "Lekner 2011", pair(*bodies), known)
    answers: list[tuple[str, Callable[[int], float], dict[str, Any]]] = [
        ("floating", truths.floating, {"floating": ("second",)}),
        ("of permittivity 5", truths.dielectric(5.0), {"dielectrics": (Dielectric("second", 5.0, 5.0),)}),
        ("of permittivity 0.2", truths.dielectric(0.2), {"dielectrics": (Dielectric("second", 0.2, 0.2),)}),
    ]  # fmt: skip
    for words, answer, more in answers:
        value, _ = truths.two_balls(0.01, 0.02, 0.05, answer)
        own = Quantity("C11", entry(0, 0), UNIT * value, 1e-12)
        change = Quantity("delta_self", None, UNIT * (value - 0.01), 1e-12)
        set_up = SetUp(bodies, ("first",), more=more)
        yield TrueCase(f"the same, the second {words}", "multipoles", set_up, (own, change))


def _sphere_and_plane() -> Iterator[TrueCase]:
    """Yields a sphere and its mirror image at opposite potentials."""
    for gap in (1.0, 0.5, 0.1, 0.01):
        balls = (Sphere("sphere", np.zeros(3), 1.0), Sphere("image", np.array([0, 0, 2 * (1 + gap)]), 1.0))
        known = Quantity("C to the plane", opposite, UNIT * truths.sphere_and_plane(gap), 1e-12)
        yield TrueCase(f"sphere and plane, gap/radius {gap:g}", "series", pair(*balls), (known,))


def _boundary_elements() -> Iterator[TrueCase]:
    for case in truths.stored("boundary_elements"):
        bodies = tuple(
            rectangle(part["conductor"], *(np.array(part[key]) for key in ("corner", "edge_u", "edge_v")))
            for part in case["rectangles"]
        )
        names = tuple(case["conductors"])
        set_up = SetUp(bodies, names, sum(name.startswith("sensor") for name in names))
        yield TrueCase(case["name"].replace("_", " "), "boundary elements", set_up, _entries(case))


def _rooms() -> Iterator[TrueCase]:
    """Plates in a room, with no plane of symmetry to three, against their mirror images. Estimates are tried in every other one."""
    for number, case in enumerate(truths.stored("rooms")):
        bodies = [
            plate(f"plate {k + 1}", part["centre"], (part["half_widths"][0], part["half_widths"][1]))
            for k, parts in enumerate(case["plates"])
            for part in parts
        ]
        owner = [k for k, parts in enumerate(case["plates"]) for _ in parts]
        low, high = np.array(case["low"], dtype=float), np.array(case["high"], dtype=float)
        a, b, c = map(float, (high - low) / 2)
        room = Cuboid("room", (low + high) / 2, np.eye(3), (a, b, c))
        names = tuple(f"plate {k + 1}" for k in range(len(case["plates"])))
        set_up = SetUp(tuple(bodies), names, more={"room": room}, owner=tuple(owner))
        kind: ErrorKind = "estimate" if number % 2 else "enclosure"
        yield TrueCase(case["name"], "boundary elements of mirror images", set_up, _entries(case), kind)


def _entries(case: dict[str, Any]) -> tuple[Quantity, ...]:
    """Every entry of a symmetric matrix, known to a relative error."""
    matrix, error = 1e-12 * np.array(case["maxwell_pF"]), case["relative_error"]
    places = itertools.combinations_with_replacement(range(len(matrix)), 2)
    return tuple(Quantity(f"C{i + 1}{j + 1}", entry(i, j), matrix[i, j], error) for i, j in places)


Document = dict[str, Any]
TRUTH_RTOL = 1e-3
"""The accuracy that the reference aims at by default."""


def solve_row(case: TrueCase) -> Document:
    """Computes the document of one row."""
    conductors = (set_up.conductors() for set_up in (case.set_up, *case.longer))
    found = [solve_conductors(each, rtol=TRUTH_RTOL, error=case.error) for each in conductors]
    quantities = [
        _per_length(quantity, found, case.length) if case.longer else compared(quantity, found[0])
        for quantity in case.quantities
    ]
    return {
        "kind": case.error,
        "source": case.source,
        "seconds": sum(answer.seconds for answer in found),
        "unknowns": max(level.unknowns for answer in found for level in answer.levels),
        "edge_sizes": [level.edge_size for level in found[0].levels],
        "curved": bool(found[0].problem.curved),
        "quantities": quantities,
    }


def compared(quantity: Quantity, found: Reference) -> Document:
    """Returns the truth, the best value with its stated error, the bounds, and the value of every level."""
    described = {"name": quantity.name, "truth": quantity.truth, "truth_error": quantity.truth_error}
    of = quantity.of
    if of is None:
        return described | {
            "value": float(found.delta_self.value[0]),
            "error": float(found.delta_self.error[0]),
            "levels": [float(level.delta_self[0]) for level in found.levels],
        }
    value, error = found.maxwell.value, found.maxwell.error
    document = described | {"value": of(value), "error": carried_error(of, value, error)}
    document["levels"] = [of(level.maxwell) for level in found.levels]
    if found.enclosure is not None:
        document["lower"], document["upper"] = extremes(of, found.enclosure.lower, found.enclosure.upper)
    return document


def _per_length(quantity: Quantity, found: list[Reference], length: float) -> Document:
    """Computes the quantity per length, from bodies of one, two and three times `length`."""
    parts = [compared(quantity, answer) for answer in found]
    value, change = endless([part["value"] for part in parts], length)
    own = [weight * part["error"] for weight, part in zip((0.5, 2.0, 1.5), parts)]
    return parts[0] | {
        "value": value,
        "error": sum(own) / length + abs(change),
        "levels": [endless(values, length)[0] for values in zip(*(part["levels"] for part in parts))],
    }


def endless(values: Sequence[float], length: float) -> tuple[float, float]:
    """Fits c·L + a + b/L to the values at L, 2L and 3L; returns c and the size of b/L, by which the two ends interact."""
    first, second, third = values
    before, last = (second - first) / length, (third - second) / length
    # Without b the two differences would be equal; b lowers the first by b/2L² and the second by b/6L².
    change = (last - before) / 2
    return last + change, change


def carried_error(of: Callable[[Array], float], value: Array, error: Array) -> float:
    """Propagates the errors of a symmetric matrix' entries through a function, to first order, adding their absolute contributions."""
    total = 0.0
    for i, j in itertools.combinations_with_replacement(range(len(value)), 2):
        step = np.zeros_like(value)
        step[i, j] = step[j, i] = error[i, j]
        total += abs(of(value + step) - of(value - step)) / 2
    return total


def extremes(of: Callable[[Array], float], lower: Array, upper: Array) -> tuple[float, float]:
    """Returns the least and greatest value, over intervals of the entries, of a function monotone in every entry of a symmetric matrix."""
    pairs = list(itertools.combinations_with_replacement(range(len(lower)), 2))
    found = []
    for choice in itertools.product((False, True), repeat=len(pairs)):
        corner = lower.copy()
        for (i, j), above in zip(pairs, choice):
            corner[i, j] = corner[j, i] = upper[i, j] if above else lower[i, j]
        found.append(of(corner))
    return min(found), max(found)


def main() -> int:
    program = "python3 -m analysis.topics.verification.set_ups"
    parser = argparse.ArgumentParser(prog=program, description=__doc__)
    parser.add_argument("row", metavar="ROW", choices=list(true_cases()))
    logging.getLogger().setLevel(logging.WARNING)
    print(json.dumps(solve_row(true_cases()[parser.parse_args().row])))
    return 0


if __name__ == "__main__":
    sys.exit(main())
