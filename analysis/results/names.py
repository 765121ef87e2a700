"""Names of cases in words, "parallel, gap 2 cm": the family, and what distinguishes the case from the others of its family."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from analysis.results.units import CENTIMETRE, PICOFARAD
from geometries.studies.families import USUAL
from geometries.studies.study import EMPTY, Parameter

_WITHOUT_UNIT, _CAPACITANCE = "relative_permittivity", "to_ground"
_ALONE = "sensor alone"

Parameters = dict[str, Parameter]


def in_words(parameters: Parameters) -> str:
    """Writes parameters for people, with lengths in cm; those that say that the target is a grounded conductor in empty space are left out."""
    return ", ".join(_phrase(name, value) for name, value in parameters.items() if USUAL.get(name) != value)


def of_cases(cases: Sequence[tuple[str, Parameters]]) -> list[str]:
    """Names cases, given as (family, parameters), each by the parameters in which it differs from most of its family.

    Cases of different parameters have different names.
    """
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
