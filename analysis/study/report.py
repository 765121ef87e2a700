"""Makes `table.csv`, `report.html` and the pages that it links to, one for every question and every case, from stored answers. A line in QUESTIONS makes the page of a
question, its navigation and its card in the index."""

import re
import shutil
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import (
    collision_section,
    index_page,
    page,
    plots_of_errors,
    run_times_section,
    sections,
    stability_section,
)
from analysis.report.index_page import Answer, Card, Picture, ScenePage
from analysis.results import refusals, statistics, study_results as results, symmetry, table
from analysis.results.store import Document, read_json, write_json, write_text
from analysis.study import case_page
from analysis.topics import cross_check
from analysis.topics.all import TOPICS
from analysis.topics.company.topic import COMPANY
from analysis.topics.corrections.topic import CORRECTIONS
from analysis.topics.errors.set_ups import by_reference
from analysis.topics.errors.topic import ERRORS
from analysis.topics.experiments import section as experiments_section
from analysis.topics.insulators.topic import INSULATORS
from analysis.topics.machines.topic import MACHINES
from analysis.topics.published.topic import PUBLISHED
from analysis.topics.topic import Topic
from analysis.topics.trade_off import measure as trade_off, section as trade_off_section
from analysis.topics.trends import page as trends_page
from analysis.topics.verification import topic as verification
from geometries.studies.study import BOTH, NO_REFERENCE

CROSS_CHECK = "cross_check"
"""The page that shows disagreements."""
ERRORS_CASES = "../../errors/cases"
"""The cases of `python3 -m analysis errors`, as seen from a page of a study's report."""


@dataclass(frozen=True, eq=False)
class Material:
    """The data that pages are made from: a study's answers, and the answers and the entries of each topic by its name."""

    found: results.Results
    rows: list[table.Row]
    summaries: list[statistics.Summary]
    answers: dict[str, dict[str, Document]]
    entries: dict[str, list[Any]]

    def stored(self, name: str) -> Document | None:
        """Returns a measurement that is stored beside the study's answers, if there is one."""
        return read_json(self.found.folder / name)


@dataclass(frozen=True)
class Question:
    """A page: `name` of its file, `short` title for the navigation, and the sections; without sections there is no page. `own` tells
    whether it is about the study's set-ups; the index shows the first finding of those."""

    name: str
    short: str
    title: str
    body: Callable[[Material], list[Markup]]
    own: bool = True


def _model_error(material: Material) -> list[Markup]:
    rows = table.compared(material.rows)
    if not rows:
        return []
    plots = [plots_of_errors.model_against_reference(rows)]
    # Only set-ups of one plate before another have the lengths and angles over which the error is plotted.
    if any(row.set_up is not None for row in rows):
        plots += plots_of_errors.errors_over_set_ups(rows)
    return [page.plot_section(plot) for plot in plots]


def set_ups_file(topic: Topic[Any, Any]) -> str:
    """Returns the page that shows all set-ups of a topic, relative to the folder of pages."""
    return f"set_ups/{topic.name}.html"


def _about(topic: Topic[Any, Any], name: str = "", opened: str = "") -> Question:
    """Returns the page of a topic whose set-ups are none of the study's; `opened` is what its points open, if it is not that page of its set-ups."""

    def body(material: Material) -> list[Markup]:
        return topic.shown(material.entries[topic.name], opened or set_ups_file(topic))

    return Question(name or topic.name, topic.short, topic.question, body, own=False)


def _reference(material: Material) -> list[Markup]:
    pairs = symmetry.pairs(material.found.compared())
    trusted = sections.trust(material.found, material.rows, pairs)
    return [trusted, verification.truths(material.entries[verification.VERIFICATION.name])]


def _cross_check(material: Material) -> list[Markup]:
    both = material.found.error != NO_REFERENCE and material.found.reference_method == BOTH
    return cross_check.sections(material.found) if both else []


def _run_time(material: Material) -> list[Markup]:
    by_study = trade_off_section.section(material.stored(trade_off.ANSWER), material.found, page.CASES)
    return [by_study, run_times_section.section(material.stored(results.RUN_TIMES))]


def _all_set_ups(material: Material) -> list[Markup]:
    return [sections.all_rows(material.rows), sections.reproduce(material.found, material.rows)]


def _experiment(material: Material) -> list[Markup]:
    return [experiments_section.section(material.found)]


def _stability(material: Material) -> list[Markup]:
    return [stability_section.section(material.stored(results.STABILITY))]


def _collisions(material: Material) -> list[Markup]:
    return [collision_section.section(*map(material.stored, results.COLLISION))]


