"""The sections of the report that are text and tables; every sentence with a number is computed from the rows."""

import itertools
from collections import Counter
from collections.abc import Callable

import numpy as np
from markupsafe import Markup

from analysis.report import page
from analysis.results.answers import MatrixAnswer
from analysis.results.refusals import refusals
from analysis.results.statistics import ALL_FAMILIES, Summary, grouped
from analysis.results.study_results import COMPARED_METHOD, Results
from analysis.results.symmetry import Pair
from analysis.results.table import CHANGE, QUANTITIES, Row
from analysis.results.truth import BOUNDARY, ESTIMATED, FIELD, PROVEN, in_sentence
from analysis.results.units import percent, signed_percent, too
from geometries.common.measured import PICOFARAD
from geometries.studies.study import NO_REFERENCE

_QUESTION = (
    "How wrong is the fast triangle-integral model of a capacitive proximity sensor, where, and how sure are we? The model "
    "sums ε·∫dA/d over the target's triangles, d being the shortest distance to the sensor's plate. Two references solve the "
    "field of the same conductors in free space and state their own errors: the field solver by finite elements, the other by boundary "
    "elements. Every value is compared with the one of them that states less error, and says which."
)
_QUANTITIES = (
    "Three quantities are compared. mutual = −M[s,o] is the charge on the grounded target for each volt on the sensor: what "
    "the model's formula claims to be. delta_self = M[s,s] − M0[s,s] is the rise of the sensor's own capacitance because "
    "the target is there: what its electronics feels, if nothing else is. M is the Maxwell capacitance matrix, M0 that of the sensor "
    "alone. Where a machine stays when the target goes, change takes its place: a reading of the electronics with the targets less the "
    "same without them. Without a machine the change is delta_self, and is listed only there."
)
_ERROR = (
    "Model error = (model − reference)/reference; the median is that of its size without the sign. An error bar on it is the "
    "reference's own error carried over; the two are never added up."
)

FILES = (
    "Beside this page: table.csv with a row for each case and quantity, of a sensor and an object, of a sensor, or of a reading, and the folder cases with the answers and "
    "the page of every case. A click on a point in a plot opens its case, and CSV beside its caption the plot's data."
)


def refused(results: Results) -> Markup:
    """Returns a sentence for each reason for which a method refuses cases; empty without any."""
    told = (refusal.sentence for refusal in refusals(results))
    return page.lines(page.paragraph(f"{sentence[0].upper()}{sentence[1:]}.") for sentence in told)


def answered_by(rows: list[Row]) -> str:
    """Tells by which method the values are known, and what kind of error it states."""
    counts = Counter((row.known.answered_by, row.known.error_kind) for row in rows)
    told = [
        f"{counts[method, kind]} by {in_sentence(method)} with {kind} errors"
        for method, kind in itertools.product((FIELD, BOUNDARY), (PROVEN, ESTIMATED))
        if counts[method, kind]
    ]
    kept = sum(row.known.field_is_proven and row.known.answered_by != FIELD for row in rows)
    wider = f" The field solver proves wider intervals of {kept} of them, which table.csv keeps."
    proven = wider if kept else ""
    return f"Of {len(rows)} values, {' and '.join(told)}: the method that states less error answers.{proven}"


def headline(results: Results, rows: list[Row], summaries: list[Summary]) -> Markup:
    """Returns what the words mean, and the model errors for each family and quantity: on machines first, where there are any."""
    summaries = sorted(summaries, key=lambda summary: summary.quantity != CHANGE)
    whole = {summary.quantity: summary for summary in summaries if summary.family == ALL_FAMILIES}
    meaning = [page.paragraph(text) for text in (_QUESTION, _QUANTITIES, _ERROR)]
    parts = [page.folded("What the words mean", page.lines(meaning))]
    for quantity, summary in whole.items():
        where = "On machines, change of the reading" if quantity == CHANGE else quantity
        sure = "of at least one of them no reference knows more than its order of magnitude."
        if summary.sure_to < 1:
            sure = f"the reference is sure to {percent(summary.sure_to)} or better."
        told = (
            f"{where}: the model is {percent(summary.rms)} off (rms over {summary.count} cases), median {percent(summary.median)}, "
            f"worst {too(summary.worst)}; {sure}"
        )
        parts.append(page.finding(told))
    if rows:
        parts.append(page.paragraph(answered_by(rows)))
    if not summaries:
        return page.lines(parts)
    table = page.table_of(
        summaries,
        ("quantity", lambda s: s.quantity),
        ("family, or machine", lambda s: s.family),
        ("cases", lambda s: str(s.count)),
        ("rms", lambda s: percent(s.rms)),
        ("median size", lambda s: percent(s.median)),
        ("worst", lambda s: too(s.worst)),
        ("reference sure to", lambda s: percent(s.sure_to) if s.sure_to < 1 else "unknown"),
        ("worst case", lambda s: page.case_link(s.worst_case, results.cases[s.worst_case].name, "cases")),
        text_columns=2,
        strong=frozenset(index for index, each in enumerate(summaries) if each.family == ALL_FAMILIES),
    )
    return page.beside(parts, [table])


