"""Reads study files: the set-ups to compare, the accuracy of the reference, and the methods of the model.

geometries/STUDY.md describes every key.
"""

from __future__ import annotations

import functools
import inspect
import itertools
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast, get_type_hints

import numpy as np

from geometries.common.errors import InputError
from geometries.common.tables import Table, is_file, parse, read_text
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical_and_identity
from geometries.studies import scene_sweep
from geometries.studies.families import FAMILIES, Vector2

Parameter = float | Vector2 | str

EMPTY = "empty"
NO_REFERENCE = "none"
ERROR_KINDS = ("estimate", "enclosure", NO_REFERENCE)
FIELD, BOUNDARY_ELEMENTS, BOTH = "field", "boundary-elements", "both"
REFERENCE_METHODS = (FIELD, BOUNDARY_ELEMENTS, BOTH)
EXPERIMENTS = ("I", "II", "III", "IV", "V", "VI")

METHODS = (
    '"exact", "split:N" (N from 0 to 10) or "gauss:K" (K from 1 to 64), also with "+nearest" (only the nearest plate counts) and '
    '"+facing" (only faces that see the plate count); "formula", "reduced", "boundary-elements" or "auto"'
)
"""The methods of the model, as the command `fringe capacitance` has them."""
METHOD_PATTERN = (
    r"(exact|split:(\d|10)|gauss:([1-9]|[1-5]\d|6[0-4]))(\+nearest)?(\+facing)?"
    r"|formula|reduced|boundary-elements|auto"
)
# Words of before, and what to write now.
_FORMER_METHODS = {"recommended": "auto", "reduced:.*": "reduced"}
# Largest number of cases: ten times a study that is planned in seconds and runs for months.
_MOST_CASES = 1_000_000
# Longest name in most file systems.
_LONGEST_FOLDER_NAME = 255
_STUDIES = Path(__file__).parent
IDENTITY_DIGITS = 16


@dataclass(frozen=True)
class Case:
    """One scene of a study. `parameters` holds the family's parameters, defaults included; `text` is the canonical scene and
    `identity` its hash, of which `id` is the beginning. `alone` is the relative accuracy asked of boundary elements where they are the case's only
    reference; None: the study's references are asked."""

    identity: str
    family: str
    parameters: dict[str, Parameter]
    scene: Scene
    text: str
    alone: float | None = None

    @property
    def id(self) -> str:
        return self.identity[:IDENTITY_DIGITS]


@dataclass(frozen=True)
class Study:
    """A study file, expanded. `rtol`, `max_seconds`, `error` and `reference_method` are for the reference, `methods` for the model;
    `experiment` is one of EXPERIMENTS or empty."""

    name: str
    title: str
    rtol: float
    max_seconds: float
    error: str
    methods: tuple[str, ...]
    sweeps: tuple[Case, ...]
    experiment: str = ""
    reference_method: str = BOTH

    @property
    def by_field(self) -> bool:
        """Whether the field solver is asked."""
        return self.error != NO_REFERENCE and self.reference_method != BOUNDARY_ELEMENTS

    @property
    def by_boundary_elements(self) -> bool:
        """Whether boundary elements are asked."""
        return self.error != NO_REFERENCE and self.reference_method != FIELD

    def cases(self) -> list[Case]:
        """Returns every case once, in the order of the file; then, for every distinct sensor, the sensor alone."""
        cases: dict[str, Case] = {}
        for case in [*self.sweeps, *map(empty_case, self.sweeps)]:
            # Dictionaries keep the place of a replaced value.
            if case.id not in cases or case.alone is None:
                cases[case.id] = case
        return list(cases.values())


def empty_case(case: Case) -> Case:
    """Returns the case without its objects, which `delta_self` is measured against."""
    empty = _empty_case(case.parameters.get("sensor_size"), scene_sweep.without_objects(case.scene))
    return replace(empty, alone=case.alone)


# Cached: sweeps have few sensors and many cases.
@functools.cache
def _empty_case(sensor_size: Parameter | None, scene: Scene) -> Case:
    return _case(EMPTY, {} if sensor_size is None else {"sensor_size": sensor_size}, scene)


def find(study: str) -> Path:
    """Returns the file of a study given by its name in `geometries/studies` or by its path; InputError when there is none."""
    named = _STUDIES / f"{study}.toml"
    if is_file(named):
        return named
    if is_file(Path(study)):
        return Path(study)
    known = ", ".join(sorted(path.stem for path in _STUDIES.glob("*.toml")))
    raise InputError(study, "", f"is neither a study file nor one of the known studies: {known}")


