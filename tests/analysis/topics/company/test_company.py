"""Experiment VII: which set-ups there are, what follows from the answers, and that the field solver's records agree."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline import reference_stage
from analysis.results import store
from analysis.topics.company import topic
from analysis.topics.company.set_ups import (
    ARRANGEMENTS,
    CHECK,
    GUARD,
    HAND,
    HOUSING,
    MACHINES,
    NOTHING,
    PERSON,
    SENSOR,
    STAGES,
    TABLE,
    TO_GROUND,
    SetUp,
    all_set_ups,
    chosen,
)
from analysis.topics.company.topic import COMPANY as TOPIC, TOGETHER, Entry
from analysis.topics.stored import QUANTITIES
from geometries.scene.readings import readings, targets
from geometries.studies.families import FLOATING, GROUNDED


PICO = 1e-12
# What made-up answers are multiplied by.
BY_MACHINE = {NOTHING: 1.0, HOUSING: 0.5, GUARD: 0.75, TABLE: 0.8, PERSON: 0.9}
BY_GROUND = dict(zip(TO_GROUND, (1.0, 0.99, 0.9, 0.6, 0.2)))


def some() -> tuple[SetUp, ...]:
    """Quick ones: the second arrangement by itself and before a housing, the hand grounded and floating."""
    return tuple(
        each
        for each in all_set_ups()
        if each.number == 2 and each.machine in (NOTHING, HOUSING) and each.ground in (GROUNDED, FLOATING)
    )


def made_up() -> list[Entry]:
    """Answers of all set-ups, with known factors; the model is four times the true change by itself. Errors are a thousandth."""
    answers = {}
    for each in all_set_ups():
        alone = each.number * PICO
        change = alone * BY_MACHINE[each.machine] * BY_GROUND[each.ground]
        answers[each.id] = {
            "value": {"value": 5 * PICO + change, "error": 0.0},
            "background": {"value": 5 * PICO, "error": 0.0},
            "change": {"value": change, "error": 1e-3 * change},
            "model": 4 * alone if each.ground == GROUNDED else None,
        }
    return TOPIC.found(answers)


def test_every_arrangement_is_in_every_company_with_every_connection() -> None:
    kinds = {(each.number, each.machine, each.ground) for each in all_set_ups()}
    count = len({each.id for each in all_set_ups()})
    assert count == len(kinds) == len(all_set_ups()) == ARRANGEMENTS * len(MACHINES) * len(TO_GROUND) >= 200


def test_bodies_keep_apart_and_the_hand_alone_comes_and_goes() -> None:
    for each in all_set_ups():
        boxes = {
            name: (triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0))
            for name, triangles in each.scene.conductors().items()
        }
        for (low, high), (other_low, other_high) in combinations(boxes.values(), 2):
            assert np.max(np.maximum(low - other_high, other_low - high)) > 1e-3
        (reading,) = readings(each.scene)
        assert reading.sense == SENSOR
        assert reading.drive == ((SENSOR, "guard") if each.machine == GUARD else (SENSOR,))
        assert [body.name for body, target in zip(each.scene.objects, targets(each.scene)) if target] == [
            HAND
        ]
        (hand,) = (body for body in each.scene.objects if body.name == HAND)
        assert (hand.potential == GROUNDED) == (each.ground == GROUNDED)
        assert hand.to_ground == (0 if each.ground == GROUNDED else TO_GROUND[each.ground])


def test_factors_of_made_up_answers_are_those_put_in() -> None:
    made = {each.what: each for each in topic.factors(made_up())}
    expected = {
        "housing": 0.5,
        "driven guard": 0.75 / 0.5,
        "table": 0.8,
        "second person": 0.9,
        "hand through 1 nF": 0.99,
        "hand through 100 pF": 0.9,
        "hand through 10 pF": 0.6,
        "hand floating": 0.2,
        TOGETHER: 0.5 * 0.2,
    }
    assert set(made) == set(expected)
    for what, value in expected.items():
        each = made[what]
        assert [each.spread.median, each.spread.least, each.spread.greatest] == pytest.approx([value] * 3)
        assert each.error == pytest.approx(2e-3)
        assert len(each.ratios) == (10 if what == TOGETHER else 50)


def test_only_pairs_that_are_there_are_compared() -> None:
    alone = [each for each in made_up() if each.set_up.machine == NOTHING and each.set_up.ground == GROUNDED]
    assert topic.factors(alone) == []
    beside = [each for each in made_up() if each.set_up.machine == PERSON and each.set_up.ground == GROUNDED]
    (made,) = topic.factors(alone + beside[:3])
    assert (made.what, len(made.ratios)) == (PERSON, 3)
    assert not topic.of_model(alone, PERSON, GROUNDED).ratios


def test_the_model_is_held_against_each_company_and_connection() -> None:
    found = made_up()
    for machine, by_machine in BY_MACHINE.items():
        for ground, by_ground in BY_GROUND.items():
            each = topic.of_model(found, machine, ground)
            assert each.spread.median == pytest.approx(4 / (by_machine * by_ground))


def test_the_section_says_what_follows_from_the_factors() -> None:
    found = made_up()
    assert "hand floating instead of grounded 0.2 (0.2 to 0.2)" in topic.finding(found)
    assert "table 0.8 (0.8 to 0.8) of a grounded hand and 0.8" in topic.finding(found)
    times = [4 / (machine * ground) for machine in BY_MACHINE.values() for ground in BY_GROUND.values()]
    told = f"over all set-ups {np.median(times):.3g} times it (4 to 40)."
    assert topic.model_finding(found).endswith(told)
    told = topic.conclusion(found)
    assert "before a housing a floating hand makes 0.1 (0.1 to 0.1) of that change" in told
    assert "strongest effect in the median is that of hand floating (0.2)" in told
    text = str(topic.section(found, []))
    assert text.count("plotly-graph-div") == 1
    assert "<td>0.750</td>" not in text and "<td>1.500</td>" in text


def test_real_answers_have_the_order_of_the_theorem_and_state_their_errors(found: list[Entry]) -> None:
    answered = {(each.set_up.machine, each.set_up.ground): each for each in found}
    for machine in (NOTHING, HOUSING):
        grounded, floating = answered[machine, GROUNDED], answered[machine, FLOATING]
        assert 0 < floating.change.value < grounded.change.value
        assert floating.model is None and grounded.model is not None
        # The model does not see the housing, and gives the whole of what it would be near an endless plate.
        assert grounded.model > grounded.change.value
        assert 0 < grounded.change.error < 5e-3 * grounded.change.value
    assert answered[NOTHING, GROUNDED].model == answered[HOUSING, GROUNDED].model


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
    found = CHECK.comparisons(TOPIC.found(STAGES.load(tmp_path, recorded)))
    assert len(found) == 3 * len(records)
    assert [each for each in found if each.over_errors > 1] == []


def test_one_mesh_has_no_error_and_leaves_no_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    guarded = next(each for each in chosen() if each.machine == GUARD)
    asked = []

    def solve(_: Path, __: object, *options: str) -> store.Document:
        asked.append(options)
        return {"levels": [{}], "readings": [{}]}

    monkeypatch.setattr(reference_stage, "solve", solve)
    assert replace(CHECK, file=tmp_path / "field_checks.json").complete([guarded]) == (0, 1)
    assert f"set-up {guarded.id}: one mesh has no estimated error" in capsys.readouterr().err
    assert not (tmp_path / "field_checks.json").exists()
    assert asked[0][asked[0].index("--columns") + 1] == "sensor,guard"
