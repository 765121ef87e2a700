"""Set-ups on machines: which there are, the parts of the model's error, and true changes that boundary elements and the field solver agree on."""

import math

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from analysis.results.answers import Estimate
from analysis.topics.errors.parts import EFFECTS, Truth
from analysis.topics.machines import parts, topic, truths
from analysis.topics.machines.parts import GROUNDING, MERGED, OTHERS, OWN, SENSORS, OnMachine, Pairs
from analysis.topics.machines.set_ups import (
    ARM,
    FAMILIES,
    HOUSING,
    PERSON,
    READING,
    ROBOT,
    TABLE,
    TRANSMIT,
    SetUp,
    all_set_ups,
)
from analysis.topics.machines.topic import MACHINES as TOPIC, Entry
from analysis.topics.machines.truths import CHECK, EVERY, METHODS, REDUCED, RTOL, chosen
from analysis.topics.stored import Comparison
from geometries.scene.shapes import PlateShape
from geometries.studies.families import GROUNDED

PICO = 1e-12


def some() -> tuple[SetUp, ...]:
    """Quick ones: a solid body and a plate before a housing, a plate between a housing and a table, and one before two sensors."""
    wanted = ((HOUSING, 2), (HOUSING, 4), (TABLE, 1), (TRANSMIT, 4))
    return tuple(each for each in all_set_ups() if (each.family, each.number) in wanted)


def first(family: str, number: int = 1) -> SetUp:
    return next(each for each in all_set_ups() if (each.family, each.number) == (family, number))


def test_each_family_has_as_many_set_ups_and_a_third_of_them_are_sealed() -> None:
    everything = all_set_ups()
    count = len({each.id for each in everything})
    assert count == len(everything) >= 300
    for family in FAMILIES:
        own = [each for each in everything if each.family == family]
        assert len(own) * len(FAMILIES) == count
        assert sum(each.sealed for each in own) * 3 == len(own)


def test_every_shape_and_connection_occurs() -> None:
    machines = [each for each in all_set_ups() if each.family == ROBOT]
    shapes = {
        type(body.shape).__name__ for each in machines for body in each.scene.objects if not body.target
    }
    assert {"Cuboid", "Cylinder", "Capsule", "MeshShape"} <= shapes
    assert {len(each.scene.sensors) for each in machines} == {1, 2, 3}
    to_ground = {body.to_ground for each in machines for body in each.targets if body.potential != GROUNDED}
    assert to_ground == {0.0, 1e-11, 1e-10, 1e-9}


def test_targets_are_above_the_sensors_and_what_these_are_mounted_on_is_below() -> None:
    for each in all_set_ups():
        heights = {name: triangles[..., 2] for name, triangles in each.scene.conductors().items()}
        gap = min(heights[body.name].min() for body in each.targets)
        assert 0.0149 <= gap <= 0.1501
        assert all(heights[name].max() <= -0.0029 for name in each.own)
        (reading,) = each.scene.readings
        driven = "sensor 2" if each.family == TRANSMIT else "sensor 1"
        assert (reading.name, reading.sense, reading.drive) == (READING, "sensor 1", (driven,))
        assert each.is_between_sensors == (each.family == TRANSMIT)
        names = {*each.own, *each.others, *(body.name for body in each.targets)}
        assert names == {body.name for body in each.scene.objects}


def test_only_what_is_neglected_is_left_out() -> None:
    robot = next(each for each in all_set_ups() if parts.included(each) == (OWN, OTHERS, SENSORS, GROUNDING))
    assert len(list(parts.choices(robot))) == 16
    (alone,) = parts.scenes(robot, ())
    assert [body.name for body in alone.objects] == [body.name for body in robot.targets]
    assert [sensor.name for sensor in alone.sensors] == ["sensor 1"]
    assert all(body.potential == GROUNDED and body.to_ground == 0 for body in alone.objects)
    (whole,) = parts.scenes(robot, parts.included(robot))
    assert {body.name: body for body in whole.objects} == {body.name: body for body in robot.scene.objects}
    assert whole.sensors == robot.scene.sensors
    (other,) = parts.scenes(robot, (OTHERS,))
    assert {body.name for body in other.objects} == {*robot.others, *(b.name for b in robot.targets)}


