"""The stored true changes of set-ups on machines: that there is one for each, that boundary elements say the same, and that the field solver's
records agree."""

from __future__ import annotations

import pytest

from analysis.pipeline.model_stage import model_module
from analysis.topics.field_solver import Comparison
from analysis.topics.machines import parts, truths
from analysis.topics.machines.section import Entry
from analysis.topics.machines.set_ups import ARM, HOUSING, PERSON, ROBOT, TABLE, TRANSMIT, SetUp, all_set_ups
from analysis.topics.machines.topic import CHECK, chosen

SAMPLE = ((HOUSING, 7), (TABLE, 5), (ARM, 2), (PERSON, 1), (ROBOT, 4), (TRANSMIT, 4))
"""Quick ones, one of each family."""
MANY = 30
LARGEST_ERROR = 0.06
"""Relative error that the field solver estimates of a change."""


def test_every_set_up_has_a_record_of_every_choice_and_no_other_scene_has() -> None:
    stored = truths.load()
    assert stored.keys() == {each.identity for each in all_set_ups()}
    for each in all_set_ups():
        found = stored[each.identity]
        assert list(found.changes.changes) == list(parts.choices(each))
        assert len(found.pairs) == (0 if each.is_between_sensors else len(each.targets))
        assert 0 < found.changes.full.error <= truths.RTOL * abs(found.changes.full.value)


@pytest.mark.parametrize(("family", "number"), SAMPLE)
def test_stored_changes_are_what_boundary_elements_say(family: str, number: int) -> None:
    set_up = next(each for each in all_set_ups() if (each.family, each.number) == (family, number))
    stored, again = truths.load()[set_up.identity], truths.solved(model_module(), set_up)
    for included, value in again.changes.changes.items():
        assert value.agrees_with(stored.changes.changes[included]), included
    for one, other in zip(stored.pairs, again.pairs, strict=True):
        assert one.mutual.agrees_with(other.mutual) and one.target_own.agrees_with(other.target_own)


def recorded() -> list[Comparison[SetUp]]:
    """The stored true changes beside the field solver's."""
    known = truths.load()
    entries = [Entry(each, known[each.identity].changes, None, {}) for each in chosen()]
    return CHECK.comparisons(entries)


def test_the_field_solvers_records_are_of_these_set_ups_as_they_are_today() -> None:
    """A set-up that changes has another identity: its record is stale, and missing."""
    found = recorded()
    assert len(found) == len(CHECK.records()) >= MANY
    assert {HOUSING, TABLE, TRANSMIT} <= {each.set_up.family for each in found}
    assert {each.set_up.sealed for each in found} == {True, False}
    for each in found:
        assert each.proven[0] < each.field.value < each.proven[1]
        assert 0 < each.field.error < LARGEST_ERROR * abs(each.field.value)


def test_every_true_change_lies_in_the_proven_interval_and_agrees_within_the_stated_errors() -> None:
    found = recorded()
    assert [each.set_up.name for each in found if not each.is_enclosed or each.over_errors > 1] == []
