"""How values with errors, and intervals, are written for people: with the digits that are known."""

from __future__ import annotations

import math
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

PICOFARAD = 1e-12
"""Farads in the unit in which people read capacitances."""

_LARGE, _LEAST, _MOST_PLACES = 100.0, 1e-8, 9
"""The error from which on values of its size are unknown, the error below which it is written with an exponent, and the most decimals."""
_SMALL, _MANY_PLACES, _MOST_DIGITS = 1e-2, 7, 7
"""An exponent is written for values below `_SMALL` whose error needs more than `_MANY_PLACES` decimals; most digits after the point then."""


def measured(value: float, error: float) -> str:
    """Writes a value with its error, both to two digits of the error: 2.4914 ± 0.0011. Of a value that is smaller than an error of a
    hundred or more no digit is known: unknown ± 2.7e+14. The command `fringe` writes its tables so, too (model/cli/measured.cpp).
    """
    if not (math.isfinite(value) and math.isfinite(error)):
        return "unknown"
    if error >= _LARGE and error > abs(value):
        return f"unknown ± {error:.2g}"
    if error == 0:
        return f"{value:.6g} ± 0"
    places = min(max(_decimals(error), 0), _MOST_PLACES)
    if places > _MANY_PLACES and 0 < abs(value) < _SMALL:
        digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 1
        return f"{value:.{min(max(digits, 0), _MOST_DIGITS)}e} ± {error:.1e}"
    shown = f"{error:.1e}" if error < _LEAST else f"{error:.{places}f}"
    return f"{value:.{places}f} ± {shown}"


def picofarads(value: float, error: float) -> str:
    """Writes a capacitance with its error, both given in farads, in pF."""
    return measured(value / PICOFARAD, error / PICOFARAD)


def picofarad_interval(lower: float, upper: float) -> str:
    """Writes an interval between capacitances in farads, in pF and rounded outwards, to two digits of its half width: [2.4903, 2.4925]."""
    ends = lower / PICOFARAD, upper / PICOFARAD
    if not all(map(math.isfinite, ends)):
        return "unknown"
    half_width = abs(ends[1] - ends[0]) / 2
    step = Decimal(1).scaleb(-max(_decimals(half_width), 0) if half_width > 0 else -_MOST_PLACES)
    first, last = (Decimal(end).quantize(step, way) for end, way in zip(ends, (ROUND_FLOOR, ROUND_CEILING)))
    return f"[{first:f}, {last:f}]"


def _decimals(error: float) -> int:
    """The number of decimals that show two digits of an error; negative from a hundred on."""
    # The exponent after rounding to two digits: 0.0996 is 0.10.
    return 1 - int(f"{error:.1e}".partition("e")[2])
