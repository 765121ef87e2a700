"""The corrections in a report: what the section tells of a document, and of one that it cannot use."""

from pathlib import Path

from analysis import store
from analysis.corrections import page, section, stage
from analysis.store import Document
from geometries import families
from geometries.writer import canonical

SET_UPS = "set_ups/corrections.html"


def made_up(name: str, error: float) -> Document:
    """A set-up in which the formula is off by so much."""
    return {
        "name": name,
        "family": "parallel",
        "sealed": True,
        "distance": 0.02,
        "sensor_size": 0.1,
        "truth": 1e-12,
        "error": 1e-16,
        "estimates": {"none": 0.5e-12, "formula": (1 + error) * 1e-12, "recommended": 1e-12},
        "scene": canonical(families.parallel((0.1, 0.1), (0.1, 0.1), 0.02)),
    }


def test_an_answer_of_an_earlier_form_counts_as_none(tmp_path: Path) -> None:
    store.write_json(tmp_path / stage.DOCUMENT, {"key": "", "corrections": []})
    assert stage.load(tmp_path) is None
    made = page.make(tmp_path)
    assert section.ABSENT in made.read_text() and not (tmp_path / page.SET_UPS).exists()


def test_the_section_tells_the_errors_and_the_times() -> None:
    assert section.ABSENT in section.section(None, SET_UPS)
    errors = {"count": 9, "rms": 0.02, "median": 0.01, "percentile_95": 0.04, "worst": 0.07}
    entries = [
        {
            "name": name,
            "formula": "f < g",
            "source": "s",
            "constants": "",
            "cost": "c",
            "all": errors,
            "open": errors,
            "sealed": {**errors, "rms": rms},
            "left_out": errors,
            "families": {"parallel": errors},
        }
        for name, rms in (("none", 0.5), ("formula", 0.021), ("recommended", 0.001))
    ]
    document = {
        "truths": "truths.csv",
        "set_ups": 9,
        "sealed": 3,
        "corrections": entries,
        "discrepancy": {
            "correction": "formula",
            "open": errors,
            "sealed": errors,
            "open_coverage": 0.95,
            "sealed_coverage": 0.94,
        },
        "nanoseconds": {"plate": {"none": 100.0, "formula": 220.0, "recommended": 900.0}},
        "cases": [made_up("parallel-000", 0.01), made_up("parallel-001", -0.06)],
    }
    told = section.finding(document)
    assert (
        "2.1 % off (rms)" in told
        and "at 2.2 to 2.2 times" in told
        and "94%" in told
        and "2 % off (rms) and 7 % at worst in all 9" in told
    )
    text = section.section(document, SET_UPS)
    assert "f &lt; g" in text and stage.COMMAND in text and text.count(f'data-set-ups="{SET_UPS}"') == 2
    assert "within 5% in 1 of 2 set-ups and worst in parallel-001, -6 % at 0.2 sensor sizes" in text
