"""The candidates of a formula in company: potentials of rectangles, limits, reciprocity, order, and what they refuse."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from analysis.results.units import VACUUM_PERMITTIVITY
from analysis.topics.company.potential_formulas import CANDIDATES, Company, MachineAtRest, company
from analysis.topics.company.potential_table import candidates, errors, table
from analysis.topics.company.rectangles import energies, potentials, rectangle
from analysis.topics.company.set_ups import HAND, HOUSING, NOTHING, SENSOR, all_set_ups
from geometries.scene.poses import AxisRotation, Pose
from geometries.scene.scene import Link, Object, Reading, Scene
from geometries.scene.shapes import Cuboid, Sphere
from geometries.studies import families
from geometries.studies.families import GROUNDED

OTHER = Object("other", Cuboid((0.06, 0.05, 0.04)), pose=Pose((0.11, 0.0, 0.0)), potential="electrode")


def scene(distance: float, size: float = 0.04) -> Scene:
    pose = Pose((0.2 * distance, 0.1 * distance, distance), AxisRotation((1.0, 2.0, 0.5), 33.0))
    hand = Object(HAND, Cuboid((size, 1.5 * size, 0.5 * size)), pose=pose, target=True)
    return Scene(sensors=families.empty((0.1, 0.1)).sensors, objects=(hand, OTHER))


def given(distance: float, sense: str = SENSOR, drive: str = SENSOR) -> Company:
    made = scene(distance)
    return company(made, MachineAtRest(made, 6), HAND, Reading("reading", sense, (drive,)))


def test_the_potential_of_a_rectangle_is_that_of_its_charge() -> None:
    whole = rectangle(np.zeros(3), np.array([0.2, 0.0, 0.0]), np.array([0.0, 0.3, 0.0]), 1)
    assert potentials(np.array([[30.0, 40.0, 0.0]]), whole)[0, 0] == pytest.approx(1 / 50, rel=1e-4)
    # The mean over an a × a square of the distance's inverse to its centre is 4 ln(1 + √2)/a.
    square = rectangle(np.zeros(3), np.array([0.5, 0.0, 0.0]), np.array([0.0, 0.5, 0.0]), 1)
    assert potentials(np.zeros((1, 3)), square)[0, 0] == pytest.approx(4 * np.log(1 + np.sqrt(2)), rel=1e-13)


def test_the_capacitance_of_a_square_is_the_published_one() -> None:
    # 0.36679 of 4πε times the side: C.-O. Hwang, M. Mascagni and T. Won, J. Comput. Phys. 229 (2010).
    square = rectangle(np.zeros(3), np.array([0.5, 0.0, 0.0]), np.array([0.0, 0.5, 0.0]), 16)
    assert np.linalg.inv(energies(square)).sum() == pytest.approx(0.36679, rel=0.01)


def test_far_away_all_are_the_own_capacitance_times_the_potentials() -> None:
    for sense, drive in ((SENSOR, SENSOR), (SENSOR, "other")):
        differences = []
        for distance in (2.0, 4.0):
            here = given(distance, sense, drive)
            values = {name: candidate(here) for name, candidate in CANDIDATES.items()}
            differences.append([abs(value / values["far"] - 1) for value in values.values()])
        # The next order of the series falls like the square of the distance.
        assert max(differences[0]) < 1e-3
        assert max(differences[1]) < 0.3 * max(differences[0])


def test_sense_and_drive_may_be_exchanged() -> None:
    for candidate in CANDIDATES.values():
        there, back = candidate(given(0.08, SENSOR, "other")), candidate(given(0.08, "other", SENSOR))
        assert there == pytest.approx(back, rel=1e-10)


def test_more_freedom_of_the_target_takes_up_more_charge() -> None:
    values = [candidate(given(0.05)) for candidate in CANDIDATES.values()]
    assert values == sorted(values)


def test_close_by_the_answer_of_the_machine_makes_a_condenser() -> None:
    gap, side = 0.01, 0.1
    hand = Object(HAND, Cuboid((side, side, 0.02)), pose=Pose((0.0, 0.0, gap + 0.01)), target=True)
    made = Scene(sensors=families.empty((side, side)).sensors, objects=(hand,))
    reading = Reading(SENSOR, SENSOR, (SENSOR,))
    here = company(made, MachineAtRest(made), HAND, reading, per_side=10)
    condenser = VACUUM_PERMITTIVITY * side * side / gap
    own = 4 * pi * VACUUM_PERMITTIVITY * 0.36679 * side
    # Kirchhoff's fringe field adds a third at a tenth of the side.
    assert condenser - own < CANDIDATES["answered once"](here) < 1.4 * condenser
    assert CANDIDATES["isolated"](here) < 0.6 * condenser


def test_a_machine_that_moves_and_other_bodies_are_refused() -> None:
    made = scene(0.1)
    with pytest.raises(ValueError, match="only at rest"):
        MachineAtRest(replace(made, links=(Link("arm"),)))
    with pytest.raises(ValueError, match="neither a plate nor a box"):
        MachineAtRest(replace(made, objects=(replace(OTHER, shape=Sphere(0.02)),)))
    floating = replace(made.objects[0], potential="floating")
    with pytest.raises(ValueError, match="not grounded"):
        company(
            replace(made, objects=(floating, OTHER)),
            MachineAtRest(made),
            HAND,
            Reading("a", SENSOR, (SENSOR,)),
        )


def test_company_lowers_what_a_hand_changes() -> None:
    set_ups = {(each.number, each.machine): each for each in all_set_ups() if each.ground == GROUNDED}
    alone, housed = candidates(set_ups[5, NOTHING]), candidates(set_ups[5, HOUSING])
    assert all(housed[name] < alone[name] for name in CANDIDATES)


@pytest.mark.night
def test_the_table_of_the_notes_is_the_one_computed() -> None:
    grounded = [each for each in all_set_ups() if each.ground == GROUNDED]
    notes = Path("model/CORRECTIONS.md").read_text(encoding="utf-8")
    assert table(errors(model_module(), grounded)) in notes
