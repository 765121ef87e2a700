"""The report's section on how long the model's methods take and how wrong they are, on fixed sets of triangles."""

from collections.abc import Iterator, Sequence

from markupsafe import Markup

from analysis.report import page
from analysis.results.statistics import front
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


def by_set(benchmarks: Sequence[Document]) -> dict[str, dict[str, Document]]:
    """Returns the entries of a benchmark by their sets and methods, both in the benchmark's order."""
    sets: dict[str, dict[str, Document]] = {}
    # Their repetitions come in any order; the index says where the benchmark has them.
    for entry in sorted(benchmarks, key=lambda entry: int(entry["family_index"])):
        if entry["run_type"] == "iteration":
            name, method = entry["name"].split("/")[:2]
            known = sets.setdefault(name, {})
            # The minimum over the repetitions: other work on the machine only makes a method slower.
            known[method] = min(known.get(method, entry), entry, key=seconds)
    return sets


def seconds(entry: Document) -> float:
    """Returns the time for a triangle."""
    return float(entry["per_triangle"])


def best(times: dict[str, Document]) -> list[str]:
    """Returns the methods that no other one beats in both time and largest relative error, from fast to accurate."""
    return front(times, lambda method: (seconds(times[method]), float(times[method]["error"])))


def section(document: Document | None) -> Markup:
    """Returns the finding, the table, and how to measure again."""
    compiler = "" if document is None else f"Compiler {document['answer']['context']['compiler']}; "
    return page.measured_section(TITLE, [document], _parts, compiler)


def _parts(document: Document) -> Iterator[Markup]:
    sets = by_set(document["answer"]["benchmarks"])
    words = "ns per triangle, and the largest relative error below. Bold: no other method is both faster and more accurate."
    yield from (page.finding(finding(sets)), page.paragraph(words), _table(sets), page.soft(_SETS))


def finding(sets: dict[str, dict[str, Document]]) -> str:
    """Compares the exact method with the thesis' over all sets, and names the methods on a Pareto front."""
    pairs = [(times[EXACT], times[THESIS]) for times in sets.values() if EXACT in times and THESIS in times]
    on_front = {method for times in sets.values() for method in best(times)}
    chosen = [method for method in _methods(sets) if method in on_front]
    sentence = f"On the front between run time and error, on one set or another, are {', '.join(chosen)}."
    if not pairs:
        return sentence
    ratios = sorted(seconds(thesis) / seconds(exact) for exact, thesis in pairs)
    worst_exact = max(exact["error"] for exact, _ in pairs)
    errors = sorted(thesis["error"] for _, thesis in pairs)
    return (
        f"The method {EXACT} is right to {worst_exact:.1e} on every set. The thesis' {THESIS} takes from {ratios[0]:.2g} to "
        f"{ratios[-1]:.2g} times as long and is wrong by {errors[0]:.0e} to {errors[-1]:.0e}. {sentence}"
    )


def _methods(sets: dict[str, dict[str, Document]]) -> list[str]:
    """Returns all methods in the benchmark's order."""
    return list(dict.fromkeys(method for times in sets.values() for method in times))


def _table(sets: dict[str, dict[str, Document]]) -> Markup:
    titles = ["method"]
    for name, times in sets.items():
        count = max(int(entry["triangles"]) for entry in times.values())
        titles.append(f"{name.replace('_', ' ')}, {count:,} triangles")
    methods = _methods(sets)
    rows = [[page.code(method), *(_cell(times, method) for times in sets.values())] for method in methods]
    return page.table(titles, rows)


def _cell(times: dict[str, Document], method: str) -> str:
    if method not in times:
        return ""
    nanoseconds = seconds(times[method]) / _NANOSECOND
    text = f"{nanoseconds:,.0f}" if nanoseconds >= 100 else f"{nanoseconds:.3g}"
    cell = page.two_lines(text, f"{times[method]['error']:.0e}")
    return page.strong(cell) if method in best(times) else cell
