"""The cases of the golden file: set-ups with stored truths, taken by fixed strides, each by the methods that its kind allows."""

from __future__ import annotations

import hashlib
import itertools
import json
import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.honesty import closed_scenes
from analysis.honesty.methods import (
    BOUNDARY_ELEMENTS,
    CHANGE,
    METHODS,
    PARTS,
    entry,
    has_readings,
    in_pose,
    pair,
    part_of,
)
from analysis.pipeline.model_stage import model_module
from analysis.results.answers import Estimate
from analysis.results.store import read_json
from analysis.topics.company import set_ups as company
from analysis.topics.corrections import set_ups as corrections
from analysis.topics.insulators import set_ups as insulators, truths as insulators_truths
from analysis.topics.machines import set_ups as machines, truths as machines_truths
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical_and_identity
from geometries.studies.machines import before as with_readings

Truths = dict[str, Estimate]

CORRECTIONS_STRIDE, MACHINES_STRIDE, INSULATORS_STRIDE = 25, 33, 35
"""Every so-many-th of the 450, 396 and 210 set-ups is taken."""
CLOSED_FORMS = 2
"""Random scenes of each closed form but the bowls, whose meshes are files of no fixed content."""
CLOSED, ACCURATE, REDUCED = "formula", "reduced:1e-2", "reduced+entries:1e-2"
ELEMENTS = "boundary-elements:1e-2"
PAIRS, FINE_ELEMENTS = "formula of pairs", "boundary-elements:1e-3"
_MOVING = Path(__file__).with_name("moving.json")
_OPTIONS = METHODS | {PAIRS: METHODS[CLOSED], FINE_ELEMENTS: {"method": BOUNDARY_ELEMENTS, "rtol": 1e-3}}


@dataclass(frozen=True, eq=False)
class Case:
    """A scene that a method is asked for, and what is known of it (F); without readings it is asked for its Maxwell matrix or pairs. `question`
    is a hash of all that is asked."""

    name: str
    method: str
    text: str
    has_readings: bool
    options: dict[str, Any]
    truths: Truths
    question: str


def all_cases() -> list[Case]:
    """Returns all cases."""
    topics = _corrections, _company, _machines, _insulators, _closed_forms, _moving
    return [case for topic in topics for case in topic()]


def _cases(
    name: str, scene: Scene, methods: Iterable[str], truths: Truths, has_readings: bool = True, **more: Any
) -> Iterator[Case]:
    yield from _asked(name, *canonical_and_identity(scene), methods, truths, has_readings, **more)


def _asked(
    name: str,
    text: str,
    identity: str,
    methods: Iterable[str],
    truths: Truths,
    has_readings: bool = True,
    **more: Any,
) -> Iterator[Case]:
    for method in methods:
        options = _OPTIONS[method] | more
        asked = json.dumps([identity, has_readings, options], default=np.ndarray.tolist)
        question = hashlib.sha256(asked.encode()).hexdigest()
        yield Case(f"{name}/{method}", method, text, has_readings, options, truths, question)


def _corrections() -> Iterator[Case]:
    """A sensor and a target alone: the matrix, the formula's pair, and the change of the sensor's own capacitance, which is a difference."""
    known = corrections.load()
    for set_up in list(corrections.set_ups(model_module()))[::CORRECTIONS_STRIDE]:
        true, name = known[set_up.name], f"corrections/{set_up.name}"
        change = Estimate(true.sensor - true.sensor_alone, corrections.RTOL * true.sensor)
        truths = {
            entry("sensor", "target"): Estimate(-true.mutual, true.error),
            pair("sensor", "target"): Estimate(true.mutual, true.error),
        }
        yield from _cases(name, set_up.scene, (PAIRS, REDUCED, FINE_ELEMENTS), truths, has_readings=False)
        marked = with_readings(set_up.scene, ())
        yield from _cases(name, marked, (CLOSED, ACCURATE), {part_of("sensor", CHANGE): change})


def _company() -> Iterator[Case]:
    """The set-ups whose readings are stored by the field solver."""
    checks = company.CHECK.records()
    for set_up in (each for each in company.all_set_ups() if each.identity in checks):
        true, name = checks[set_up.identity], f"company/{set_up.machine} {set_up.number}, {set_up.ground}"
        truths = {part_of(company.SENSOR, part): Estimate(**true[part]) for part in PARTS}
        yield from _cases(name, set_up.scene, (CLOSED, ACCURATE, REDUCED, FINE_ELEMENTS), truths)


def _machines() -> Iterator[Case]:
    known = machines_truths.load()
    for set_up in machines.all_set_ups()[::MACHINES_STRIDE]:
        truths = {part_of(machines.READING, CHANGE): known[set_up.identity].changes.full}
        name = f"machines/{set_up.name}"
        yield from _cases(name, set_up.scene, (CLOSED, ACCURATE, REDUCED, ELEMENTS), truths)


def _insulators() -> Iterator[Case]:
    known = insulators_truths.load()
    for set_up in insulators.all_set_ups()[::INSULATORS_STRIDE]:
        true = known[set_up.identity].insulated
        truths = {part_of(insulators.READING, part): getattr(true, part) for part in ("background", CHANGE)}
        name = f"insulators/{set_up.name}"
        yield from _cases(name, set_up.scene, (CLOSED, REDUCED, ELEMENTS), truths)


def _closed_forms() -> Iterator[Case]:
    """Random scenes of fixed seeds whose answers are known in closed form."""
    forms = [form for form in dict.fromkeys(closed_scenes.FORMS) if form is not closed_scenes.bowls]
    for form, seed in itertools.product(forms, range(CLOSED_FORMS)):
        known = form(random.Random(seed), Path())
        is_read = has_readings(known.scene)
        methods = (CLOSED, ACCURATE, REDUCED, ELEMENTS) if is_read else (REDUCED, ELEMENTS)
        name = f"closed forms/{form.__name__} {seed}"
        yield from _cases(name, known.scene, methods, known.truths, is_read)


def _moving() -> Iterator[Case]:
    """Machines in poses of their motions with stored truths, all poses at once."""
    document = read_json(_MOVING)
    assert document is not None
    for name, machine in document["machines"].items():
        text, poses = machine["scene"], machine["poses"]
        truths = {
            part_of(in_pose(reading, number), CHANGE): Estimate(*known)
            for number, pose in enumerate(poses)
            for reading, known in pose["changes"].items()
        }
        motion = np.array([pose["links"] for pose in poses])
        identity = hashlib.sha256(text.encode()).hexdigest()
        yield from _asked(f"moving/{name}", text, identity, (CLOSED, ACCURATE), truths, motion=motion)
