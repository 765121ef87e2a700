"""The corrections of the model as a topic: their errors and run times, evaluated and measured together."""

from __future__ import annotations

from analysis.pipeline.set_up_stages import Whole
from analysis.results.store import Document
from analysis.topics.corrections import cases_section, section
from analysis.topics.corrections.stage import Evaluated
from analysis.topics.topic import Topic

CORRECTIONS = Topic[Whole, Document](
    stages=Evaluated(),
    set_ups=lambda: (Whole(),),
    entry=lambda _, answer: answer,
    sections=lambda found, _, set_ups: [section.section(found[0], set_ups)],
    finding=lambda found: section.finding(found[0]),
    absent=section.ABSENT,
    title="Corrections",
    question="What can be corrected, and at what cost?",
    short="corrections",
    set_ups_page=lambda found, *around: cases_section.set_ups_document(found[0]["cases"], *around),
)
