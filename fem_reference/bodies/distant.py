"""Leaves out bodies that are too far away to matter, with a bound on what they would have changed: NUMERICS.md section 10."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.bodies.shapes import Body, bounding_sphere
from fem_reference.bodies.distances import gap_to_walls
from fem_reference.bodies.round_bodies import Sphere
from fem_reference.bodies.conductors import Conductors, scaled
from geometries.common.arrays import Array

SHARE = 0.1
"""Share of the requested accuracy that all bodies left out may use up together."""
DISC = 4.0
"""Capacitance of a disc over ε times its diameter. Every body contains a disc as wide as its `size`, so that no conductor has less."""


@dataclass(frozen=True)
class LeftOut:
    """A body that is left out; it would add at most `bound` (n,), in farads, to the entry M[i, i] of each row."""

    name: str
    bound: Array


def without_distant(
    problem: Conductors, permittivity: float, rtol: float
) -> tuple[Conductors, tuple[LeftOut, ...]]:
    """The problem without bodies that together change no M[i, i] by more than SHARE·`rtol` of itself, and these bodies.

    `permittivity` (F/m) is the medium's. Conductors with a row stay, and so do dielectric bodies of a permittivity below the medium's.
    """
    names = dict(enumerate([*problem.names, *problem.floating, *problem.grounded]))
    names |= {len(names) + k: body.name for k, body in enumerate(problem.dielectrics)}
    first_dielectric = problem.driven + len(problem.grounded)
    less_permittive = {
        first_dielectric + k for k, body in enumerate(problem.dielectrics) if body.contrast < 1
    }
    chosen = set(range(len(problem.names), len(names))) - less_permittive
    largest = [max(problem.bodies[k].size for k in problem.bodies_of(i)) for i in range(len(problem.names))]
    allowed = SHARE * rtol * DISC * np.array(largest)
    while chosen:
        bounds = {number: _bound(problem, number, chosen) for number in sorted(chosen)}
        if np.all(sum(bounds.values()) <= allowed):
            farads = permittivity * problem.unit
            left = tuple(LeftOut(names[number], farads * bound) for number, bound in bounds.items())
            return _without(problem, chosen), left
        chosen.remove(max(bounds, key=lambda number: float(np.max(bounds[number] / allowed))))
    return problem, ()


def is_negligible(bound: Array, maxwell: Array, of_changes: Array, changes: Array, rtol: float) -> bool:
    """Whether changes of M[i, i] by `bound` (n,) change every entry by at most SHARE·`rtol` of itself.

    The same is asked of `changes` (m,), delta_self and those of readings, to which the bodies left out add at most `of_changes`.
    """
    within_entries = np.sqrt(np.outer(bound, bound)) <= SHARE * rtol * np.abs(maxwell)
    within_changes = of_changes <= SHARE * rtol * np.abs(changes)
    return bool(within_entries.all() and within_changes.all())


def _bound(problem: Conductors, number: int, left_out: Collection[int]) -> Array:
    """The most that number `number` may add to M[i, i] (n,), for ε = 1, when those `left_out` are absent or grounded."""
    own = [problem.bodies[k] for k in problem.bodies_of(number)]
    centre, radius = _ball(own)
    gap = np.inf if problem.room is None else gap_to_walls(Sphere("ball", centre, radius), problem.room)
    for k, body in enumerate(problem.bodies):
        if problem.owner[k] != number:
            other, reach = _ball([body])
            gap = min(gap, float(np.linalg.norm(other - centre)) - reach - radius)
    if gap <= 0:
        return np.full(len(problem.names), np.inf)
    highest = np.array(
        [_highest_potential(problem, i, left_out, centre, radius) for i in range(len(problem.names))]
    )
    return np.asarray(highest**2 * 4 * np.pi * radius * (1 + radius / gap))


def _highest_potential(
    problem: Conductors, driven: int, left_out: Collection[int], centre: Array, radius: float
) -> float:
    """Bound on the potential in a ball (centre, radius) with one conductor at 1 V and the other ones grounded."""
    # Floating and dielectric bodies transmit the potential of the driven conductor, and so count as parts of it.
    first_dielectric = problem.driven + len(problem.grounded)
    lifted = [
        body
        for body, own in zip(problem.bodies, problem.owner)
        if own == driven
        or (own not in left_out and (len(problem.names) <= own < problem.driven or own >= first_dielectric))
    ]
    middle, reach = _ball(lifted)
    away = float(np.linalg.norm(middle - centre)) - radius
    return min(1.0, reach / away) if away > 0 else 1.0


def _ball(bodies: Sequence[Body]) -> tuple[Array, float]:
    """Centre (3,) and radius of a ball that contains these bodies."""
    if len(bodies) == 1 and isinstance(bodies[0], Sphere):
        return bodies[0].centre, bodies[0].radius
    return bounding_sphere(bodies)


def _without(problem: Conductors, numbers: Collection[int]) -> Conductors:
    """The problem without the bodies of these numbers, scaled anew."""
    kept = [k for k, own in enumerate(problem.owner) if own not in numbers]
    floating, grounded = len(problem.names), problem.driven
    dielectric = grounded + len(problem.grounded)
    remaining = sorted(set(range(dielectric + len(problem.dielectrics))) - set(numbers))
    renumbered = {number: k for k, number in enumerate(remaining)}
    other_sensors = range(grounded, grounded + problem.grounded_sensors)
    fewer = replace(
        problem,
        bodies=tuple(problem.bodies[k] for k in kept),
        owner=tuple(renumbered[problem.owner[k]] for k in kept),
        floating=tuple(name for k, name in enumerate(problem.floating, floating) if k not in numbers),
        to_ground=tuple(c for k, c in enumerate(problem.to_ground, floating) if k not in numbers),
        grounded=tuple(name for k, name in enumerate(problem.grounded, grounded) if k not in numbers),
        grounded_sensors=sum(k not in numbers for k in other_sensors),
        dielectrics=tuple(body for k, body in enumerate(problem.dielectrics, dielectric) if k not in numbers),
    )
    return scaled(fewer)
