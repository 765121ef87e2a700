"""The verification of the field reference as a topic: known capacitances, and run time against error."""

from __future__ import annotations

from markupsafe import Markup

from analysis.results.store import Document
from analysis.topics.topic import Topic
from analysis.topics.verification import cost_section, records, section
from analysis.topics.verification.stage import Row, Rows, all_rows

Entry = tuple[str, Document]
"""The name of a row and its answer."""


def truths(found: list[Entry]) -> Markup:
    """Returns the chapter on known capacitances; one sentence without rows."""
    rows = dict(found)
    missing = [row.id for row in all_rows() if row.id not in rows] if rows else []
    return section.chapter(records.compared(rows), missing)


def costs(found: list[Entry]) -> Markup:
    """Returns the section on the reference's run times; empty without rows."""
    if not found:
        return Markup("")
    from analysis.topics.verification.set_ups import cost_cases

    asked = [
        records.Asked(case.name, case.caption, case.targets, case.truth, case.truth_error)
        for case in cost_cases().values()
    ]
    known = [cost for cost in (records.cost(dict(found), case) for case in asked) if cost is not None]
    return cost_section.section(known)


def _finding(found: list[Entry]) -> str:
    compared = records.compared(dict(found))
    return section.finding(compared) if compared else section.ABSENT


VERIFICATION = Topic[Row, Entry](
    stages=Rows(),
    set_ups=all_rows,
    entry=lambda row, answer: (row.id, answer),
    sections=lambda found, _, __: [truths(found), costs(found)],
    finding=_finding,
    absent=section.ABSENT,
    title="Verification of the field reference",
    introduction="Is the field reference right, are its stated errors right, and what does it cost? One command computes every number of this page.",
    command="verify",
)
