"""Changes on machines by the field solver: what is recorded, and that boundary elements agree with it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from analysis.results.answers import Estimate
from analysis.topics.machines import field_section, truths
from analysis.topics.machines.topic import CHECK, STORED, chosen
from analysis.topics.machines.field_section import Comparison
from analysis.topics.machines.records import Entry
from analysis.topics.machines.set_ups import HOUSING, TABLE, TRANSMIT

MANY = 30
LARGEST_ERROR = 0.06
"""Relative error that the field solver estimates of a change."""


def recorded() -> list[Comparison]:
    """The stored true changes beside the field solver's."""
    known = truths.load()
    entries = [Entry(each, known[each.identity].changes, None, {}) for each in chosen()]
    return CHECK.comparisons(entries)


def test_the_records_are_of_these_set_ups_as_they_are_today() -> None:
    """A set-up that changes has another identity: its record is stale, and missing."""
    found = recorded()
    assert len(found) == len(STORED.records()) >= MANY
    assert {HOUSING, TABLE, TRANSMIT} <= {each.set_up.family for each in found}
    assert {each.set_up.sealed for each in found} == {True, False}
    for each in found:
        assert each.proven[0] < each.field.value < each.proven[1]
        assert 0 < each.field.error < LARGEST_ERROR * abs(each.field.value)


def test_every_true_change_lies_in_the_proven_interval_and_agrees_within_the_stated_errors() -> None:
    found = recorded()
    assert [each.set_up.name for each in found if not each.is_enclosed or each.over_errors > 1] == []
    assert f"{len(found)} of the {len(found)} true changes" in field_section.finding(found)


def test_a_true_change_beyond_the_errors_or_the_interval_is_told_with_its_set_up() -> None:
    whole = recorded()[0]
    field, upper = whole.field, whole.proven[1]
    apart = replace(whole, boundary=Estimate(field.value + 3 * field.error, field.error))
    outside = replace(whole, boundary=Estimate(2 * upper, 2 * upper))
    assert apart.over_errors == pytest.approx(1.5) and apart.is_enclosed and not outside.is_enclosed
    told = field_section.finding([whole, apart, outside])
    assert "2 of the 3 true changes" in told and "2 of 3 agree" in told
    assert told.endswith(f"Not so: {apart.set_up.name}, {outside.set_up.name}.")


def test_the_section_shows_the_comparison_or_says_that_there_is_none() -> None:
    text = "".join(field_section.parts(recorded()[:2]))
    assert text.count("plotly-graph-div") == 1 and text.count("<td>yes</td>") == 2
    assert [field_section.ABSENT in each for each in field_section.parts([])] == [True]
