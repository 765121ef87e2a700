"""Capacitances known without finite elements: published values, closed forms, and matrices by boundary elements.

Values are in units that need no permittivity; each comment gives unit and source. Round bodies are in `truths_of_revolution`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

Array = NDArray[np.float64]

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
BOUNDARY_ELEMENTS = Path(__file__).with_name("boundary_elements.json")
"""Maxwell matrices of plates by Galerkin boundary elements on panels graded towards every edge, extrapolated over four
levels. Nothing was fitted to them."""


ROOMS = Path(__file__).with_name("rooms.json")
"""Maxwell matrices of plates in grounded rooms, in which a wall is a mirror: by boundary elements of the plates with their images in free space, so
that the truth owes nothing to a mesh of space, nor to a room. Images beyond the far walls, 4 m away, are below 1e-6 of an entry."""


def rooms() -> list[dict[str, Any]]:
    """The rooms with their plates, their matrices in pF, and the largest relative error of an entry."""
    cases: list[dict[str, Any]] = json.loads(ROOMS.read_text(encoding="utf-8"))["cases"]
    return cases


def boundary_elements() -> list[dict[str, Any]]:
    """Reads the set-ups with their matrices in pF and the largest relative error of an entry."""
    cases: list[dict[str, Any]] = json.loads(BOUNDARY_ELEMENTS.read_text(encoding="utf-8"))["cases"]
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

    Both sides of the strip have one length: b·m = E'/K'. Legendre's relation makes the height of the strip c·π/(2K'·√m), so that
    width/gap = (2/π)·(K'·E(φ, m') − E'·F(φ, m')), sin²φ = (1 − b·m)/m', and C/ε = K'/K. For strips of up to eight gaps: with
    wider ones 1 − m is no number of its own.
    """
    logarithm = brentq(
        lambda x: _strip_width(float(np.exp(x))) - width_over_gap, np.log(1e-13), np.log(1 - 1e-9), xtol=1e-13
    )
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
