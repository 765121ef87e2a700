"""Capacitances of round bodies without finite elements: multipoles of two balls, and rings of charge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import comb, ellipkm1

Array = NDArray[np.float64]

ORDERS = 60
"""Number of multipoles per ball; they fall by the ratio of radius to distance, at most 0.5 here."""


def grounded(order: int) -> float:
    """Returns the reaction of a grounded sphere: the multipole that it opposes to a potential r^l·P_l on its surface, per potential."""
    return 1.0


def floating(order: int) -> float:
    """Returns the reaction of a floating sphere, which has no total charge and thus no monopole."""
    return float(order > 0)


def dielectric(permittivity: float) -> Callable[[int], float]:
    """Returns, as a function of the order l, the reaction of a dielectric sphere l·(ε − 1)/(l·ε + l + 1): u and ε·∂u/∂r are continuous."""
    return lambda order: order * (permittivity - 1) / (order * permittivity + order + 1)


def two_balls(
    radius: float, other_radius: float, distance: float, answer: Callable[[int], float]
) -> tuple[float, float]:
    """Returns charge / 4πε of a ball at 1 V and of another one, `distance` between the centres.

    u = Σ_l a_l (a/r1)^(l+1) P_l(cos θ1) + b_l (b/r2)^(l+1) P_l(cos θ2), both axes towards the other ball; one ball's
    multipole l is Σ_k C(l+k, k) r^k P_k / d^(l+k+1) about the other's centre.
    """
    orders = np.arange(ORDERS)
    shared = comb(orders[:, None] + orders, orders[:, None])

    def seen(near: float, far: float) -> Array:
        return np.asarray(
            shared * (near / distance) ** orders[:, None] * (far / distance) ** (orders[None] + 1.0)
        )

    answers = np.array([answer(order) for order in orders])
    one = np.eye(ORDERS)
    matrix = np.block(
        [[one, seen(radius, other_radius)], [answers[:, None] * seen(other_radius, radius), one]]
    )
    found = np.linalg.solve(matrix, np.eye(2 * ORDERS)[0])
    return radius * float(found[0]), other_radius * float(found[ORDERS])


def body_of_revolution(outline: Sequence[tuple[float, float]]) -> float:
    """Returns C / 4πε of a conductor whose surface is the polygon `outline` of (distance from the axis, z), turned about z.

    Rings of constant charge density on panels that shrink towards the polygon's corners, the potential 1 in the middle of
    each panel; a ring's potential is a complete elliptic integral. The error falls with the third power of the number
    of panels, by which two solutions are extrapolated.
    """
    coarse, fine = (_rings(outline, panels) for panels in (40, 80))
    return fine + (fine - coarse) / 7


def _rings(outline: Sequence[tuple[float, float]], panels: int) -> float:
    t = np.linspace(0, 1, panels + 1)[:, None]
    graded = t**4 * (35 - 84 * t + 70 * t**2 - 20 * t**3)
    corners = np.array(outline, dtype=float)
    sides = [start + (end - start) * graded for start, end in zip(corners[:-1], corners[1:])]
    starts, ends = (np.concatenate([side[cut] for side in sides]) for cut in (slice(0, -1), slice(1, None)))
    lengths = np.linalg.norm(ends - starts, axis=1)
    along, middles = (ends - starts) / lengths[:, None], (starts + ends) / 2
    nodes, weights = np.polynomial.legendre.leggauss(12)  # type: ignore[no-untyped-call]
    # Nodes graded with the third power towards the point nearest to the middle, where the potential is logarithmic.
    shares, weights = ((nodes + 1) / 2) ** 3, 1.5 * ((nodes + 1) / 2) ** 2 * weights
    foot = np.clip(np.einsum("ijk,jk->ij", middles[:, None] - starts, along), 0, lengths)
    potential = np.zeros((len(lengths), len(lengths)))
    for reach in (-foot, lengths - foot):
        place = foot[..., None] + reach[..., None] * shares
        rho = starts[:, None, 0] + along[:, None, 0] * place
        z = starts[:, None, 1] + along[:, None, 1] * place
        rho0, z0 = middles[:, None, None, 0], middles[:, None, None, 1]
        far = (rho + rho0) ** 2 + (z - z0) ** 2
        near = (rho - rho0) ** 2 + (z - z0) ** 2
        rings = 4 * rho * ellipkm1(near / far) / np.sqrt(far)
        potential += np.abs(reach) * np.sum(weights * rings, axis=2)
    density = np.linalg.solve(potential, np.ones(len(lengths)))
    return float(density @ (2 * np.pi * middles[:, 0] * lengths))