def load(path: Path | str) -> Study:
    """Returns the study in a file; InputError when the file cannot be used."""
    return loads(read_text(Path(path)), source=str(path))


def loads(text: str, source: str = "study") -> Study:
    """Returns the study in a text; `source` stands for it in errors."""
    root = parse(text, source)
    root.allow_only(("format", "name", "title", "experiment", "reference", "model", "sweep"))
    root.known_format()
    reference = root.table("reference")
    reference.allow_only(("method", "rtol", "max_seconds", "error"))
    model = root.table("model")
    model.allow_only(("methods",))
    error, reference_method = _error_kind(reference), _reference_method(reference)
    unasked = 1.0 if error == NO_REFERENCE else None
    untimed = 1.0 if reference_method == BOUNDARY_ELEMENTS else unasked
    if error == "enclosure" and reference_method == BOUNDARY_ELEMENTS:
        raise reference.error("error", "boundary elements prove no intervals: it must be estimate")
    study = Study(
        name=_folder_name(root),
        title=root.text("title"),
        rtol=_rtol(reference, unasked),
        max_seconds=reference.positive("max_seconds", untimed),
        error=error,
        methods=_methods(model),
        sweeps=tuple(case for sweep in root.tables("sweep") for case in _sweep(sweep)),
        experiment=_experiment(root),
        reference_method=reference_method,
    )
    alone = [number for number, sweep in enumerate(root.tables("sweep")) if sweep.has("reference")]
    if alone and not study.by_boundary_elements:
        raise root.error(f"sweep[{alone[0]}].reference", "the study does not ask boundary elements")
    if not study.sweeps:
        raise root.error("sweep", "a study needs at least one sweep")
    return study


def _folder_name(root: Table) -> str:
    name = root.text("name")
    if Path(name).name != name or name in (".", "..") or not name.isprintable():
        raise root.error(
            "name", f"names the folder of the results and must not contain a path, unlike {name!r}"
        )
    if len(name.encode()) > _LONGEST_FOLDER_NAME:
        raise root.error("name", f"names the folder of the results and may have {_LONGEST_FOLDER_NAME} bytes")
    return name


def _experiment(root: Table) -> str:
    if not root.has("experiment"):
        return ""
    experiment = root.text("experiment")
    if experiment not in EXPERIMENTS:
        raise root.error("experiment", f"must be one of {', '.join(EXPERIMENTS)}, not {experiment!r}")
    return experiment


def _error_kind(reference: Table) -> str:
    kind = reference.text("error", "estimate")
    if kind not in ERROR_KINDS:
        raise reference.error("error", f"must be one of {', '.join(ERROR_KINDS)}, not {kind!r}")
    return kind


def _reference_method(reference: Table) -> str:
    method = reference.text("method", BOTH)
    if method not in REFERENCE_METHODS:
        raise reference.error("method", f"must be one of {', '.join(REFERENCE_METHODS)}, not {method!r}")
    return method


def _rtol(reference: Table, otherwise: float | None) -> float:
    rtol = reference.positive("rtol", otherwise)
    if rtol >= 1 and otherwise is None:
        raise reference.error("rtol", f"is a relative accuracy, less than 1, not {rtol!r}")
    return rtol


def _methods(model: Table) -> tuple[str, ...]:
    methods = model.value("methods")
    if not isinstance(methods, list) or not all(isinstance(method, str) for method in methods):
        raise model.error("methods", "must be a list of strings")
    for method in methods:
        for former, now in _FORMER_METHODS.items():
            if re.fullmatch(former, method) is not None:
                raise model.error("methods", f"{method!r} is now called {now}: write {now}")
        if re.fullmatch(METHOD_PATTERN, method) is None:
            raise model.error("methods", f"must be {METHODS}, not {method!r}")
    if "exact" not in methods:
        raise model.error("methods", 'must hold "exact", the method that is compared with the reference')
    return tuple(methods)


def _sweep(sweep: Table) -> Iterator[Case]:
    """Yields the cases of a sweep."""
    alone = _alone(sweep)
    for case in _cases(sweep):
        yield replace(case, alone=alone)


def _alone(sweep: Table) -> float | None:
    """Returns the accuracy asked of boundary elements as a sweep's only reference; None if the sweep has no reference of its own."""
    if not sweep.has("reference"):
        return None
    reference = sweep.table("reference")
    reference.allow_only(("method", "rtol"))
    method, rtol = reference.text("method"), _rtol(reference, None)
    if method != BOUNDARY_ELEMENTS:
        raise reference.error("method", f"of a sweep can only be {BOUNDARY_ELEMENTS}, not {method!r}")
    return rtol


