"""Changes on machines by the field solver: what is recorded, and that boundary elements agree with it."""

from __future__ import annotations

from analysis.topics.field_solver import Comparison
from analysis.topics.machines import truths
from analysis.topics.machines.topic import CHECK, STORED, chosen
from analysis.topics.machines.records import Entry
from analysis.topics.machines.set_ups import HOUSING, TABLE, TRANSMIT, SetUp

MANY = 30
LARGEST_ERROR = 0.06
"""Relative error that the field solver estimates of a change."""


def recorded() -> list[Comparison[SetUp]]:
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
