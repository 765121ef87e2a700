"""The pages of a study's report, one for each question. A line in QUESTIONS makes a page, its navigation and its card in the index."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from markupsafe import Markup

from analysis.report import (
    collision_section,
    page,
    plots_of_errors,
    run_times_section,
    sections,
    stability_section,
)
from analysis.results import statistics, study_results as results, symmetry, table
from analysis.results.store import Document, read_json
from analysis.topics import cross_check
from analysis.topics.company.topic import COMPANY
from analysis.topics.corrections.topic import CORRECTIONS
from analysis.topics.errors.topic import ERRORS
from analysis.topics.experiments import section as experiments_section
from analysis.topics.insulators.topic import INSULATORS
from analysis.topics.machines.topic import MACHINES
from analysis.topics.published.topic import PUBLISHED
from analysis.topics.topic import Topic
from analysis.topics.trade_off import measure as trade_off, section as trade_off_section
from analysis.topics.verification import topic as verification
from analysis.topics.verification.topic import VERIFICATION
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


@dataclass(frozen=True)
class Question:
    """A page: `name` of its file, `short` title for the navigation, and the sections; without sections there is no page. `own` tells
    whether it is about the study's set-ups; the index shows the first finding of those."""

    name: str
    short: str
    title: str
    body: Callable[[Material], list[Markup]]
    own: bool = True


def _experiment(material: Material) -> list[Markup]:
    return [experiments_section.section(material.found)]


def _model_error(material: Material) -> list[Markup]:
    rows = table.compared(material.rows)
    if not rows:
        return []
    plots = [plots_of_errors.model_against_reference(rows)]
    # Only set-ups of one plate before another have the lengths and angles over which the error is plotted.
    if any(row.set_up is not None for row in rows):
        plots += plots_of_errors.errors_over_set_ups(rows)
    return [page.plot_section(plot) for plot in plots]


def _parts(material: Material) -> list[Markup]:
    return ERRORS.shown(material.entries[ERRORS.name], ERRORS_CASES)


def set_ups_file(topic: Topic[Any, Any]) -> str:
    """Returns the page that shows all set-ups of a topic, relative to the folder of pages."""
    return f"set_ups/{topic.name}.html"


def _shown(topic: Topic[Any, Any], material: Material) -> list[Markup]:
    return topic.shown(material.entries[topic.name], set_ups_file(topic))


def _about(topic: Topic[Any, Any]) -> Question:
    """Returns the page of a topic whose set-ups are none of the study's."""
    return Question(topic.name, topic.short, topic.question, partial(_shown, topic), own=False)


def _reference(material: Material) -> list[Markup]:
    pairs = symmetry.pairs(material.found.compared())
    trusted = sections.trust(material.found, material.rows, pairs)
    return [trusted, verification.truths(material.entries[VERIFICATION.name])]


def _cross_check(material: Material) -> list[Markup]:
    both = material.found.error != NO_REFERENCE and material.found.reference_method == BOTH
    return cross_check.sections(material.found) if both else []


def _run_time(material: Material) -> list[Markup]:
    folder = material.found.folder
    return [
        trade_off_section.section(trade_off.load(folder), material.found, page.CASES),
        run_times_section.section(read_json(folder / results.RUN_TIMES)),
    ]


def _stability(material: Material) -> list[Markup]:
    return [stability_section.section(read_json(material.found.folder / results.STABILITY))]


def _collisions(material: Material) -> list[Markup]:
    stored = (read_json(material.found.folder / name) for name in results.COLLISION)
    return [collision_section.section(*stored)]


def _set_ups(material: Material) -> list[Markup]:
    return [
        sections.all_rows(material.found, material.rows),
        sections.reproduce(material.found, material.rows),
    ]


QUESTIONS = (
    Question("experiment", "experiment", "What does the experiment find?", _experiment),
    _about(MACHINES),
    Question("model_error", "model error", "How wrong is the model, and where?", _model_error),
    Question("error_parts", ERRORS.short, ERRORS.question, _parts, own=False),
    _about(COMPANY),
    _about(INSULATORS),
    _about(CORRECTIONS),
    _about(PUBLISHED),
    Question("reference", "reference", "How sure is the reference?", _reference),
    Question(CROSS_CHECK, "cross-check", "Do two independent methods agree?", _cross_check),
    Question("run_time", "run time", "What does accuracy cost?", _run_time),
    Question("stability", "stability", "Is the integral stable?", _stability, own=False),
    Question("collisions", "collisions", "Are collisions found, and how fast?", _collisions, own=False),
    Question("set_ups", "set-ups", "Which set-ups are these, and how are they reproduced?", _set_ups),
)
