"""The corrections in a report: what the section tells of a document, and of one that it cannot use."""

from pathlib import Path

import pytest

from analysis.results import store
from analysis.topics.corrections import section, topic
from analysis.topics.corrections.topic import CORRECTIONS
from tests.analysis.synthetic import corrections_document

SET_UPS = "set_ups/corrections.html"


@pytest.mark.parametrize(
    "earlier", [{"corrections": []}, {**corrections_document(), "corrections": [{"name": "none"}]}]
)
def test_an_answer_of_an_earlier_form_counts_as_none(tmp_path: Path, earlier: store.Document) -> None:
    store.write_json(tmp_path / topic.DOCUMENT, {"key": "", **earlier})
    assert not CORRECTIONS.load(tmp_path)
    made = CORRECTIONS.make(tmp_path)
    assert section.ABSENT in made.path.read_text() and not (tmp_path / "set_ups.html").exists()


def test_the_page_by_itself_leads_to_that_of_its_set_ups(tmp_path: Path) -> None:
    store.write_json(tmp_path / topic.DOCUMENT, corrections_document())
    made = CORRECTIONS.make(tmp_path)
    assert made.headline == section.finding(corrections_document())
    assert 'data-set-ups="set_ups.html"' in made.path.read_text()
    assert f'href="{CORRECTIONS.file}"' in (tmp_path / "set_ups.html").read_text()


def test_the_section_tells_the_errors_and_the_times() -> None:
    document = corrections_document()
    told = section.finding(document)
    assert (
        "2.1 % off (rms)" in told
        and "at 2.2 to 2.2 times" in told
        and "2 % off (rms) and 7 % at worst in all 9" in told
    )
    text = section.section(document, SET_UPS)
    assert section.COMMAND in text and text.count(f'data-set-ups="{SET_UPS}"') == 2
    assert "within 5 % in 1 of 2 set-ups and worst in parallel-001, −6 % at 0.2 sensor sizes" in text
