"""Makes triangle_rules.cpp: quadrature rules on the triangle with positive weights and points inside, and the constants
of their error bound (model/NUMERICS.md, section 12).

Every rule consists of orbits: the centroid, three points on the medians, or three points that turn into each other. The
moments up to the rule's degree are solved for by least squares from random starts, then to 40 digits by Newton's method.

    python3 model/src/numeric/make_triangle_rules.py > model/src/numeric/triangle_rules.cpp
"""

from dataclasses import dataclass
from itertools import count

import mpmath
import numpy as np
from scipy.optimize import least_squares

SEED = 1
DIGITS = 40


@dataclass(frozen=True)
class Structure:
    """The orbits a rule is made of. A median orbit has one coordinate, a turning one two; each orbit has one weight."""

    degree: int
    centroids: int
    medians: int
    turning: int

    @property
    def points(self) -> int:
        return self.centroids + 3 * (self.medians + self.turning)


# The fewest points known for a positive inner rule of these degrees with such orbits.
STRUCTURES = (
    Structure(1, 1, 0, 0),
    Structure(2, 0, 1, 0),
    Structure(4, 0, 2, 0),
    Structure(5, 1, 2, 0),
    Structure(7, 0, 0, 4),
    Structure(8, 1, 3, 2),
    Structure(9, 1, 4, 2),
    Structure(10, 1, 2, 6),
)


def mirrored(structure: Structure) -> bool:
    """Whether turning orbits come in mirrored pairs, which halves the unknowns and the moments that matter."""
    return structure.medians > 0 and structure.turning % 2 == 0


