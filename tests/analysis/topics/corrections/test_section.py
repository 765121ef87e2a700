"""The corrections in a report: what the section tells of a document, and of one that it cannot use."""

from pathlib import Path

import pytest

from analysis.results import store
from analysis.topics.corrections import page, section, stage
from tests.analysis.synthetic import corrections_document

SET_UPS = "set_ups/corrections.html"


@pytest.mark.parametrize("earlier", [{"corrections": []}, {**corrections_document(), "discrepancy": {}}])
def test_an_answer_of_an_earlier_form_counts_as_none(tmp_path: Path, earlier: store.Document) -> None:
    store.write_json(tmp_path / stage.DOCUMENT, {"key": "", **earlier})
    assert stage.load(tmp_path) is None
    made = page.make(tmp_path)
    assert section.ABSENT in made.read_text() and not (tmp_path / page.SET_UPS).exists()


def test_the_section_tells_the_errors_and_the_times() -> None:
    assert section.ABSENT in section.section(None, SET_UPS)
    document = corrections_document()
    told = section.finding(document)
    assert (
        "2.1 % off (rms)" in told
        and "at 2.2 to 2.2 times" in told
        and "2 % off (rms) and 7 % at worst in all 9" in told
    )
    text = section.section(document, SET_UPS)
    assert "f &lt; g" in text and stage.COMMAND in text and text.count(f'data-set-ups="{SET_UPS}"') == 2
    assert "within 5 % in 1 of 2 set-ups and worst in parallel-001, −6 % at 0.2 sensor sizes" in text
