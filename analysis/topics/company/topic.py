"""Experiment VII as a topic: what company makes of a reading."""

from analysis.topics.company import factors, section, set_ups
from analysis.topics.company.factors import Entry
from analysis.topics.company.field_check import CHECK
from analysis.topics.company.stage import STAGES
from analysis.topics.company.set_ups import SetUp
from analysis.topics.topic import Topic

COMPANY = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=factors.entry,
    sections=lambda found, checks, _: [section.section(found, checks)],
    finding=section.finding,
    absent=section.ABSENT,
    title="The model in company",
    question="What does a machine around the sensor change?",
    short="in company",
    reproduce="From the project's folder: the readings of a set-up, which is named as in the numbers, and those of all that have none yet.",
    check=CHECK,
)
