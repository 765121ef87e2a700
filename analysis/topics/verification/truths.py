"""Capacitances known without finite elements: published values, closed forms, and matrices by boundary elements.

Values are in units that need no permittivity; each comment gives unit and source. Those of round bodies come first.
"""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import comb, ellipe, ellipeinc, ellipk, ellipkinc, ellipkm1

from geometries.common.arrays import Array

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
    """Returns charge / 4πε of a ball at 1 V and of another one, `distance` between the centres. u = Σ_l a_l
    (a/r1)^(l+1) P_l(cos θ1) + b_l (b/r2)^(l+1) P_l(cos θ2), both axes towards the other ball; one ball's multipole l
    is Σ_k C(l+k, k) r^k P_k / d^(l+k+1) about the other's centre."""
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
    each panel; a ring's potential is a complete elliptic integral. The error falls with the third power of the number of
    panels, by which two solutions are extrapolated."""
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


UNIT_SQUARE_PLATE = 0.366788
"""C / 4πε·side; two independent boundary-element computations, 1e-6; HierBEM gives 0.3667874."""
UNIT_SQUARE_PLATE_ERROR = 1e-6 / UNIT_SQUARE_PLATE
UNIT_CUBE = 0.66067815409957
"""C / 4πε·side; Helsing & Perfekt 2013."""
PARALLEL_SQUARES = {0.1: 1.3057, 0.2: 1.5528, 0.5: 2.2364, 1.0: 3.3430, 2.0: 5.581}
"""Two-terminal C / (ε·area/gap) over gap/side; boundary elements."""
PARALLEL_SQUARES_ERROR = 1e-4
LEKNER = (1.2305175015e-12, 2.4315431141e-12, -0.4945667562e-12)
"""Maxwell matrix of balls of 1 and 2 cm, centres 5 cm apart, F: C11, C22, C12; Lekner 2011."""


def stored(name: str) -> list[dict[str, Any]]:
    """Reads set-ups with their matrices in pF and the largest relative error of an entry.

    boundary_elements: plates by Galerkin boundary elements on panels graded towards every edge, extrapolated over four levels. Nothing was
    fitted to them. rooms: plates in grounded rooms, in which a wall is a mirror, by boundary elements of the plates with their images in free
    space, so that the truth owes nothing to a mesh of space, nor to a room. Images beyond the far walls, 4 m away, are below 1e-6 of an entry.
    """
    text = Path(__file__).with_name(f"{name}.json").read_text(encoding="utf-8")
    cases: list[dict[str, Any]] = json.loads(text)["cases"]
    return cases


def love(separation: float, other: float = -1.0) -> float:
    """Returns half of C / 4πε·radius of a disc at 1 V, `separation` radii before an equal coaxial one at the potential `other`, 1 or −1 V:
    of opposite ones the two-terminal C. Love's equation (Quart. J. Mech. Appl. Math. 2 (1949) 428).

    f(x) ± (κ/π) ∫ f(y)/(κ² + (x − y)²) dy = 1 on [−1, 1], C = (1/π) ∫ f, which is 2/π far from others. The kernel is analytic, so
    Gauss–Legendre collocation converges geometrically; for discs a twentieth of their radius apart 200 nodes are enough.
    """
    x, weights = np.polynomial.legendre.leggauss(200)  # type: ignore[no-untyped-call]
    kernel = other * separation / np.pi / (separation**2 + (x[:, None] - x) ** 2)
    return float(weights @ np.linalg.solve(np.eye(200) + kernel * weights, np.ones(200)) / (2 * np.pi))


def strips(width_over_gap: float) -> float:
    """Returns two-terminal C / ε per length of two infinitely long strips that face each other.

    The quarter of space above the middle plane and beside the middle of the strips is the image of a half-plane t; with
    t = s² and prevertices 0, 1, 1/m of the corners, b of the strip's edge,

        dz = c·(s² − b) / √((s² − 1)(s² − 1/m)) ds.

    Both sides of the strip have one length: b·m = E'/K'. Legendre's relation makes the height of the
    strip c·π/(2K'·√m), so that width/gap = (2/π)·(K'·E(φ, m') − E'·F(φ, m')), sin²φ = (1 − b·m)/m',
    and C/ε = K'/K. For strips of up to eight gaps: with wider ones 1 − m is no number of its own."""
    ends = np.log(1e-13), np.log(1 - 1e-9)
    logarithm = brentq(lambda x: _strip_width(float(np.exp(x))) - width_over_gap, *ends, xtol=1e-13)
    m = float(np.exp(logarithm))
    return float(ellipk(1 - m) / ellipk(m))


def _strip_width(m: float) -> float:
    own, other = ellipk(1 - m), ellipe(1 - m)
    angle = np.arcsin(np.sqrt((1 - other / own) / (1 - m)))
    return float(2 / np.pi * (own * ellipeinc(angle, 1 - m) - other * ellipkinc(angle, 1 - m)))


def sphere_and_plane(gap: float) -> float:
    """Returns C / (4πε·radius) of a sphere `gap` radii above an infinite grounded plane: sinh α · Σ 1/sinh nα, cosh α = 1 + gap."""
    alpha = np.arccosh(1 + gap)
    # The terms fall like exp(−nα); the remainder is below rounding.
    orders = np.arange(1, int(40 / alpha) + 2)
    return float(np.sinh(alpha) * np.sum(1 / np.sinh(orders * alpha)))


def two_terminal(maxwell: Array) -> float:
    """Returns C between two conductors of opposite charge."""
    m = maxwell
    return float((m[0, 0] * m[1, 1] - m[0, 1] ** 2) / (m[0, 0] + m[1, 1] + 2 * m[0, 1]))
