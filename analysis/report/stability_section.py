"""The report's section on the integral's errors, compared with its conditioning: the effect of rounding its input."""

from collections.abc import Iterator

from markupsafe import Markup

from analysis.report import page
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


def section(document: Document | None) -> Markup:
    """Returns the finding, and for every class the error over the conditioning and the counts of wrong values."""
    return page.measured_section(TITLE, [document], _parts)


def _parts(document: Document) -> Iterator[Markup]:
    words = "Error over conditioning, the largest and what 99 % are below; values not finite, values wrong by more than 1 %."
    table = _table(_by_class(document))
    yield from (page.finding(finding(document)), page.paragraph(words), table, page.soft(_WHAT))


def _by_class(document: Document) -> dict[str, dict[str, Document]]:
    """Returns the errors of the methods that each class was evaluated with. Those over the conditioning are of the finite values, None if
    there is none."""
    return {
        entry["name"]: {name: errors for name, errors in entry["methods"].items() if errors["triangles"] > 0}
        for entry in document["answer"]["classes"]
    }


def finding(document: Document) -> str:
    """Tells whether the exact method keeps the limit, where it does not, and the worst of every method over all classes."""
    limit, classes = float(document["answer"]["limit"]), _by_class(document)

    def fails(errors: Document) -> bool:
        wrong = errors["not_finite"] + errors["wrong_by_1_percent"]
        return bool(wrong > 0 or (errors["largest_over_conditioning"] or 0) > limit)

    failing = [name for name, errors in classes.items() if EXACT in errors and fails(errors[EXACT])]
    if failing or not document["passed"]:
        verdict = f"{EXACT} fails" + (f", in: {', '.join(failing)}." if failing else ".")
    else:
        verdict = f"{EXACT} keeps the limit of {limit:g} in all {len(classes)} classes."
    sentences = [verdict, *(_sentence(classes, method) for method in _methods(classes))]
    failed = sum(entry["truth_failed"] for entry in document["answer"]["classes"])
    if failed:
        sentences.append(f"The quadrature failed for {failed:,} triangles.")
    return " ".join(sentences)


def _methods(classes: dict[str, dict[str, Document]]) -> list[str]:
    """Returns the methods that any class was evaluated with, the exact one first, then the thesis'."""
    names = {name for errors in classes.values() for name in errors}
    return sorted(names, key=lambda name: (name != EXACT, name != _THESIS, name))


def _sentence(classes: dict[str, dict[str, Document]], method: str) -> str:
    found = [errors[method] for errors in classes.values() if method in errors]
    largest = max(errors["largest_over_conditioning"] or 0 for errors in found)
    counts = "triangles", "not_finite", "wrong_by_1_percent"
    count, not_finite, wrong = (sum(errors[what] for errors in found) for what in counts)
    return (
        f"Over {count:,} triangles {_LABELS.get(method, method)} is off by up to {largest:.2g} times the conditioning; {not_finite:,} of "
        f"its values are not finite, {wrong:,} are wrong by more than 1 %."
    )


def _table(classes: dict[str, dict[str, Document]]) -> Markup:
    methods, rows = _methods(classes), []
    for name, known in classes.items():
        count = max((errors["triangles"] for errors in known.values()), default=0)
        cells = [cell for method in methods for cell in _cells(known.get(method), count)]
        rows.append([name, f"{count:,}", *cells])
    titles = [title for method in methods for title in (f"{method}: largest", "99 %", "not finite", "wrong")]
    return page.table(["class", "triangles", *titles], rows)


def _cells(errors: Document | None, triangles: int) -> list[str]:
    """Writes the cells of a method; one that was evaluated for some triangles of a class also says for how many."""
    if errors is None:
        return [""] * 4
    of = f" of {errors['triangles']:,}" if errors["triangles"] < triangles else ""
    sizes = (errors[f"{which}_over_conditioning"] for which in ("largest", "percentile_99"))
    counts = (f"{errors[what]:,}{of}" for what in ("not_finite", "wrong_by_1_percent"))
    return [*("" if size is None else f"{size:.2g}" for size in sizes), *counts]