def barycentric(structure: Structure, x, one=1.0):
    """Rows (λ0, λ1, λ2, weight) of the points that the unknowns stand for."""
    rows, i = [], 0
    third = one / 3
    for _ in range(structure.centroids):
        rows.append((third, third, third, x[i]))
        i += 1
    for _ in range(structure.medians):
        a, weight = x[i], x[i + 1]
        b = one - 2 * a
        rows += [(a, a, b, weight), (a, b, a, weight), (b, a, a, weight)]
        i += 2
    pairs = mirrored(structure)
    for _ in range(structure.turning // 2 if pairs else structure.turning):
        a, b, weight = x[i], x[i + 1], x[i + 2]
        c = one - a - b
        rows += [(a, b, c, weight), (b, c, a, weight), (c, a, b, weight)]
        if pairs:
            rows += [(b, a, c, weight), (a, c, b, weight), (c, b, a, weight)]
        i += 3
    return rows


def unknowns(structure: Structure) -> int:
    turning = structure.turning // 2 if mirrored(structure) else structure.turning
    return structure.centroids + 2 * structure.medians + 3 * turning


def invariants(structure: Structure) -> list[tuple[int, int]]:
    """Exponents (j, k): the moments of Re(z^j · |z|^2k) and, without mirror symmetry, of Im, decide about all moments
    up to the degree, where z = λ0 + λ1·ω + λ2·ω² is a complex coordinate that turning by 120° multiplies by ω.
    """
    return [(j, k) for j in range(0, structure.degree + 1, 3) for k in range((structure.degree - j) // 2 + 1)]


def moment(j: int, k: int):
    """The mean of z^j·|z|^2k over the triangle, by the mean of λ0^a λ1^b λ2^c = 2·a!·b!·c!/(a+b+c+2)!."""
    omega = mpmath.expjpi(mpmath.mpf(2) / 3)
    terms = {(0, 0, 0): mpmath.mpc(1)}

    def times(factors):
        product = {}
        for (a, b, c), value in terms.items():
            for which, factor in enumerate(factors):
                key = (a + (which == 0), b + (which == 1), c + (which == 2))
                product[key] = product.get(key, 0) + value * factor
        return product

    for _ in range(j + k):
        terms = times((1, omega, omega**2))
    for _ in range(k):
        terms = times((1, omega**2, omega))
    factorial = mpmath.factorial
    return sum(
        value * 2 * factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 2)
        for (a, b, c), value in terms.items()
    )


def residuals(structure: Structure, x, targets, omega, one=1.0):
    rows = barycentric(structure, x, one)
    result = []
    for (j, k), target in targets.items():
        total = 0
        for a, b, c, weight in rows:
            z = a + b * omega + c * omega**2
            total += weight * z**j * (z * z.conjugate()) ** k
        total -= target
        result.append(total.real)
        if j and not mirrored(structure):
            result.append(total.imag)
    return result


def fast_residuals(structure: Structure, x, targets, omega) -> np.ndarray:
    """The same in double precision."""
    rows = np.array(barycentric(structure, x))
    z = rows[:, 0] + rows[:, 1] * omega + rows[:, 2] * omega**2
    squared = (z * z.conjugate()).real
    result = []
    for (j, k), target in targets.items():
        total = rows[:, 3] @ (z**j * squared**k) - target
        result.append(total.real)
        if j and not mirrored(structure):
            result.append(total.imag)
    return np.array(result)


def acceptable(structure: Structure, x) -> bool:
    return all(min(row) > 1e-4 for row in barycentric(structure, x))


def solve(structure: Structure, random: np.random.Generator) -> list:
    exact = {key: moment(*key) for key in invariants(structure)}
    rounded = {key: complex(value) for key, value in exact.items()}
    omega = complex(mpmath.expjpi(mpmath.mpf(2) / 3))
    size = unknowns(structure)
    for _ in count():
        found = least_squares(
            lambda x: fast_residuals(structure, x, rounded, omega),
            random.uniform(0, 0.5, size),
            xtol=3e-16,
            ftol=3e-16,
            gtol=3e-16,
            max_nfev=200,
        )
        if np.max(np.abs(found.fun)) < 1e-13 and acceptable(structure, found.x):
            return polished(structure, found.x, exact)
    raise AssertionError


def polished(structure: Structure, x, exact) -> list:
    """Newton's method at full precision, by the least change where the moments leave freedom."""
    omega = mpmath.expjpi(mpmath.mpf(2) / 3)
    one = mpmath.mpf(1)
    point = mpmath.matrix([mpmath.mpf(float(value)) for value in x])
    step = mpmath.mpf(10) ** (-DIGITS // 2)
    for _ in range(4):
        value = mpmath.matrix(residuals(structure, list(point), exact, omega, one))
        jacobian = mpmath.matrix(len(value), len(point))
        for column in range(len(point)):
            moved = point.copy()
            moved[column] += step
            derivative = (mpmath.matrix(residuals(structure, list(moved), exact, omega, one)) - value) / step
            for row in range(len(value)):
                jacobian[row, column] = derivative[row]
        point -= pseudo_inverse(jacobian) * value
    assert max(abs(v) for v in residuals(structure, list(point), exact, omega, one)) < mpmath.mpf(10) ** -30
    return list(point)


def pseudo_inverse(matrix):
    u, singular, v = mpmath.svd_r(matrix)
    inverse = mpmath.diag([1 / s if s > mpmath.mpf(10) ** -10 * singular[0] else 0 for s in singular])
    return v.T * inverse * u.T


def bound_constant(rule: np.ndarray, degree: int) -> float:
    """The largest value that (mean of |δ|^k over the triangle + Σ w|δ|^k) takes for k = degree + 1 over all triangles
    whose vertices lie within 1 of the centroid. A convex function of the vertices is largest where two of them lie at
    distance 1, seen from the centroid under an angle between 120° and 180°."""
    k = degree + 1
    nodes, weights = np.polynomial.legendre.leggauss(40)
    u, wu = (nodes + 1) / 2, weights / 2
    grid = np.array(
        [(1 - a, a * (1 - b), a * b, 2 * a * wa * wb) for a, wa in zip(u, wu) for b, wb in zip(u, wu)]
    )
    largest = 0.0
    for angle in np.linspace(2 * np.pi / 3, np.pi, 2001):
        first, second = np.array([1.0, 0.0]), np.array([np.cos(angle), np.sin(angle)])
        corners = np.array([first, second, -first - second])
        for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            permuted = corners[list(order)]
            total = grid[:, 3] @ np.linalg.norm(grid[:, :3] @ permuted, axis=1) ** k
            total += rule[:, 3] @ np.linalg.norm(rule[:, :3] @ permuted, axis=1) ** k
            largest = max(largest, total)
    # 1 % for the steps of the angle and of the quadrature, which are far finer.
    return 1.01 * largest


def main() -> None:
    random = np.random.default_rng(SEED)
    print("// Made by make_triangle_rules.py: do not edit.")
    print('#include "numeric/triangle_rules.hpp"\n')
    print("namespace fringe::detail {\nnamespace {\n")
    entries = []
    with mpmath.workdps(DIGITS):
        for structure in STRUCTURES:
            rows = barycentric(structure, solve(structure, random), mpmath.mpf(1))
            table = np.array([[float(value) for value in row] for row in rows])
            name = f"degree{structure.degree}"
            print(f"constexpr TriangleNode {name}[] = {{")
            for row in rows:
                second, third, weight = (mpmath.nstr(row[i], 17) for i in (1, 2, 3))
                print(f"    {{{second}, {third}, {weight}}},")
            print("};\n")
            entries.append(
                f"    {{{structure.degree}, {structure.points}, {bound_constant(table, structure.degree):.4e}, {name}}},"
            )
    print("constexpr TriangleRule rules[] = {")
    print("\n".join(entries))
    print("};\n\n}  // namespace\n")
    print(
        "std::span<const TriangleRule> triangle_rules() {\n  return rules;\n}\n\n}  // namespace fringe::detail"
    )


if __name__ == "__main__":
    main()
