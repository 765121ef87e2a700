"""Capacitances in closed form, or by an equation in one variable, over 4πε: lengths. Errors are those of rounding, below 1e-9."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import elliprf

from analysis.topics.verification import truths
from analysis.topics.verification.truths import dielectric, two_balls


def ellipsoid(a: float, b: float, c: float) -> float:
    """Returns that of a conducting ellipsoid with these semi-axes, one of which may be 0: 1 / R_F(a², b², c²) (Carlson, SIAM J. Math.
    Anal. 8 (1977) 231; the integral is Maxwell's). A disc is the one with a third axis of 0."""
    return 1 / float(elliprf(a * a, b * b, c * c))


def two_spheres(a: float, b: float, gap: float) -> tuple[float, float, float]:
    """Returns C11, C22 and C12 (below 0) of spheres of radii a and b with this gap between them: Kelvin's images (Smythe, Static and
    Dynamic Electricity, 3rd edition, section 5.082), summed until the terms are below rounding."""
    distance = a + b + gap
    # cosh u − 1 without the cancellation of nearly touching spheres.
    excess = gap * (gap + 2 * (a + b)) / (2 * a * b)
    u = math.log1p(excess + math.sqrt(excess * (excess + 2)))
    n = np.arange(int(40 / u) + 2)
    now, following = np.sinh(n * u), np.sinh((n + 1) * u)
    scale = math.sinh(u)
    own = a * b * scale * float(np.sum(1 / (a * now + b * following)))
    other = a * b * scale * float(np.sum(1 / (b * now + a * following)))
    return own, other, -a * b / distance * scale * float(np.sum(1 / following))


def coaxial_discs(radius: float, gap: float) -> tuple[float, float]:
    """Returns C11 and C12 (below 0) of equal coaxial discs, by Love's equation for discs at opposite and at the same potential."""
    opposite, same = (truths.love(gap / radius, other) for other in (-1.0, 1.0))
    return radius * (same + opposite), radius * (same - opposite)


def bowl(radius: float, half_angle: float) -> float:
    """Returns that of the thin part of a sphere within `half_angle` (rad) of a point: Kelvin's bowl (Reprint of Papers on Electrostatics
    and Magnetism, 1872, section 233), (α + sin α)/π of the sphere's."""
    return radius * (half_angle + math.sin(half_angle)) / math.pi


def coated_sphere(radius: float, outer: float, permittivity: float) -> float:
    """Returns that of a sphere within a layer of an insulator up to the radius `outer`: shells in series, by Gauss's law."""
    return 1 / ((1 / radius - 1 / outer) / permittivity + 1 / outer)


def crossing_spheres(a: float, b: float) -> float:
    """Returns that of two spheres that cross at right angles: three images (Maxwell, Treatise, 3rd edition, section 168)."""
    return a + b - a * b / math.hypot(a, b)


def cube(side: float) -> float:
    """Returns that of a cube (Helsing and Perfekt, Appl. Comput. Harmon. Anal. 34 (2013) 445)."""
    return side * truths.UNIT_CUBE


def beside_insulator(radius: float, other: float, gap: float, permittivity: float) -> float:
    """Returns that of a sphere beside an insulating sphere of radius `other`: multipoles about both centres. The gap has to be at least
    a third of the smaller radius, for the error to be below 1e-9."""
    return two_balls(radius, other, radius + other + gap, dielectric(permittivity))[0]