QUESTIONS = (
    Question("experiment", "experiment", "What does the experiment find?", _experiment),
    _about(MACHINES),
    Question("model_error", "model error", "How wrong is the model, and where?", _model_error),
    _about(ERRORS, "error_parts", ERRORS_CASES),
    _about(COMPANY),
    _about(INSULATORS),
    _about(CORRECTIONS),
    _about(PUBLISHED),
    Question("reference", "reference", "How sure is the reference?", _reference),
    Question(CROSS_CHECK, "cross-check", "Do two independent methods agree?", _cross_check),
    Question("run_time", "run time", "What does accuracy cost?", _run_time),
    Question("stability", "stability", "Is the integral stable?", _stability, own=False),
    Question("collisions", "collisions", "Are collisions found, and how fast?", _collisions, own=False),
    Question("set_ups", "set-ups", "Which set-ups are these, and how are they reproduced?", _all_set_ups),
)

PAGES = "report"
"""The folder of the pages and of plotly.js, which they share."""
_FINDINGS = "pages.json"
_CASES_IN_FIGURE = re.compile(r'"customdata":\[+"[0-9a-f]{16}"')
_HINT = "A click on a point opens its case."
_HREF = re.compile(r'href="([^"#]+)"')


@dataclass(frozen=True)
class Report:
    """The report's path, its summaries, the number of cases short of the asked accuracy and of those without any reference, the number
    of values on which the two references disagree, and what they refuse."""

    path: Path
    summaries: list[statistics.Summary]
    not_reached: int
    unanswered: int
    disagreements: int
    refusals: list[refusals.Refusal]


def make(folder: Path) -> Report:
    """Writes the table and the report of the results in a folder, unless they are up to date; InputError without results."""
    found = results.load(folder)
    rows = table.rows(found)
    summaries = statistics.summaries(rows)
    of_topics = {topic.name: topic.load(topic.beside(folder)) for topic in TOPICS}
    answers = _answers(folder, found)
    in_field = [topic.checked() for topic in TOPICS]
    inputs = keys.page_inputs(answers, of_topics, in_field)
    trends = folder / trends_page.PAGE
    text = Markup(trends.read_text(encoding="utf-8")) if trends.is_file() else None
    nights = None if text is None else index_page.first_finding(text)
    scenes = index_page.all_beside(folder)
    whole = keys.page_inputs(inputs, nights, [file for _, file in scenes])
    is_current = (folder / table.TABLE).is_file() and page.is_current(folder / page.REPORT, whole)
    if not (is_current and _is_complete(folder)):
        entries = {topic.name: topic.found(of_topics[topic.name]) for topic in TOPICS}
        material = Material(found, rows, summaries, of_topics, entries)
        _write(material, nights, scenes, inputs, whole)
    short, unanswered = len(table.short(found, rows)), len(refusals.unanswered(found))
    apart, refused = cross_check.contradictions(found), refusals.refusals(found)
    return Report(folder / page.REPORT, summaries, short, unanswered, apart, refused)


def _answers(folder: Path, found: results.Results) -> str:
    """Computes a hash of the stored answers and of what was asked."""
    of_study = (results.MANIFEST, results.RUN_TIMES, results.STABILITY, *results.COLLISION, trade_off.ANSWER)
    of_case = (results.REFERENCE, results.MODEL, results.SLICE, results.BOUNDARY)
    files = [folder / name for name in of_study]
    files += [case.folder / name for case in found.cases.values() for name in of_case]
    return keys.hash_of_files((path for path in files if path.is_file()), folder)


def _is_complete(folder: Path) -> bool:
    """Tells whether all files that the report links to exist."""
    text = (folder / page.REPORT).read_text(encoding="utf-8")
    return all((folder / target).is_file() for target in _HREF.findall(text))


def _write(
    material: Material, nights: Markup | None, scenes: list[tuple[ScenePage, str]], inputs: str, whole: str
) -> None:
    """Writes the table, the pages, and last the report itself, which marks all of them as complete. `nights` is the finding of the
    trends, if there are any, and `scenes` are the pages of scenes, with their files."""
    folder = material.found.folder
    write_text(folder / table.TABLE, table.to_csv(material.rows, material.found.methods))
    cards = _pages(material, inputs)
    if nights is not None:
        cards.append(Card(trends_page.PAGE, "What has changed from commit to commit?", nights))
    cards += [Card(file, each.title, each.says) for each, file in scenes]
    warning = cross_check.warning(material.found, f"{PAGES}/{CROSS_CHECK}.html")
    headline = sections.refused(material.found)
    headline += sections.headline(material.found, material.rows, material.summaries)
    if any(row.is_change for row in table.compared(material.rows)):
        headline += page.plot_section(plots_of_errors.error_of_changes(material.rows), "cases")
    headline += trade_off_section.section(material.stored(trade_off.ANSWER), material.found, "cases")
    rest = [sections.failures(material.found), page.soft(sections.FILES)]
    answers = index_page.how_wrong(material.found, material.rows, "cases")
    answers += _answers_of(cards, material)
    body = page.filled(
        "index.html",
        title=material.found.title,
        warning=warning,
        headline=headline,
        answers=answers,
        own=[card for card in cards if card.own],
        others=[card for card in cards if not card.own],
        rest=rest,
    )
    # The script is loaded only where there is a figure.
    script = page.SCRIPT if page.PLOT in headline else ""
    page.write(folder / page.REPORT, page.document(material.found.title, whole, [body], script))


