"""Units in which reports give values, and how they write relative ones."""

from __future__ import annotations

PICOFARAD = 1e-12
CENTIMETRE = 1e-2


def percent(value: float) -> str:
    """Writes a ratio with two significant digits, or with all before the point: 0.00123 becomes 0.12 %."""
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def signed_percent(value: float, decimals: int | None = None) -> str:
    """Writes a relative difference with its sign, and unless told otherwise with two decimals at most: +12 %, +1.2 %, +0.12 %."""
    if decimals is None:
        decimals = 0 if abs(value) >= 0.0995 else 1 if abs(value) >= 0.00995 else 2
    # The sum turns -0.0 into 0.0.
    return f"{round(100 * value, decimals) + 0.0:+.{decimals}f} %"


def duration(seconds: float, digits: int = 3) -> str:
    """Writes a time with so many significant digits: 8.15 s, 590 µs, 14 ns."""
    for unit, name in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")):
        if seconds >= unit:
            break
    return f"{float(f'{seconds / unit:.{digits}g}'):,g} {name}"
