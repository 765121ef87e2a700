"""Experiment VIII as a topic: what insulators before a sensor make of its reading."""

from analysis.topics.insulators import records, section, set_ups, truths
from analysis.topics.insulators.field_check import CHECK
from analysis.topics.insulators.records import Entry
from analysis.topics.insulators.stage import STAGES
from analysis.topics.insulators.set_ups import SetUp
from analysis.topics.topic import Topic

INSULATORS = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=records.entry,
    sections=lambda found, checks, _: [section.section(found, checks)],
    finding=section.finding,
    absent=section.ABSENT,
    title="The model before insulators",
    question="What do insulators before a sensor change?",
    short="insulators",
    reproduce=(
        "From the project's folder: the reading of a set-up, which is named as in the numbers; the comparison of all; and the true changes and the field "
        "solver's readings that are not stored."
    ),
    truths=truths.STORED,
    check=CHECK,
    is_quick=True,
)
