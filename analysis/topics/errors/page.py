"""The page of the errors' parts and maps, and a page for every set-up."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import page, plots_in_space
from analysis.report.page import is_current
from analysis.results.set_up import describe
from analysis.results.store import write_text
from analysis.results.units import picofarads, signed_percent
from analysis.topics.errors import records, section, set_ups, stage
from analysis.topics.errors.parts import PARTS
from analysis.topics.errors.records import Entry
from geometries.common import installation

PAGE = "errors.html"
_TITLE = "Where does the model's error come from?"


def make(folder: Path) -> page.Made:
    """Writes the page of the answers in a folder and those of its set-ups, unless they are up to date."""
    chosen = set_ups.all_set_ups()
    answers = stage.STAGES.load(folder, chosen)
    found = records.entries(answers, chosen)
    inputs = keys.page_inputs(answers)
    if not is_current(folder / PAGE, inputs):
        page.provide_script(folder)
        for entry in records.once(found):
            _make_case(folder, entry)
        body = [page.header(_TITLE), *section.sections(found, "cases")]
        write_text(folder / PAGE, page.document(_TITLE, inputs, body, page.SCRIPT))
    distinct = records.once(found)
    findings = [section.finding(distinct, quantity) for quantity in PARTS] if found else [section.ABSENT]
    return page.Made(folder / PAGE, "\n".join(findings))


def _make_case(folder: Path, entry: Entry) -> None:
    text = page.document(entry.set_up.name, entry.set_up.id, _case(folder, entry), f"../../{page.SCRIPT}")
    write_text(folder / "cases" / entry.set_up.id / page.CASE_PAGE, text)


def _case(folder: Path, entry: Entry) -> Iterable[Markup]:
    made = entry.set_up
    yield page.navigation(page.link(f"../../{PAGE}", f"‹ {_TITLE}"))
    head = []
    described = describe(made.scene)
    if described is not None:
        head.append(page.paragraph(f"{described.words}."))
    for quantity in PARTS:
        true = entry.true(quantity)
        head.append(
            page.finding(
                f"{quantity}: {picofarads(true.value, true.error)} pF by boundary elements; the model is "
                f"{signed_percent(entry.error(quantity))} off, mostly by {entry.largest(quantity)}."
            )
        )
    yield page.header(made.name, *head)
    yield page.figures([plots_in_space.in_space(made.scene)])
    yield page.section("The parts of the error", *section.of_one(entry))
    scene = installation.from_repository(folder / "cases" / made.id / "scene.toml")
    yield page.section(
        "Reproduce",
        page.paragraph(
            "From the project's folder: the truth, the model, and the parts of every set-up that has none yet."
        ),
        page.command(
            f"{installation.model_command()} capacitance {scene} --method boundary-elements --rtol {stage.RTOL:g}"
        ),
        page.command(f"{installation.model_command()} capacitance {scene}"),
        page.command(
            f"{installation.command('analysis')} errors --output {installation.from_repository(folder)}"
        ),
        page.command(f"{installation.command('fem_reference')} {scene} --slice slice.json"),
    )