def trust(results: Results, rows: list[Row], pairs: list[Pair]) -> Markup:
    """Returns why the reference can be believed: set-ups that must agree, delta_self in two ways, accuracies not reached.
    Empty if the study does not use the reference."""
    if results.error == NO_REFERENCE:
        return Markup("")
    parts = *_pairs(pairs), *_checks(rows), *_accuracy(results, rows)
    return page.section("Agreement and accuracy in this study", *parts)


def _pairs(pairs: list[Pair]) -> list[Markup]:
    title = page.heading("Set-ups that must agree")
    if not pairs:
        return [title, page.paragraph("The study holds no pair of set-ups whose answers must agree.")]
    agreeing = sum(pair.agrees for pair in pairs)
    largest = max(pair.difference for pair in pairs)
    table = page.table_of(
        pairs,
        ("first", lambda pair: page.case_link(pair.first.id, pair.first.name)),
        ("second", lambda pair: page.case_link(pair.second.id, pair.second.name)),
        ("relation", lambda pair: pair.relation),
        ("quantity", lambda pair: pair.quantity),
        ("by", lambda pair: pair.method),
        ("first (pF)", lambda pair: pair.first_value.in_picofarads),
        ("second (pF)", lambda pair: pair.second_value.in_picofarads),
        ("difference", lambda pair: f"{pair.difference:.1e}"),
        ("within errors", lambda pair: "yes" if pair.agrees else "no"),
        text_columns=5,
    )
    sentence = (
        f"{agreeing} of {len(pairs)} comparisons of mirrored or exchanged set-ups agree within the sum of their errors; the "
        f"largest difference is {largest:.1e} of the value."
    )
    return [title, page.finding(sentence), table]


def _checks(rows: list[Row]) -> list[Markup]:
    checked = [(row.known.field or row.reference, row.check) for row in rows if row.check is not None]
    title = page.heading("delta_self in two ways")
    if not checked:
        none = "No case has a reference of the sensor alone to check delta_self with."
        return [title, page.paragraph(none)]
    agreeing = sum(value.agrees_with(check) for value, check in checked)
    largest = max(abs(value.value - check.value) for value, check in checked)
    sentence = (
        f"delta_self from two solutions on one mesh, and as the difference of two separate solves: {agreeing} of "
        f"{len(checked)} cases agree within the sum of their errors; the largest difference is {largest / PICOFARAD:.2g} pF."
    )
    return [title, page.finding(sentence)]


def _accuracy(results: Results, rows: list[Row]) -> list[Markup]:
    known = [(case.name, case.reference) for case in results.cases.values() if case.reference is not None]
    solved = [answer for _, answer in known]
    short = [name for name, answer in known if not answer.reached]
    parts = [page.heading("Accuracy")]
    if solved:
        worst = max((row.reference_error for row in rows), default=0.0)
        seconds = np.median([answer.seconds for answer in solved])
        told = (
            f"{len(solved) - len(short)} of {len(solved)} solves reached the asked relative accuracy of {results.rtol:g}, in "
            f"{seconds:.1f} s (median) each; the largest relative error of a compared value is {worst:.1e}."
        )
        parts.append(page.finding(told))
    enclosed = [answer for answer in solved if answer.is_proven]
    if enclosed:
        parts.append(page.finding(_widths(enclosed)))
    if short:
        parts.append(page.paragraph(f"Short of it, kept with their wider errors: {'; '.join(short)}."))
    methods = sorted({answer.method for answer in solved})
    return parts + [page.soft(f"How the error is obtained: {method}.") for method in methods]


