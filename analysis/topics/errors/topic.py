"""The parts of the model's error as a topic."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from markupsafe import Markup

from analysis.report import page, plots_in_space
from analysis.results.set_up import describe
from analysis.results.store import write_text
from analysis.results.units import too
from analysis.topics.errors import records, section, set_ups
from analysis.topics.errors.parts import PARTS
from analysis.topics.errors.records import Entry
from analysis.topics.errors.set_ups import STAGES, SetUp
from analysis.topics.topic import Topic
from geometries.common import installation
from geometries.common.measured import picofarads

TITLE = "Where does the model's error come from?"


def make(folder: Path, found: list[Entry]) -> None:
    """Writes the page of every set-up."""
    for entry in records.once(found):
        text = page.document(entry.set_up.name, entry.set_up.id, _case(folder, entry), f"../../{page.SCRIPT}")
        write_text(folder / "cases" / entry.set_up.id / page.CASE_PAGE, text)


def _case(folder: Path, entry: Entry) -> Iterable[Markup]:
    made = entry.set_up
    yield page.navigation(page.link(f"../../{set_ups.STAGES.name}.html", f"‹ {TITLE}"))
    head = []
    described = describe(made.scene)
    if described is not None:
        head.append(page.paragraph(f"{described.words}."))
    for quantity in PARTS:
        true = entry.true(quantity)
        head.append(
            page.finding(
                f"{quantity}: {picofarads(true.value, true.error)} pF by boundary elements; the model is "
                f"{too(entry.error(quantity))}, mostly by {entry.largest(quantity)}."
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
            f"{installation.model_command()} capacitance {scene} --method boundary-elements --rtol {set_ups.RTOL:g} --entries"
        ),
        page.command(f"{installation.model_command()} capacitance {scene}"),
        page.command(
            f"{installation.command('analysis')} errors --output {installation.from_repository(folder)}"
        ),
        page.command(f"{installation.command('fem_reference')} {scene} --slice slice.json"),
    )


def _finding(found: list[Entry]) -> str:
    distinct = records.once(found)
    return "\n".join(section.finding(distinct, quantity) for quantity in PARTS)


ERRORS = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=records.entry,
    sections=lambda found, _, cases: section.sections(found, cases),
    finding=_finding,
    absent=section.ABSENT,
    title=TITLE,
    question=TITLE,
    short="parts of the error",
    cases=make,
)
