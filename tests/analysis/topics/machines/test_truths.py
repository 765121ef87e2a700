"""The stored true changes of set-ups on machines: that there is one for each, and that boundary elements say the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from analysis.pipeline.model_stage import model_module
from analysis.topics.machines import parts, truths
from analysis.topics.machines.set_ups import ARM, HOUSING, PERSON, ROBOT, TABLE, TRANSMIT, all_set_ups

SAMPLE = ((HOUSING, 7), (TABLE, 5), (ARM, 2), (PERSON, 1), (ROBOT, 4), (TRANSMIT, 4))
"""Quick ones, one of each family."""


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
    for chosen, value in again.changes.changes.items():
        assert value.agrees_with(stored.changes.changes[chosen]), chosen
    for one, other in zip(stored.pairs, again.pairs, strict=True):
        assert one.mutual.agrees_with(other.mutual) and one.target_own.agrees_with(other.target_own)


def test_what_has_no_record_is_solved_and_what_is_no_set_up_is_dropped(tmp_path: Path) -> None:
    stored = replace(truths.STORED, file=tmp_path / "truths.json")
    first, second = (each for each in all_set_ups() if each.family == HOUSING and each.number in (2, 7))
    assert stored.complete([first]) == (1, 0)
    assert stored.complete([first, second]) == (1, 0)
    assert stored.complete([second]) == (0, 0)
    assert list(stored.records()) == [second.identity]
    changes = stored.records()[second.identity]["changes"]
    assert [tuple(each["included"]) for each in changes] == list(parts.choices(second))
