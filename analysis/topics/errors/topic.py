"""The parts of the model's error as a topic."""

from analysis.topics.errors import case_page, records, section, set_ups
from analysis.topics.errors.parts import PARTS
from analysis.topics.errors.records import Entry
from analysis.topics.errors.set_ups import STAGES, SetUp
from analysis.topics.topic import Topic


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
    title=case_page.TITLE,
    question=case_page.TITLE,
    short="parts of the error",
    cases=case_page.make,
)
