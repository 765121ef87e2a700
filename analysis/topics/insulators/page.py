"""Experiment VIII as a page of its own."""

from __future__ import annotations

from pathlib import Path

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import page
from analysis.report.page import is_current
from analysis.results.store import read_json, write_text
from analysis.topics.insulators import field_check, records, section, set_ups, stage, truths
from geometries.common import installation

PAGE = "insulators.html"
_TITLE = "The model before insulators"


def make(folder: Path) -> page.Made:
    """Writes the page of the answers in a folder, unless it is up to date."""
    chosen = set_ups.all_set_ups()
    answers = stage.STAGES.load(folder, chosen)
    found = records.entries(answers, chosen)
    inputs = keys.page_inputs(answers, read_json(field_check.FILE))
    if not is_current(folder / PAGE, inputs):
        page.provide_script(folder)
        body = [
            page.header(_TITLE),
            section.section(found, field_check.comparisons()),
            _reproduce(folder),
        ]
        write_text(folder / PAGE, page.document(_TITLE, inputs, body, page.SCRIPT))
    return page.Made(folder / PAGE, section.finding(found) if found else section.ABSENT)


def _reproduce(folder: Path) -> Markup:
    scene = f"{installation.from_repository(folder / 'cases')}/SET_UP/scene.toml"
    return page.section(
        "Reproduce",
        page.paragraph(
            "From the project's folder: the reading of a set-up, which is named as in the numbers; the comparison of all; and the true changes and the field "
            "solver's readings that are not stored."
        ),
        page.command(
            f"{installation.model_command()} capacitance {scene} --method boundary-elements --rtol {truths.RTOL:g}"
        ),
        page.command(
            f"{installation.command('analysis')} insulators --output {installation.from_repository(folder)}"
        ),
        page.command(installation.command("analysis.topics.insulators.truths")),
        page.command(installation.command("analysis.topics.insulators.field_check")),
    )
