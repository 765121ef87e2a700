"""The report's section on the integral's errors, compared with its conditioning: the effect of rounding its input."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import measured, page
from analysis.results.store import Document

TITLE = "Stability of the integral"
EXACT, _THESIS = "exact", "thesis"

_LABELS = {_THESIS: "the thesis' formula"}
_WHAT = (
    "Conditioning is the largest relative change of the true value when the coordinates of triangle and plate move by one unit "
    "in the last place, at least 1.2e-16: a method that stays below a small multiple of it is as accurate as its input. The "
    "truth is quadrature of the distance itself in multiple precision, without any closed form. The thesis' formula (5.3.1) "
    "is for region I and is asked there only."
)


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

    passed: bool
    limit: float
    classes: tuple[StabilityClass, ...]


def stability(document: Document) -> Stability:
    """Returns the errors in a stored answer of the stress program."""
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
    return Stability(document["passed"], float(answer["limit"]), classes)


def _method_errors(errors: Document) -> MethodErrors:
    return MethodErrors(**{name: errors[name] for name in MethodErrors.__dataclass_fields__})


def section(document: Document | None) -> Markup:
    """Returns the finding, and for every class the error over the conditioning and the counts of wrong values."""
    return measured.section(TITLE, [document], _parts)


def _parts(document: Document) -> Iterator[Markup]:
    found = stability(document)
    yield page.finding(finding(found))
    yield page.paragraph(
        "Error over conditioning, the largest and what 99 % are below; values not finite, values wrong by more than 1 %."
    )
    yield _table(found)
    yield page.soft(_WHAT)


def finding(whole: Stability) -> str:
    """Tells whether the exact method keeps the limit, where it does not, and the worst of every method over all classes."""
    failing = [entry.name for entry in whole.classes if _fails(entry, whole.limit)]
    if failing or not whole.passed:
        verdict = f"{EXACT} fails" + (f", in: {', '.join(failing)}." if failing else ".")
    else:
        verdict = f"{EXACT} keeps the limit of {whole.limit:g} in all {len(whole.classes)} classes."
    sentences = [verdict, *(_sentence(whole, method) for method in methods_of(whole))]
    failed = sum(entry.truth_failed for entry in whole.classes)
    if failed:
        sentences.append(f"The quadrature failed for {failed:,} triangles.")
    return " ".join(sentences)


def methods_of(whole: Stability) -> list[str]:
    """Returns the methods that any class was evaluated with, the exact one first, then the thesis'."""
    return sorted({name for entry in whole.classes for name in entry.methods}, key=_rank)


def _rank(method: str) -> tuple[bool, bool, str]:
    return method != EXACT, method != _THESIS, method


def _fails(entry: StabilityClass, limit: float) -> bool:
    errors = entry.methods.get(EXACT)
    if errors is None:
        return False
    return (
        errors.not_finite + errors.wrong_by_1_percent > 0 or (errors.largest_over_conditioning or 0) > limit
    )


def _sentence(whole: Stability, method: str) -> str:
    found = [entry.methods[method] for entry in whole.classes if method in entry.methods]
    count = sum(errors.triangles for errors in found)
    largest = max((errors.largest_over_conditioning or 0 for errors in found), default=0.0)
    not_finite, wrong = sum(e.not_finite for e in found), sum(e.wrong_by_1_percent for e in found)
    return (
        f"Over {count:,} triangles {_label(method)} is off by up to {largest:.2g} times the conditioning; {not_finite:,} of its "
        f"values are not finite, {wrong:,} are wrong by more than 1 %."
    )


def _label(method: str) -> str:
    return _LABELS.get(method, method)


def _table(whole: Stability) -> Markup:
    methods = methods_of(whole)
    header = ["class", "triangles"]
    for method in methods:
        header += [f"{method}: largest", "99 %", "not finite", "wrong"]
    rows = []
    for entry in whole.classes:
        cells = [cell for method in methods for cell in _cells(entry, entry.methods.get(method))]
        rows.append([entry.name, f"{_triangles(entry):,}", *cells])
    return page.table(header, rows)


def _triangles(entry: StabilityClass) -> int:
    return max((errors.triangles for errors in entry.methods.values()), default=0)


def _cells(entry: StabilityClass, errors: MethodErrors | None) -> list[str]:
    """Writes the cells of a method; one that was evaluated for some triangles of a class also says for how many."""
    if errors is None:
        return [""] * 4
    counts = [f"{errors.not_finite:,}", f"{errors.wrong_by_1_percent:,}"]
    if errors.triangles < _triangles(entry):
        counts = [f"{count} of {errors.triangles:,}" for count in counts]
    sizes = (errors.largest_over_conditioning, errors.percentile_99_over_conditioning)
    return [*("" if size is None else f"{size:.2g}" for size in sizes), *counts]