def test_the_bodies_of_a_target_are_counted_one_by_one_unless_they_are_merged() -> None:
    person = first(PERSON)
    assert len(person.targets) == 5 and len({body.conductor for body in person.targets}) == 1
    apart = parts.scenes(person, (OWN,))
    assert [sum(body.target for body in scene.objects) for scene in apart] == [1] * 5
    (together,) = parts.scenes(person, (OWN, MERGED))
    assert sum(body.target for body in together.objects) == 5


def test_made_up_changes_have_the_parts_that_were_put_in() -> None:
    """The machine behind takes 4 pF, other bodies 1 pF, both together 4.6 pF: the rest is shared equally."""
    changes = {(): 10.0, (OWN,): 6.0, (OTHERS,): 9.0, (OWN, OTHERS): 5.4}
    true = OnMachine({chosen: Estimate(value * PICO, 0.01 * PICO) for chosen, value in changes.items()})
    company = true.company()
    assert company[OWN].value == pytest.approx(3.8 * PICO) and company[OTHERS].value == pytest.approx(
        0.8 * PICO
    )
    assert (company[OWN].least, company[OWN].greatest) == pytest.approx((3.6 * PICO, 4 * PICO))
    assert company[GROUNDING].value == company[MERGED].value == 0
    truth = Truth(Estimate(12 * PICO, 0.0), Estimate(10 * PICO, 0.0), Estimate(20 * PICO, 0.0))
    pairs = Pairs((truth,), every=30 * PICO, facing=14 * PICO, split=None)
    entry = Entry(first(HOUSING), true, pairs, {EVERY: 30 * PICO})
    named = {name: value for name, value in entry.parts().items() if value}
    assert named == pytest.approx(
        {
            OWN: 3.8 / 5.4,
            OTHERS: 0.8 / 5.4,
            parts.TURNED_AWAY: 16 / 5.4,
            "another quantity": 2 / 5.4,
            "rest": 2 / 5.4,
        }
    )
    assert math.fsum(named.values()) == pytest.approx(entry.error) == pytest.approx(30 / 5.4 - 1)
    assert entry.largest == parts.TURNED_AWAY
    told = topic.parts_finding([entry])
    assert "Company alone makes 1.85 times too much of a change" in told and OWN in told


def test_parts_of_real_set_ups_add_up_to_the_error(found: list[Entry]) -> None:
    assert [entry.set_up for entry in found] == list(some())
    for entry in found:
        assert math.fsum(entry.parts().values()) == pytest.approx(entry.error, rel=1e-9)
        assert 0 < entry.change.error <= RTOL * abs(entry.change.value)
        if entry.set_up.is_between_sensors:
            continue
        assert entry.ratio(EVERY) == pytest.approx(entry.error + 1, rel=1e-9)
        of_a_plate = isinstance(entry.set_up.targets[0].shape, PlateShape)
        assert all((entry.parts()[effect] != 0) == of_a_plate for effect in EFFECTS)


def test_the_plain_model_gives_nothing_of_a_reading_between_sensors_and_the_formula_its_change(
    found: list[Entry],
) -> None:
    (entry,) = (entry for entry in found if entry.set_up.is_between_sensors)
    assert entry.pairs is None and list(entry.methods) == [REDUCED]
    assert entry.error == -1 and entry.change.value < 0
    assert entry.ratio(REDUCED) == pytest.approx(1, abs=0.15)
    assert entry.parts()[parts.NOT_KNOWN] == pytest.approx(-entry.true.alone.value / entry.change.value)
    sensors = [
        len(scene.sensors) for chosen in ((), (SENSORS,)) for scene in parts.scenes(entry.set_up, chosen)
    ]
    assert sensors == [2, len(entry.set_up.scene.sensors)]


def test_grounded_company_takes_from_the_change(found: list[Entry]) -> None:
    """More grounded conductors lower the potential of the sensor's field everywhere, and with it what a small target takes of it."""
    for entry in found:
        changes = entry.true.changes
        assert abs(changes[(OWN,)].value) < abs(changes[()].value)
        assert entry.parts()[OWN] > 0
        if entry.pairs:
            assert entry.error > entry.pairs.every / entry.pairs.delta_self.value - 1


def test_the_section_tells_ratios_and_parts(found: list[Entry]) -> None:
    text = str(topic.section(found, []))
    assert text.count("plotly-graph-div") == 2
    told = topic.finding(found)
    times = [entry.ratio(EVERY) for entry in found if EVERY in entry.methods]
    assert f"exact {np.median(times):.3g} times" in told and f"Over {len(found)} set-ups" in told
    assert topic.statistics(found, "no such method") is None
    assert all(f">{method}<" in text for method in METHODS)


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
