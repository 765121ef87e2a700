"""The page of one case: drawn in space, the potential around it, its numbers, and the commands that compute them anew."""

from collections.abc import Iterable
from dataclasses import asdict

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.pipeline.model_stage import knows, model_is_built
from analysis.report import page, plots_in_space
from analysis.results.answers import MatrixAnswer
from analysis.results.store import write_text
from analysis.results import study_results
from analysis.results.study_results import BOUNDARY, MODEL, REFERENCE, SCENE, SLICE, CaseResult, Results
from analysis.results.table import CHANGE, DELTA_SELF, MUTUAL, Row
from analysis.results.truth import FIELD, Known, in_sentence
from analysis.results.units import duration, in_words, signed_percent
from analysis.topics.errors import topic as errors_topic
from analysis.topics.errors.set_ups import Entry
from geometries.common.measured import PICOFARAD, picofarads
from geometries.studies.study import EMPTY, NO_REFERENCE

_FILES = (SCENE, REFERENCE, MODEL, BOUNDARY, SLICE)
_SCRIPT = f"../../{page.SCRIPT}"


def make(results: Results, case: CaseResult, rows: list[Row], apart: Entry | None) -> None:
    """Writes the page of a case unless it is up to date. `apart` holds the parts of its error, if they are
    known."""
    target = case.folder / page.CASE_PAGE
    inputs = _inputs(results, case, apart)
    if not page.is_current(target, inputs):
        body = _body(results, case, rows, apart)
        write_text(target, page.document(case.name, inputs, body, _SCRIPT))


def _inputs(results: Results, case: CaseResult, apart: Entry | None) -> str:
    """Returns a hash of everything the page is made from."""
    files = [path for path in (case.folder / name for name in _FILES) if path.is_file()]
    answers = keys.hash_of_files(files, results.folder)
    asked = [results.title, results.rtol, results.max_seconds, results.error, case.parameters]
    # Without the model's module a page shows no parts.
    split = asdict(apart.split) if apart is not None else None
    return keys.page_inputs(answers, asked, model_is_built(), split)


def _body(results: Results, case: CaseResult, rows: list[Row], apart: Entry | None) -> Iterable[Markup]:
    back = page.link("../../report.html", f"‹ {results.title}")
    yield page.navigation(back, page.link("../../report/set_ups.html", "all cases"))
    head = [page.paragraph(f"{in_words(case.parameters)}."), *(page.finding(_finding(row)) for row in rows)]
    if not rows and case.truth is not None:
        known = {f"{DELTA_SELF} of {name}": case.truth.delta_self(name) for name in case.truth.sensors}
        head += [page.finding(_without_model(*each)) for each in known.items()]
    yield page.header(case.name, *head)
    panels = plots_in_space.panels(case)
    # The first picture shows how much each part of the target adds, if the model answers the scene.
    if case.model is not None and model_is_built():
        panels[0] = plots_in_space.coloured(case.scene)
    yield page.figures(panels, with_data=False)
    if case.slice is None and results.error != NO_REFERENCE and case.by_field:
        yield page.paragraph("No slice of its potential is stored. This command computes one:")
        yield page.command(f"{study_results.reference_command(results, case.id)} --slice slice.json")
    if rows:
        yield page.section("Numbers", *_numbers(case, rows))
    if apart is not None:
        yield page.section("The parts of the model's error", *errors_topic.of_one(apart))
    matrices = [*_matrix(case.reference), *_second_matrix(case.boundary)]
    if matrices:
        yield page.section("Maxwell matrix", *matrices)
    yield page.section("Reproduce", *_commands(results, case))


def _finding(row: Row) -> str:
    whose = f"{row.quantity} of {row.reading or row.sensor}" + (f" and {row.object}" if row.object else "")
    if not row.is_compared:
        return _without_model(whose, row.known)
    low, high = row.model_error_interval
    return (
        f"{whose}: {row.reference.in_picofarads} pF by {_by(row.known)}; the model is "
        f"{signed_percent(row.model_error, 2)} off ({signed_percent(low, 2)} to {signed_percent(high, 2)} over the reference's error bar)."
    )


def _without_model(whose: str, known: Known) -> str:
    return f"{whose}: {known.best.in_picofarads} pF by {_by(known)}; the model has no answer."


def _by(known: Known) -> str:
    """Names the method of the best value, and the kind of its error."""
    return f"{in_sentence(known.answered_by)} ({known.error_kind} error)"


def _numbers(case: CaseResult, rows: list[Row]) -> list[Markup]:
    seconds = {method: each for row in rows for method, each in row.model_seconds.items()}
    whose = [" ".join(filter(None, (row.quantity, row.reading or row.sensor, row.object))) for row in rows]
    header = ["method", *whose, "time"]
    assert case.truth is not None
    lines = [
        [f"{method} (pF)", *(_said(row.known, method) for row in rows), duration(answer.seconds)]
        for method, answer in case.truth.answers.items()
    ]
    for method, taken in seconds.items():
        values = [f"{r.model[method] / PICOFARAD:.6g}" if method in r.model else "" for r in rows]
        answered_by = {row.model_answered_by.get(method, method) for row in rows} - {method}
        chosen = f" ({', '.join(sorted(answered_by))})" if answered_by else ""
        lines.append([page.code(method + chosen), *values, duration(taken)])
    parts = [page.table(header, lines)]
    if case.set_up is not None:
        parts.append(page.soft(f"{case.set_up.words}."))
    words = (
        f"{MUTUAL} = −M[s,o], {DELTA_SELF} = M[s,s] − M0[s,s], of which the model's value is the sum over objects, {CHANGE} = a reading "
        "less its background without the targets, of which it is the sum over targets."
    )
    return [*parts, page.soft(words)]


def _said(known: Known, method: str) -> str:
    value = known.field if method == FIELD else known.boundary
    return value.in_picofarads if value is not None else ""


def _matrix(answer: MatrixAnswer | None) -> list[Markup]:
    if answer is None:
        return []
    said = f"pF: charge on the row's conductor per volt on the column's; {answer.unknowns:,} unknowns"
    return [_entries(answer), page.soft(f"{said}, {_effort(answer)}.")]


def _second_matrix(answer: MatrixAnswer | None) -> list[Markup]:
    if answer is None:
        return []
    known = answer.delta_self.items()
    changes = ", ".join(f"{DELTA_SELF} of {name} {change.in_picofarads} pF" for name, change in known)
    note = page.soft(f"{_effort(answer)}; {changes}.")
    return [page.heading("By boundary elements"), _entries(answer), note]


def _effort(answer: MatrixAnswer) -> str:
    return f"{duration(answer.seconds)}, {'within' if answer.reached else 'short of'} the asked accuracy"


def _entries(answer: MatrixAnswer) -> Markup:
    numbers = zip(answer.conductors, answer.maxwell, answer.error)
    rows = [[name, *map(picofarads, values, errors)] for name, values, errors in numbers]
    return page.table(["", *answer.conductors], rows)


def _commands(results: Results, case: CaseResult) -> list[Markup]:
    parts = [page.paragraph("From the project's folder:")]
    if results.error != NO_REFERENCE and case.by_field:
        parts.append(page.command(study_results.reference_command(results, case.id)))
    if case.family != EMPTY and knows(case.scene):
        parts.append(page.command(study_results.model_command(results, case.id)))
    if case.boundary is not None:
        parts.append(page.command(study_results.boundary_command(results, case.id)))
    files = [page.link(name, name) for name in _FILES if (case.folder / name).is_file()]
    return [*parts, page.paragraph(Markup("Beside this page: {}.").format(Markup(", ").join(files)))]