def _widths(enclosed: list[MatrixAnswer]) -> str:
    """Returns how far the proven bounds of the entries are from the best values."""
    own = [answer.error[0, 0] / answer.maxwell[0, 0] for answer in enclosed]
    mutual = [answer.error[0, 1] / -answer.maxwell[0, 1] for answer in enclosed if len(answer.maxwell) > 1]
    sentence = (
        f"In {len(enclosed)} solves the truth is enclosed, not estimated: the first sensor's own entry to within "
        f"{np.median(own):.1e} of its best value (median; worst {max(own):.1e})"
    )
    if mutual:
        sentence += f", the mutual one to within {np.median(mutual):.1e} (worst {max(mutual):.1e})"
    return f"{sentence}."


def failures(results: Results) -> Markup:
    """Returns the cases whose computation failed, with the reason; what is refused has sentences of its own."""
    failed = [failure for failure in results.failures if not failure.refused]
    if not failed:
        return Markup("")
    return page.section(
        "Failed cases",
        page.finding(f"{len(failed)} answers are missing; the numbers above do not include them."),
        page.table_of(
            failed,
            ("case", lambda failure: results.cases[failure.case].name if failure.case else ""),
            ("stage", lambda failure: failure.stage),
            ("reason", lambda failure: failure.reason),
            text_columns=3,
        ),
    )


def all_rows(rows: list[Row]) -> Markup:
    """Returns every row with its case's page, which has the commands that recompute it."""

    def of_model(shown: Callable[[Row], str]) -> Callable[[Row], str]:
        return lambda row: shown(row) if row.is_compared else ""

    table = page.table_of(
        rows,
        ("case", lambda row: page.case_link(row.case.id, row.case.name)),
        ("quantity", lambda row: f"{row.quantity} {row.reading}".strip()),
        ("reference (pF)", lambda row: row.reference.in_picofarads),
        ("by", lambda row: row.known.answered_by),
        ("exact model (pF)", of_model(lambda row: f"{row.model[COMPARED_METHOD] / PICOFARAD:.5f}")),
        ("model error", of_model(lambda row: signed_percent(row.model_error, 2))),
        ("from", of_model(lambda row: signed_percent(row.model_error_interval[0], 2))),
        ("to", of_model(lambda row: signed_percent(row.model_error_interval[1], 2))),
        ("reached", lambda row: "yes" if row.reached else "no"),
        text_columns=2,
    )
    return page.section(
        "Every row",
        page.paragraph(
            f"The same {len(rows)} rows, in full precision and with the other methods, are in table.csv beside report.html. The "
            "files of a case are in the folder cases/<case>, with its page, which draws it."
        ),
        page.folded("Show the rows", table),
    )


def reproduce(results: Results, rows: list[Row]) -> Markup:
    """Returns where the commands are, the versions and the machine."""
    return page.section(
        "Reproduce",
        page.paragraph(
            "A click on a point in a plot, or on a row above, opens the page of its case, whose commands compute its answers anew; table.csv has "
            "that of every value. The plots of model errors need the commands of reference and model, the run times of the model are those of "
            "--method exact or split:N, the slices of the potential come from the reference's command with --slice FILE."
        ),
        page.heading("Versions and machine"),
        page.table(["what", "which"], _versions(results, rows), text_columns=2),
    )


def _versions(results: Results, rows: list[Row]) -> list[list[str]]:
    used: list[tuple[str, str]] = []
    for case in results.cases.values():
        used += (case.reference.versions if case.reference else {}).items()
        used += [("model", case.model.version)] if case.model is not None else []
    software = grouped(used, lambda each: each[0]).items()
    versions_of = {name: ", ".join(sorted({version for _, version in own})) for name, own in software}
    counts = Counter(row.quantity for row in rows)
    counted = {f"rows of {quantity}": str(counts[quantity]) for quantity in QUANTITIES}
    return [[name, value] for name, value in (versions_of | results.machine | counted).items()]
