"""Changes on machines by the field solver: what is recorded, and that boundary elements agree with it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from analysis.pipeline.processes import Processes
from analysis.results.answers import Estimate
from analysis.topics.machines import field_check, field_section, truths
from analysis.topics.machines.field_check import Comparison, FieldCheck, chosen
from analysis.topics.machines.set_ups import HOUSING, TABLE, TRANSMIT

MANY = 30
LARGEST_ERROR = 0.06
"""Relative error that the field solver estimates of a change."""


def recorded() -> list[Comparison]:
    """The stored true changes beside the field solver's."""
    checks, known = field_check.load(), truths.load()
    return [
        Comparison(each, known[each.identity].changes.full, checks[each.identity])
        for each in chosen()
        if each.identity in checks
    ]


def test_the_records_are_of_these_set_ups_as_they_are_today() -> None:
    """A set-up that changes has another identity: its record is stale, and missing."""
    found = recorded()
    assert len(found) == len(field_check.load()) >= MANY
    assert {HOUSING, TABLE, TRANSMIT} <= {each.set_up.family for each in found}
    assert {each.set_up.sealed for each in found} == {True, False}
    for each in found:
        assert each.field.lower < each.field.change.value < each.field.upper
        assert 0 < each.field.change.error < LARGEST_ERROR * abs(each.field.change.value)


def test_every_true_change_lies_in_the_proven_interval_and_agrees_within_the_stated_errors() -> None:
    found = recorded()
    assert [each.set_up.name for each in found if not each.is_enclosed or each.over_errors > 1] == []
    assert f"{len(found)} of the {len(found)} true changes" in field_section.finding(found)


def test_a_true_change_beyond_the_errors_or_the_interval_is_told_with_its_set_up() -> None:
    whole = recorded()[0]
    field = whole.field.change
    apart = replace(whole, change=Estimate(field.value + 3 * field.error, field.error))
    outside = replace(whole, change=Estimate(2 * whole.field.upper, 2 * whole.field.upper))
    assert apart.over_errors == pytest.approx(1.5) and apart.is_enclosed and not outside.is_enclosed
    told = field_section.finding([whole, apart, outside])
    assert "2 of the 3 true changes" in told and "2 of 3 agree" in told
    assert told.endswith(f"Not so: {apart.set_up.name}, {outside.set_up.name}.")


def test_the_section_shows_the_comparison_or_says_that_there_is_none() -> None:
    text = "".join(field_section.parts(recorded()[:2]))
    assert text.count("plotly-graph-div") == 1 and text.count("<td>yes</td>") == 2
    assert [field_section.ABSENT in each for each in field_section.parts([])] == [True]


def test_the_command_solves_what_has_no_record_and_drops_what_is_no_set_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = chosen()[:2]
    check = FieldCheck(Estimate(2.0, 0.01), lower=1.5, upper=2.5, seconds=1.0)
    solved = []

    def solve(set_up: object, _: Processes) -> FieldCheck:
        solved.append(set_up)
        return check

    monkeypatch.setattr(field_check, "solved", solve)
    monkeypatch.setattr(field_check, "chosen", lambda: (first, second))
    file = tmp_path / "checks.json"
    assert field_check.load(file) == {}
    assert field_check.make(file) == 0 and solved == [first, second]
    assert field_check.load(file) == {first.identity: check, second.identity: check}
    document = json.loads(file.read_text())
    document["checks"]["another"] = document["checks"].pop(first.identity)
    file.write_text(json.dumps(document))
    assert field_check.make(file) == 0 and solved == [first, second, first]
    assert set(field_check.load(file)) == {first.identity, second.identity}
