"""From stored answers to `table.csv` and `report.html`."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from analysis import keys, results, statistics, table
from analysis.corrections import page as corrections_page, stage as corrections_stage
from analysis.verification import page as verification_page, stage as verification_stage
from analysis.store import Document, write_text

REPORT, TABLE = "report.html", "table.csv"
# The mark of the inputs stands in the first lines of a page whose script takes megabytes.
_MARK_WITHIN = 1000


@dataclass(frozen=True)
class Report:
    """Where the report is, what it says in few numbers, and how many cases are short of the asked accuracy."""

    path: Path
    summaries: list[statistics.Summary]
    not_reached: int


def make(folder: Path) -> Report:
    """Write the table and the report of the results in a folder, unless they are up to date; InputError without results."""
    found = results.load(folder)
    rows = table.rows(found)
    summaries = statistics.summaries(rows)
    verified = verification_stage.load(verification_page.beside(folder))
    corrected = corrections_stage.load(corrections_stage.beside(folder))
    inputs = f"{_inputs(folder, found, verified)} {corrections_page.inputs(corrected)}"
    if not ((folder / TABLE).is_file() and is_current(folder / REPORT, inputs)):
        write_text(folder / TABLE, table.to_csv(rows, found.methods))
        write_text(folder / REPORT, _page(found, rows, summaries, verified, corrected, inputs))
    solved = [case.reference for case in found.cases.values() if case.reference is not None]
    return Report(folder / REPORT, summaries, sum(not answer.reached for answer in solved))


def _inputs(folder: Path, found: results.Results, verified: dict[str, Document]) -> str:
    """A hash of everything the report is made from: the answers, what was asked, and the code of this package."""
    files = [
        folder / name for name in (results.MANIFEST, results.RUN_TIMES, results.STABILITY, *results.COLLISION)
    ]
    for case in found.cases.values():
        files += [case.folder / name for name in (results.REFERENCE, results.MODEL, results.SLICE)]
    answers = keys.hash_of_files((path for path in files if path.is_file()), folder)
    return hashlib.sha256(f"{answers} {verification_page.inputs(verified)}".encode()).hexdigest()


def is_current(page: Path, inputs: str) -> bool:
    """Whether a page was made from just these inputs."""
    from analysis.page import inputs_mark

    if not page.is_file():
        return False
    with page.open(encoding="utf-8") as file:
        return inputs_mark(inputs) in file.read(_MARK_WITHIN)


def _page(
    found: results.Results,
    rows: list[table.Row],
    summaries: list[statistics.Summary],
    verified: dict[str, Document],
    corrected: Document | None,
    inputs: str,
) -> str:
    # Imported here: plotly takes a second, and a report that is up to date needs none.
    from analysis.corrections import section as corrections_section
    from analysis.experiments import section as experiments_section
    from analysis import (
        collision_section,
        page,
        plot_of_time,
        plots_in_space,
        plots_of_errors,
        run_times_section,
        sections,
        stability_section,
        symmetry,
    )

    body = [sections.headline(found, summaries), sections.failures(found), experiments_section.section(found)]
    if rows:
        plots = [
            plots_of_errors.model_against_reference(rows),
            plots_of_errors.error_over_gap(rows),
            plots_of_errors.error_over_tilt(rows),
            plots_of_errors.error_over_offset(rows),
            plots_of_errors.error_over_size_ratio(rows),
            plot_of_time.time_against_error(rows),
            *plots_in_space.pictures(rows),
        ]
        body += [page.plot_section(plot) for plot in plots]
    body += [
        corrections_section.section(corrected),
        run_times_section.section(found.run_times),
        stability_section.section(found.stability),
        collision_section.section(found.collision),
        sections.trust(found, rows, symmetry.pairs(found.compared())),
        *verification_page.sections(verified),
        sections.all_rows(found, rows),
        sections.reproduce(found, rows),
    ]
    return page.document(found.title, inputs, body)