def _cases(sweep: Table) -> Iterator[Case]:
    family = sweep.text("family")
    if family == scene_sweep.FAMILY:
        for lengths_of, scene in scene_sweep.scenes(sweep):
            yield _case(family, dict(lengths_of), scene)
        return
    if family not in FAMILIES:
        known = ", ".join([*FAMILIES, scene_sweep.FAMILY])
        raise sweep.error("family", f"unknown family {family!r}; there are {known}")
    function = FAMILIES[family]
    kinds = {name: hint for name, hint in get_type_hints(function).items() if name != "return"}
    sweep.allow_only(("family", "combine", "reference", *kinds))
    combine = sweep.text("combine", "product")
    if combine not in ("product", "zip"):
        raise sweep.error("combine", f"must be product or zip, not {combine!r}")
    defaults = {name: parameter.default for name, parameter in inspect.signature(function).parameters.items()}
    values = {
        name: [defaults[name]]
        if defaults[name] is not inspect.Parameter.empty and not sweep.has(name)
        else _values(sweep, name, kinds[name])
        for name in kinds
    }
    if combine == "product" and math.prod(map(len, values.values())) > _MOST_CASES:
        raise sweep.error("", f"makes more than {_MOST_CASES} cases")
    for parameters in _combinations(sweep, values, combine):
        try:
            scene = function(**parameters)
        except InputError as error:
            raise InputError(
                sweep.source, sweep.key(error.key), f"{error.reason} (in {_listed(parameters)})"
            ) from error
        yield _case(family, parameters, scene)


def _values(sweep: Table, name: str, kind: object) -> list[Parameter]:
    """Returns the values of a parameter: a single one, or those of a list or a range. `kind` is float, str, or else a vector."""
    value = sweep.value(name)
    if isinstance(value, dict):
        if kind is not float:
            raise sweep.error(name, "only numbers may be given as a range; give a list")
        return _range(sweep.table(name))
    if kind is str:
        texts = value if isinstance(value, list) else [value]
        if not texts or not all(isinstance(text, str) for text in texts):
            raise sweep.error(name, f"must be a string or a list of strings, not {value!r}")
        return list(texts)
    if kind is not float:
        vectors = value if isinstance(value, list) and value and isinstance(value[0], list) else [value]
        return [cast(Vector2, sweep.as_vector(name, vector, 2)) for vector in vectors]
    numbers = value if isinstance(value, list) else [value]
    if not numbers:
        raise sweep.error(name, "must hold at least one value")
    return [sweep.as_number(name, number) for number in numbers]


def _range(table: Table) -> list[Parameter]:
    if len(table.keys()) != 1 or table.keys()[0] not in ("linspace", "geomspace"):
        raise table.error("", "a range is { linspace = [first, last, number] } or { geomspace = … }")
    kind = table.keys()[0]
    first, last, number = table.vector(kind, 3)
    if number < 2 or number != int(number):
        raise table.error(kind, f"needs an integer number of values, at least 2, not {number!r}")
    if number > _MOST_CASES:
        raise table.error(kind, f"makes more than {_MOST_CASES} cases")
    if kind == "geomspace" and (first <= 0 or last <= 0):
        raise table.error(kind, "needs ends greater than 0")
    count = int(number)
    values = np.geomspace(first, last, count) if kind == "geomspace" else np.linspace(first, last, count)
    return [float(value) for value in values]


def _combinations(
    sweep: Table, values: dict[str, list[Parameter]], combine: str
) -> Iterator[dict[str, Parameter]]:
    if combine == "product":
        yield from (dict(zip(values, chosen)) for chosen in itertools.product(*values.values()))
        return
    lengths = {name: len(swept) for name, swept in values.items() if len(swept) > 1}
    if len(set(lengths.values())) > 1:
        lengths_of = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise sweep.error("combine", f"zip needs lists of equal length, not {lengths_of}")
    for index in range(max(lengths.values(), default=1)):
        yield {name: swept[index] if len(swept) > 1 else swept[0] for name, swept in values.items()}


def _case(family: str, parameters: dict[str, Parameter], scene: Scene) -> Case:
    text, hashed = canonical_and_identity(scene)
    return Case(hashed, family, parameters, scene, text)


def _listed(parameters: dict[str, Any]) -> str:
    return ", ".join(f"{name} = {list(v) if isinstance(v, tuple) else v}" for name, v in parameters.items())
