"""Experiment VII by two methods: what the field solver's records hold, and that boundary elements agree with them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from analysis.pipeline import reference_stage
from analysis.results import store
from analysis.results.answers import Estimate
from analysis.topics.company import field_section
from analysis.topics.company.field_section import Comparison
from analysis.topics.company.set_ups import ARRANGEMENTS, GUARD, MACHINES, TO_GROUND
from analysis.topics.company.stage import STAGES
from analysis.topics.company.topic import CHECK, COMPANY, STORED, chosen
from analysis.topics.field_solver import QUANTITIES

PICO = 1e-12
MANY = 20
LARGEST_ERROR = 0.05
"""Relative error, from the second mesh, of a reading whose sensor is close to a guard."""


def made_up(over_errors: float) -> list[Comparison]:
    """A value that agrees, and one whose methods differ by so many times their errors."""
    set_up = chosen()[0]
    field = Estimate(2 * PICO, 0.01 * PICO)
    apart = Estimate(2 * PICO + over_errors * 0.015 * PICO, 0.005 * PICO)
    background = Estimate(PICO, 0.01 * PICO)
    return [
        Comparison(set_up, "value", field, field),
        Comparison(set_up, "background", background, background),
        Comparison(set_up, "change", field, apart),
    ]


def test_every_machine_is_checked_with_every_connection_and_every_arrangement_occurs() -> None:
    found = chosen()
    kinds = {(each.machine, each.ground) for each in found}
    assert len(kinds) == len(found) == len(MACHINES) * len(TO_GROUND) >= MANY
    assert {each.number for each in found} == set(range(1, ARRANGEMENTS + 1))


def test_the_records_are_of_these_set_ups_as_they_are_today() -> None:
    """A set-up that changes has another identity: its record is stale, and missing."""
    records = STORED.records()
    assert set(records) <= {each.identity for each in chosen()}
    kinds = {(each.machine, each.ground) for each in chosen() if each.identity in records}
    assert {machine for machine, _ in kinds} == set(MACHINES)
    assert {ground for _, ground in kinds} == set(TO_GROUND)
    for record in records.values():
        for quantity in QUANTITIES:
            assert 0 < record[quantity]["error"] < LARGEST_ERROR * record[quantity]["value"]


@pytest.mark.night
def test_boundary_elements_agree_with_every_record(tmp_path: Path) -> None:
    records = STORED.records()
    recorded = [each for each in chosen() if each.identity in records]
    assert STAGES.run(tmp_path, recorded, 2) == []
    found = CHECK.comparisons(COMPANY.found(STAGES.load(tmp_path, recorded)))
    assert len(found) == 3 * len(records)
    assert [each for each in found if each.over_errors > 1] == []
    assert f"{len(found)} of {len(found)} values agree" in field_section.finding(found)


def test_a_difference_beyond_the_errors_is_told_with_its_set_up() -> None:
    agreeing, apart = made_up(0.5), made_up(2.0)
    assert [each.over_errors for each in agreeing] == pytest.approx([0, 0, 0.5])
    assert agreeing[2].difference == pytest.approx(0.00375) and agreeing[2].allowed == pytest.approx(0.0075)
    assert "3 of 3 values agree" in field_section.finding(agreeing)
    assert "change 0.50 of the errors and +0.38 % of the value" in field_section.finding(agreeing)
    told = field_section.finding(apart)
    assert "2 of 3 values agree" in told
    assert told.endswith(f"Beyond their errors: change of set-up {apart[2].set_up.id} (2.00).")


def test_the_section_shows_the_comparison_or_says_that_there_is_none() -> None:
    text = "".join(field_section.parts(made_up(0.5)))
    assert text.count("plotly-graph-div") == 1 and "2.000 ± 0.010" in text and "<td>0.50</td>" in text
    assert [field_section.ABSENT in each for each in field_section.parts([])] == [True]


def test_one_mesh_has_no_error_and_leaves_no_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    guarded = next(each for each in chosen() if each.machine == GUARD)
    asked = []

    def solve(_: Path, __: object, *options: str) -> store.Document:
        asked.append(options)
        return {"levels": [{}]}

    monkeypatch.setattr(reference_stage, "solve", solve)
    assert replace(STORED, file=tmp_path / "checks.json").complete([guarded]) == (0, 1)
    assert f"set-up {guarded.id}: one mesh has no estimated error" in capsys.readouterr().err
    assert not (tmp_path / "checks.json").exists()
    assert asked[0][asked[0].index("--columns") + 1] == "sensor,guard"
