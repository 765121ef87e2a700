"""Experiment VIII: which set-ups there are, that stored truths and checks hold, and what page and command tell."""

import re
from collections import Counter

import pytest
from markupsafe import Markup

from analysis.results.answers import Estimate
from analysis.topics.insulators import set_ups, topic
from analysis.topics.insulators.set_ups import (
    BLANKET,
    CHECK,
    COUNTS,
    COVER,
    FILM,
    IGNORING,
    MATTRESS,
    REDUCED,
    TARGET,
    SetUp,
    all_set_ups,
)
from analysis.topics.insulators.topic import INSULATORS as TOPIC, Entry
from analysis.topics.stored import QUANTITIES


def some() -> tuple[SetUp, ...]:
    """The first of each family."""
    return tuple(each for each in all_set_ups() if each.number == 1)


def first(family: str) -> SetUp:
    return next(each for each in some() if each.family == family)


def test_there_are_two_hundred_set_ups_with_covers_films_and_targets() -> None:
    counts = Counter(each.family for each in all_set_ups())
    assert counts == COUNTS and sum(counts.values()) >= 200
    assert counts[COVER] + counts[FILM] == 100 and counts[TARGET] == 50
    assert len({each.identity for each in all_set_ups()}) == sum(counts.values())


def test_every_record_is_of_a_set_up_and_states_its_error() -> None:
    known = set_ups.load()
    assert known.keys() == {each.identity for each in all_set_ups()}
    for each in known.values():
        for truth in (each.insulated, each.without):
            assert 0 < truth.change.value and 0 < truth.change.error < 0.1 * truth.change.value


def test_insulating_targets_have_the_order_of_the_theorem() -> None:
    for each in all_set_ups():
        if each.family == TARGET:
            true = set_ups.load()[each.identity]
            grounded = true.without.change
            assert 0 < true.insulated.change.value < grounded.value + grounded.error


@pytest.mark.parametrize("family", [COVER, TARGET])
def test_stored_changes_are_what_boundary_elements_say(family: str) -> None:
    again = set_ups.read(set_ups.STORED.solve(first(family)))
    assert again.insulated.change.agrees_with(set_ups.load()[first(family).identity].insulated.change)


def test_boundary_elements_solve_a_check_as_it_is_recorded() -> None:
    """Of a cover, which takes a second; targets take many."""
    set_up = next(each for each in CHECK.chosen() if each.family == COVER)
    recorded = CHECK.records()[set_up.identity]["boundary"]
    again = set_ups.by_boundary_elements(set_up)["boundary"]
    assert list(again) == list(QUANTITIES)
    for name in QUANTITIES:
        assert Estimate(**again[name]).agrees_with(Estimate(**recorded[name]))


def test_boundary_elements_agree_with_every_record_of_the_field_solver() -> None:
    told = [f"{each.set_up.name} {each.quantity}" for each in CHECK.comparisons() if each.over_errors > 1]
    assert told == []


def test_the_formula_follows_layers_and_encloses_insulating_targets(found: list[Entry]) -> None:
    for entry in found:
        if entry.set_up.family == MATTRESS:
            assert REDUCED not in entry.changes and IGNORING in entry.changes
            continue
        assert entry.is_enclosed, entry.set_up.name
        if entry.set_up.family in (COVER, FILM):
            assert abs(entry.error(REDUCED)) < abs(entry.error(IGNORING))


def test_the_section_warns_in_numbers(found: list[Entry]) -> None:
    told = topic.warnings(found)
    assert re.search(r"Keep dry: .* [\d.]+ \([\d.]+ to [\d.]+\)", told) and "seen less" in told
    assert f"Over {len(found)} set-ups" in topic.finding(found)
    text = str(topic.section(found, [Markup("what the field solver finds")]))
    assert text.count("plotly-graph-div") == 3 and "refuses all 1" in text and BLANKET in text
    assert "what the field solver finds" in text
