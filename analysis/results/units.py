"""How reports write numbers with their units, and name cases in words, "parallel, gap 2 cm"."""

import math
from collections import Counter
from collections.abc import Sequence

from geometries.common.measured import PICOFARAD
from geometries.studies.families import USUAL
from geometries.studies.study import EMPTY, Parameter

CENTIMETRE = 1e-2
VACUUM_PERMITTIVITY = 8.8541878128e-12
"""Permittivity of empty space (F/m), CODATA 2018."""

_EXACT, _TIMES = 1e-12, 3.0
"""The relative error below which a value is called exact, and the ratio to the truth from which on it is told instead of per cent."""


def percent(value: float) -> str:
    """Writes a ratio with two significant digits, or with all before the point: 0.00123 becomes 0.12 %."""
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def signed_percent(value: float, decimals: int | None = None) -> str:
    """Writes a relative difference with its sign, and unless told otherwise with two decimals at most: +12 %, +1.2 %, +0.12 %; in words if it
    is infinite."""
    if math.isinf(value):
        return "without limit"
    if decimals is None:
        decimals = 0 if abs(value) >= 0.0995 else 1 if abs(value) >= 0.00995 else 2
    # The sum turns -0.0 into 0.0.
    return f"{round(100 * value, decimals) + 0.0:+.{decimals}f} %"


def too(error: float) -> str:
    """Writes (value − truth)/truth as people say it: 12 % too high, 12 % too low, 26 times too high, 5 times too low, of the wrong sign."""
    ratio = 1 + error
    if math.isnan(ratio) or math.isinf(ratio):
        return "too high without limit" if ratio > 0 else "unknown"
    if abs(error) < _EXACT:
        return "exact"
    if ratio < 0:
        return "of the wrong sign"
    if ratio >= _TIMES:
        return f"{_two_digits(ratio)} times too high"
    if 0 < ratio <= 1 / _TIMES:
        return f"{_two_digits(1 / ratio)} times too low"
    return f"{percent(abs(error))} too {'high' if error > 0 else 'low'}"


def _two_digits(value: float) -> str:
    return f"{float(f'{value:.2g}'):,.10g}"


def duration(seconds: float, digits: int = 3) -> str:
    """Writes a time with so many significant digits: 8.15 s, 590 µs, 14 ns."""
    for unit, name in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")):
        if seconds >= unit:
            break
    return f"{float(f'{seconds / unit:.{digits}g}'):,g} {name}"


_WITHOUT_UNIT, _CAPACITANCE = "relative_permittivity", "to_ground"
_ALONE = "sensor alone"

Parameters = dict[str, Parameter]


def in_words(parameters: Parameters) -> str:
    """Writes parameters for people, with lengths in cm; those that say that the target is a grounded conductor in empty space are left out."""
    return ", ".join(_phrase(name, value) for name, value in parameters.items() if USUAL.get(name) != value)


def of_cases(cases: Sequence[tuple[str, Parameters]]) -> list[str]:
    """Names cases, given as (family, parameters), each by the parameters in which it differs from most of its family.
    Cases of different parameters have different names."""
    members: dict[str, list[Parameters]] = {}
    for family, parameters in cases:
        members.setdefault(family, []).append(parameters)
    return [_name(family, parameters, members[family]) for family, parameters in cases]


def _name(family: str, parameters: Parameters, members: list[Parameters]) -> str:
    counts = {name: Counter(each.get(name) for each in members) for name in parameters}
    varied = [name for name, count in counts.items() if len(count) > 1]
    unlike = [name for name in varied if counts[name][parameters[name]] <= len(members) / 2]
    words = in_words({name: parameters[name] for name in unlike or varied})
    title = _ALONE if family == EMPTY else family
    return f"{title}, {words}" if words else title


def _phrase(name: str, value: Parameter) -> str:
    label = name.replace("_", " ")
    if name == _CAPACITANCE and isinstance(value, float):
        return f"{label} {value / PICOFARAD:g} pF"
    if isinstance(value, str) or name == _WITHOUT_UNIT:
        return f"{label} {value if isinstance(value, str) else f'{value:g}'}"
    values = value if isinstance(value, tuple) else (value,)
    if name.endswith("_degrees"):
        return f"{label.removesuffix(' degrees')} {values[0]:g}°"
    between = " × " if name.endswith("_size") else " and "
    return f"{label} {between.join(f'{v / CENTIMETRE:g}' for v in values)} cm"
