"""The report's section on how long the model's methods take and how wrong they are, on fixed sets of triangles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import measured, page
from analysis.results.store import Document

TITLE = "Run time against error of the integral"
EXACT, THESIS = "exact", "split:4"

_NANOSECOND = 1e-9
_SETS = (
    "Triangles in the regions I (in front of the plate), II (beside an edge) and III (diagonal to a corner), of 0.02 (fine) "
    "and 0.3 (coarse) of their distance in size; small ones astride two cells around the plate, as a fine mesh has them; "
    "triangles larger than the plate that reach into up to nine cells; a closed mesh around all cells. split:N is the "
    "thesis' method with 4^N equal triangles, gauss:K a product rule of K² nodes; exact lays the triangles out anew each time, "
    "batch has them laid out once, tolerance:T too and each triangle within T; tree:T gives only the sum, within T, by a tree "
    "made once. Errors are relative to quadrature in extended precision, the largest of the set or, where a method is slow, of "
    "an evenly spread sample; times are those of one core, the smallest of three."
)


@dataclass(frozen=True)
class MethodTime:
    """One method on one set of triangles. `error` is the largest relative error, `triangles` how many were evaluated."""

    set: str
    method: str
    seconds_per_triangle: float
    error: float
    triangles: int


def by_set(document: Document) -> dict[str, list[MethodTime]]:
    """Returns the times in a stored answer of the benchmark by their sets; sets and methods in the benchmark's order."""
    # The minimum over the repetitions: other work on the machine only makes a method slower.
    found: dict[tuple[str, str], MethodTime] = {}
    # Their repetitions come in any order; the index says where the benchmark has them.
    for entry in sorted(document["answer"]["benchmarks"], key=lambda entry: int(entry["family_index"])):
        if entry["run_type"] == "iteration":
            time = _method_time(entry)
            known = found.get((time.set, time.method), time)
            found[time.set, time.method] = min(known, time, key=lambda t: t.seconds_per_triangle)
    sets: dict[str, list[MethodTime]] = {}
    for time in found.values():
        sets.setdefault(time.set, []).append(time)
    return sets


def _method_time(entry: Document) -> MethodTime:
    name, method = entry["name"].split("/")[:2]
    return MethodTime(
        name, method, float(entry["per_triangle"]), float(entry["error"]), int(entry["triangles"])
    )


def section(document: Document | None) -> Markup:
    """Returns the finding, the table, and how to measure again."""
    compiler = "" if document is None else f"Compiler {document['answer']['context']['compiler']}; "
    return measured.section(TITLE, [document], _parts, compiler)


def _parts(document: Document) -> Iterator[Markup]:
    sets = by_set(document)
    yield page.finding(finding(sets))
    yield page.paragraph(
        "ns per triangle, and the largest relative error below. Bold: no other method is both faster and more accurate."
    )
    yield _table(sets)
    yield page.soft(_SETS)


def front(times: list[MethodTime]) -> list[MethodTime]:
    """Returns the Pareto front: the methods that no other method beats in both time and error, from fast to accurate."""
    best: list[MethodTime] = []
    for time in sorted(times, key=lambda t: (t.seconds_per_triangle, t.error)):
        if not best or time.error < best[-1].error:
            best.append(time)
    return best


def finding(sets: dict[str, list[MethodTime]]) -> str:
    """Compares the exact method with the thesis' over all sets, and names the methods on a Pareto front."""
    pairs = []
    for times in sets.values():
        named = {time.method: time for time in times}
        if EXACT in named and THESIS in named:
            pairs.append((named[EXACT], named[THESIS]))
    best = {time.method for times in sets.values() for time in front(times)}
    chosen = [method for method in methods_of(sets) if method in best]
    sentence = f"On the front between run time and error, on one set or another, are {', '.join(chosen)}."
    if not pairs:
        return sentence
    ratios = sorted(thesis.seconds_per_triangle / exact.seconds_per_triangle for exact, thesis in pairs)
    worst_exact = max(exact.error for exact, _ in pairs)
    errors = sorted(thesis.error for _, thesis in pairs)
    return (
        f"The method {EXACT} is right to {worst_exact:.1e} on every set. The thesis' {THESIS} takes from {ratios[0]:.2g} to "
        f"{ratios[-1]:.2g} times as long and is wrong by {errors[0]:.0e} to {errors[-1]:.0e}. {sentence}"
    )


def methods_of(sets: dict[str, list[MethodTime]]) -> list[str]:
    """Returns all methods in the benchmark's order."""
    return list(dict.fromkeys(time.method for times in sets.values() for time in times))


def _title(times: list[MethodTime]) -> str:
    return f"{times[0].set.replace('_', ' ')}, {max(time.triangles for time in times):,} triangles"


def _table(sets: dict[str, list[MethodTime]]) -> Markup:
    cells = {}
    for name, times in sets.items():
        best = {time.method for time in front(times)}
        cells.update({(name, time.method): _cell(time, time.method in best) for time in times})
    rows = [
        [page.code(method), *(cells.get((name, method), "") for name in sets)] for method in methods_of(sets)
    ]
    return page.table(["method", *(_title(times) for times in sets.values())], rows)


def _cell(time: MethodTime, strong: bool) -> str:
    nanoseconds = time.seconds_per_triangle / _NANOSECOND
    text = f"{nanoseconds:,.0f}" if nanoseconds >= 100 else f"{nanoseconds:.3g}"
    cell = page.two_lines(text, f"{time.error:.0e}")
    return page.strong(cell) if strong else cell
