"""Experiment VII by two methods: what the field solver's records hold, and that boundary elements agree with them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from analysis.pipeline import reference_stage
from analysis.results import store
from analysis.topics.company.set_ups import ARRANGEMENTS, GUARD, MACHINES, STAGES, TO_GROUND
from analysis.topics.company.topic import CHECK, COMPANY, chosen
from analysis.topics.field_solver import QUANTITIES

MANY = 20
LARGEST_ERROR = 0.05
"""Relative error, from the second mesh, of a reading whose sensor is close to a guard."""


def test_every_machine_is_checked_with_every_connection_and_every_arrangement_occurs() -> None:
    found = chosen()
    kinds = {(each.machine, each.ground) for each in found}
    assert len(kinds) == len(found) == len(MACHINES) * len(TO_GROUND) >= MANY
    assert {each.number for each in found} == set(range(1, ARRANGEMENTS + 1))


def test_the_records_are_of_these_set_ups_as_they_are_today() -> None:
    """A set-up that changes has another identity: its record is stale, and missing."""
    records = CHECK.records()
    assert set(records) <= {each.identity for each in chosen()}
    kinds = {(each.machine, each.ground) for each in chosen() if each.identity in records}
    assert {machine for machine, _ in kinds} == set(MACHINES)
    assert {ground for _, ground in kinds} == set(TO_GROUND)
    for record in records.values():
        for quantity in QUANTITIES:
            assert 0 < record[quantity]["error"] < LARGEST_ERROR * record[quantity]["value"]


@pytest.mark.night
def test_boundary_elements_agree_with_every_record(tmp_path: Path) -> None:
    records = CHECK.records()
    recorded = [each for each in chosen() if each.identity in records]
    assert STAGES.run(tmp_path, recorded, 2) == []
    found = CHECK.comparisons(COMPANY.found(STAGES.load(tmp_path, recorded)))
    assert len(found) == 3 * len(records)
    assert [each for each in found if each.over_errors > 1] == []


def test_one_mesh_has_no_error_and_leaves_no_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    guarded = next(each for each in chosen() if each.machine == GUARD)
    asked = []

    def solve(_: Path, __: object, *options: str) -> store.Document:
        asked.append(options)
        return {"levels": [{}]}

    monkeypatch.setattr(reference_stage, "solve", solve)
    assert replace(CHECK, file=tmp_path / "field_checks.json").complete([guarded]) == (0, 1)
    assert f"set-up {guarded.id}: one mesh has no estimated error" in capsys.readouterr().err
    assert not (tmp_path / "field_checks.json").exists()
    assert asked[0][asked[0].index("--columns") + 1] == "sensor,guard"