def _answers_of(cards: list[Card], material: Material) -> list[Answer]:
    """Returns which method to use and what speaks for the reference, with the pictures of the pages that tell more."""
    advice = trade_off_section.advice(material.stored(trade_off.ANSWER), material.found)
    agreement = cross_check.in_short(material.found)
    said = {"run_time": ("Which method?", advice), CROSS_CHECK: ("Can the reference be believed?", agreement)}
    shown = {card.target: card for card in cards}
    return [
        Answer(question, says, [Picture(file, shown[file].picture)])
        for name, (question, says) in said.items()
        if says and (file := f"{PAGES}/{name}.html") in shown
    ]


def _pages(material: Material, inputs: str) -> list[Card]:
    """Writes the pages unless they are up to date; returns them as the index shows them."""
    place = material.found.folder / PAGES
    shown_whole = [topic for topic in TOPICS if topic.set_ups_page and material.entries[topic.name]]
    known = read_json(place / _FINDINGS)
    if known is not None and known["made_from"] == inputs:
        shown = [{part: Markup(card[part]) for part in ("says", "picture")} for card in known["pages"]]
        cards = [Card(**card | own) for card, own in zip(known["pages"], shown)]
        needed = [place.parent / card.target for card in cards]
        needed += [place / set_ups_file(topic) for topic in shown_whole]
        if all(path.is_file() for path in needed):
            return cards
    page.provide_script(place.parent)
    cards = _question_pages(material, inputs)
    _set_ups_pages(material, place, shown_whole)
    rows = statistics.grouped(material.rows, lambda row: row.case.id)
    known_parts = by_reference(material.entries[ERRORS.name], material.found)
    apart = {entry.set_up.id: entry for _, entry in known_parts}
    for case in material.found.cases.values():
        case_page.make(material.found, case, rows.get(case.id, []), apart.get(case.id))
    for outdated in set(place.glob("*.html")) - {place.parent / card.target for card in cards}:
        outdated.unlink()
        shutil.rmtree(place / page.DATA / outdated.stem, ignore_errors=True)
    write_json(place / _FINDINGS, {"made_from": inputs, "pages": [asdict(card) for card in cards]})
    return cards


def _set_ups_pages(material: Material, place: Path, topics: list[Topic[Any, Any]]) -> None:
    """Writes the pages of the topics' set-ups that are not up to date into the folder of the pages."""
    for topic in topics:
        inputs, target = keys.page_inputs(material.answers[topic.name]), place / set_ups_file(topic)
        if topic.set_ups_page and not page.is_current(target, inputs):
            back, script = f"../{topic.file}", f"../{Path(page.SCRIPT).name}"
            found = material.entries[topic.name]
            write_text(target, topic.set_ups_page(found, back, topic.question, inputs, script))


def _question_pages(material: Material, inputs: str) -> list[Card]:
    place, title = material.found.folder / PAGES, material.found.title
    bodies = {question: Markup(page.lines(question.body(material)).strip()) for question in QUESTIONS}
    asked = [question for question in QUESTIONS if bodies[question]]
    around = [(f"{question.name}.html", question.short) for question in asked]
    cards = []
    for question in asked:
        file = f"{question.name}.html"
        # Pages whose points open other set-ups say so themselves.
        cases = _CASES_IN_FIGURE.search(bodies[question]) and "data-set-ups" not in bodies[question]
        hint = [page.soft(_HINT)] if cases else []
        others = (page.link(other, short, current=other == file) for other, short in around)
        way = page.navigation(page.link("../report.html", f"‹ {title}"), *others)
        head = page.header(question.title, *hint)
        parts, script = [way, head, bodies[question]], Path(page.SCRIPT).name
        page.write(place / file, page.document(f"{question.title} {title}", inputs, parts, script))
        says = index_page.first_finding(bodies[question])
        picture = index_page.first_picture(bodies[question], question.title)
        cards.append(Card(f"{PAGES}/{file}", question.title, says, picture, question.own))
    return cards
