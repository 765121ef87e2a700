"""The set-ups of Experiment VII: a sensor and a hand, alone and in company, the hand connected to the ground in five ways. Metres, farads.

Their readings are computed by boundary elements, with the model's change; finished set-ups are not computed again. The field solver's
readings of some are stored: `python3 -m analysis measure field-check company`, forty minutes of one core."""

import math
import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from time import perf_counter

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import OfScene, SetUpStages
from analysis.pipeline.stage import NoAnswer
from analysis.report import page
from analysis.results.store import Document
from analysis.results.study_results import COMPARED_METHOD
from analysis.topics import stored
from analysis.topics.draw import DIGITS, length
from geometries.scene.poses import Pose
from geometries.scene.scene import Object, Scene, Sensor
from geometries.scene.shapes import Cuboid
from geometries.studies import machines
from geometries.studies.families import FLOATING, GROUNDED, empty

MACHINES = ("nothing", "housing", "housing and driven guard", "table", "second person")
"""What stands around the sensor and stays when the hand goes. All of it is grounded but the guard."""
NOTHING, HOUSING, GUARD, TABLE, PERSON = MACHINES
TO_GROUND = {GROUNDED: math.inf, "1 nF": 1e-9, "100 pF": 1e-10, "10 pF": 1e-11, FLOATING: 0.0}
"""Capacitance (F) between the hand, a person's, and the ground, by its name."""
SENSOR, HAND = "sensor", "hand"
ARRANGEMENTS = 10

_SEED = 7
_SIDES, _GAPS, _BEHIND, _BESIDE = (0.04, 0.2), (0.015, 0.2), (0.02, 0.2), (0.05, 0.4)
# Range of the hand's size, and its largest shift to the side relative to the sensor's.
_HANDS, _SHIFT = ((0.06, 0.12), (0.12, 0.22), (0.02, 0.06)), 0.75
_TABLE, _PERSON = (1.0, 0.8, 0.03), (0.25, 0.4, 1.2)


@dataclass(frozen=True)
class SetUp(OfScene):
    """An arrangement, named by its number, in the company of a machine; `ground` names the hand's connection."""

    number: int
    machine: str
    ground: str


@cache
def all_set_ups() -> tuple[SetUp, ...]:
    """Returns every arrangement in the company of every machine, with every connection of the hand to the ground. A set-up has one reading: the
    sensor's, driven together with the guard if there is one."""
    return tuple(
        SetUp(machines.before(Scene(sensors=sensors, objects=(target,)), around), number, machine, ground)
        for number, (sensors, hand, company) in enumerate(_arrangements(), start=1)
        for machine, around in company.items()
        for ground in TO_GROUND
        for target in [_connected(hand, ground)]
    )


def _connected(hand: Object, ground: str) -> Object:
    """Returns the grounded hand with a connection."""
    return hand if ground == GROUNDED else replace(hand, potential=FLOATING, to_ground=TO_GROUND[ground])


def _arrangements() -> Iterator[tuple[tuple[Sensor, ...], Object, dict[str, tuple[Object, ...]]]]:
    """Draws a square sensor, centred at the origin in the plane z = 0, a hand before it and to the side, and the bodies of every machine: a table stands
    behind the hand, a person beside sensor and hand. Python promises that the generator's numbers stay the same.
    """
    chance = random.Random(_SEED)
    for _ in range(ARRANGEMENTS):
        side = length(chance, _SIDES)
        width, depth, height = (length(chance, ends) for ends in _HANDS)
        x, y = (round(_SHIFT * side * chance.uniform(-1, 1), DIGITS) for _ in range(2))
        gap, behind, beside = (length(chance, ends) for ends in (_GAPS, _BEHIND, _BESIDE))
        z = gap + height / 2
        sensors = empty((side, side)).sensors
        housing = machines.housing(sensors)
        aside = max(side / 2, x + width / 2) + beside + _PERSON[0] / 2
        yield sensors, Object(HAND, Cuboid((width, depth, height)), pose=Pose((x, y, z))), {
            NOTHING: (),
            HOUSING: (housing,),
            GUARD: (housing, machines.guard(sensors)),
            TABLE: (machines.table(_TABLE, x, y, gap + height + behind),),
            PERSON: (Object("person", Cuboid(_PERSON), pose=Pose((aside, 0.0, z))),),
        }


