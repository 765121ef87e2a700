"""The model on machines as a topic."""

from analysis.topics.machines import records, section, set_ups, truths
from analysis.topics.machines.field_check import CHECK
from analysis.topics.machines.records import Entry
from analysis.topics.machines.stage import STAGES
from analysis.topics.machines.set_ups import SetUp
from analysis.topics.topic import Topic

MACHINES = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=records.entry,
    sections=lambda found, checks, _: [section.section(found, checks)],
    finding=section.finding,
    absent=section.ABSENT,
    title="The model on machines",
    question="How wrong is the model on a machine?",
    short="on machines",
    reproduce=(
        "From the project's folder: the reading of a set-up, which is named as in the numbers; the comparison of all; and the true changes that are not stored."
    ),
    truths=truths.STORED,
    check=CHECK,
)
