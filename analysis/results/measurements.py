"""Measurements of the model by itself: run times and errors of its methods, errors and conditioning of the integral."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.store import Document

NOT_MEASURED = (
    "These results have no measurement by this version of the model on this machine: ./run does it with the default study, and "
    "python3 -m analysis run STUDY --measure-model with any."
)
"""What a section says of a measurement that is missing."""


@dataclass(frozen=True)
class Origin:
    """Where a measurement comes from: the machine's processor and instruction sets, and the command that repeats it."""

    processor: str
    instruction_sets: str
    command: str


@dataclass(frozen=True)
class MethodTime:
    """One method on one set of triangles. `error` is the largest relative error, `triangles` how many were evaluated."""

    set: str
    method: str
    seconds_per_triangle: float
    error: float
    triangles: int


@dataclass(frozen=True)
class RunTimes:
    """Every method on every set, in the benchmark's order."""

    origin: Origin
    compiler: str
    times: tuple[MethodTime, ...]


@dataclass(frozen=True)
class MethodErrors:
    """One method on one class of triangles; the errors are those of the finite values, None when there is none.

    `not_finite` are those whose truth is finite and not zero; `wrong_by_1_percent` are all that are off by more than that,
    among them finite values of divergent integrals.
    """

    triangles: int
    not_finite: int
    wrong_by_1_percent: int
    largest_over_conditioning: float | None
    percentile_99_over_conditioning: float | None


@dataclass(frozen=True)
class StabilityClass:
    """Triangles of one kind with the methods evaluated on them. For `truth_failed` of them no accurate value is known."""

    name: str
    truth_failed: int
    methods: dict[str, MethodErrors]


@dataclass(frozen=True)
class Stability:
    """`limit` is the allowed ratio of error to conditioning; `passed` tells whether the program found nothing wrong."""

    origin: Origin
    passed: bool
    limit: float
    classes: tuple[StabilityClass, ...]


def run_times(document: Document | None) -> RunTimes | None:
    """Returns the times in a stored answer of the benchmark; None without one."""
    if document is None:
        return None
    answer = document["answer"]
    # The minimum over the repetitions: other work on the machine only makes a method slower.
    found: dict[tuple[str, str], MethodTime] = {}
    # Their repetitions come in any order; the index says where the benchmark has them.
    for entry in sorted(answer["benchmarks"], key=lambda entry: int(entry["family_index"])):
        if entry["run_type"] == "iteration":
            time = _method_time(entry)
            known = found.get((time.set, time.method), time)
            found[time.set, time.method] = min(known, time, key=lambda t: t.seconds_per_triangle)
    return RunTimes(origin(document), answer["context"]["compiler"], tuple(found.values()))


def stability(document: Document | None) -> Stability | None:
    """Returns the errors in a stored answer of the stress program; None without one."""
    if document is None:
        return None
    answer = document["answer"]
    classes = tuple(
        StabilityClass(
            entry["name"],
            entry["truth_failed"],
            {
                name: _method_errors(errors)
                for name, errors in entry["methods"].items()
                if errors["triangles"] > 0
            },
        )
        for entry in answer["classes"]
    )
    return Stability(origin(document), document["passed"], float(answer["limit"]), classes)


def origin(document: Document) -> Origin:
    """Returns where a stored answer comes from."""
    return Origin(document["processor"], document["instruction_sets"], document["command"])


def _method_time(entry: Document) -> MethodTime:
    name, method = entry["name"].split("/")[:2]
    return MethodTime(
        name, method, float(entry["per_triangle"]), float(entry["error"]), int(entry["triangles"])
    )


def _method_errors(errors: Document) -> MethodErrors:
    return MethodErrors(**{name: errors[name] for name in MethodErrors.__dataclass_fields__})