RTOL = 1e-3
"""Relative accuracy asked of the reading's value, background and change."""
# Expected seconds with a guard, whose edge is close to the sensor's and the housing, and without.
_SECONDS_GUARDED, _SECONDS = 2.0, 0.2


def answer(set_up: SetUp, scene: Path) -> Document:
    """Computes value, background and change (F) with their errors; and `model`, the model's change, which knows only grounded hands."""
    loaded = model_stage.model_module().Scene.load(str(scene))
    before = perf_counter()
    quantities = stored.by_boundary_elements(loaded, SENSOR, RTOL)
    seconds = perf_counter() - before
    by_model = loaded.readings(COMPARED_METHOD)[SENSOR].change if set_up.ground == GROUNDED else None
    return {"seconds": seconds, **quantities, "model": by_model}


STAGES = SetUpStages[SetUp](
    name="company",
    what="set-ups in company",
    rtol=RTOL,
    sources=("analysis/topics/company/set_ups.py",),
    seconds=lambda set_up: _SECONDS_GUARDED if set_up.machine == GUARD else _SECONDS,
    answer=answer,
)

MOST_UNKNOWNS = (550_000, 1_200_000)
"""Limits of a mesh's unknowns, tried in turn until two meshes have fewer; a third mesh mostly has more and would take minutes and gigabytes."""
# Steps in the arrangements' numbers from machine to machine and from connection to connection: with these all arrangements occur.
_BY_MACHINE, _BY_GROUND = 3, 2
_DESCRIPTION = (
    "Readings (F) of set-ups of Experiment VII by the field solver, by the hash of the scene, with estimated errors; seconds are elapsed. "
    "Made by python3 -m analysis measure field-check company."
)


def chosen() -> tuple[SetUp, ...]:
    """Returns one set-up for each machine and each connection of the hand, of all arrangements; those of large machines, the slowest, last."""
    numbers = {
        (machine, ground): 1 + (_BY_MACHINE * row + _BY_GROUND * column) % ARRANGEMENTS
        for row, machine in enumerate(MACHINES)
        for column, ground in enumerate(TO_GROUND)
    }
    found = [each for each in all_set_ups() if each.number == numbers[each.machine, each.ground]]
    return tuple(sorted(found, key=lambda each: (each.machine == GUARD, _is_large(each))))


def solved(set_up: SetUp) -> Document:
    """Solves a set-up for what its reading drives; NoAnswer if the field solver has none."""
    (asked_for,) = set_up.scene.readings
    asked = ("--error", "estimate", "--columns", ",".join(asked_for.drive))
    for most in MOST_UNKNOWNS[1:] if _is_large(set_up) else MOST_UNKNOWNS:
        reading, document = stored.solved(set_up, *asked, "--max-unknowns", str(most))
        if len(document["levels"]) > 1:
            return {**stored.quantities_of(reading), "seconds": document["seconds"]}
    raise NoAnswer("one mesh has no estimated error")


def _is_large(set_up: SetUp) -> bool:
    return set_up.machine in (GUARD, PERSON)


CHECK = stored.FieldCheck[SetUp](
    file=Path(__file__).with_name("field_checks.json"),
    description=_DESCRIPTION,
    chosen=chosen,
    solve=solved,
    kind=lambda each: each.machine,
    described=(
        ("set-up", lambda each: page.code(each.id)),
        ("in company of", lambda each: each.machine),
        ("hand", lambda each: each.ground),
    ),
    explanation=(
        "Its errors are estimates from two meshes, at least twice what the second one changes, or from three, extrapolated. "
        "python3 -m analysis measure field-check company makes them in forty minutes of one core."
    ),
)
