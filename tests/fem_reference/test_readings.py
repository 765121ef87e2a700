"""What may be asked of a scene: its readings, with and without the targets on one mesh, and columns, whose result is the submatrix of the
whole matrix with its bounds."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from fem_reference import maxwell
from fem_reference.answer.reference import Reference
from fem_reference.bodies.conductors import conductors
from fem_reference.mesh.sizing import Sizing
from fem_reference.output.documents import table
from fem_reference.output.readings import reading_document, readings_table
from fem_reference.solve.level import solve_level
from fem_reference.solve.readings import LevelReadings
from geometries.common.errors import InputError
from geometries.scene.reader import loads
from tests import scenes
from tests.scenes import GUARDED_SENSOR

READINGS = scenes.table("reading", name="guarded", sense="front", drive=["front", "guard"]) + scenes.table(
    "reading", name="transmitted", sense="front", drive=["guard"]
)
TARGET = scenes.body("hand", "plate", size=[0.08, 0.08], translation=[0, 0, 0.05], target=True)
SLAB = TARGET.replace("plate", "cuboid").replace("0.08]", "0.08, 0.02]")


@cache
def solved(text: str) -> Reference:
    """The answer of the coarsest mesh."""
    return maxwell(loads(text), max_seconds=1e-3)


def on_one_mesh(text: str) -> LevelReadings:
    """The readings on the coarsest mesh, without bounds."""
    problem = conductors(loads(text))
    found = solve_level(problem, 1.0, Sizing(), "none", problem.mirror_planes).readings
    assert found is not None
    return found


def test_the_background_is_the_scene_without_the_targets() -> None:
    """The two are solved on different meshes; the intervals of both hold the truth."""
    found, alone = (
        solved(GUARDED_SENSOR + READINGS + TARGET).readings,
        solved(GUARDED_SENSOR + READINGS).readings,
    )
    assert [reading.name for reading in found] == ["guarded", "transmitted"]
    for reading, expected in zip(found, alone):
        for quantity in (reading.value, reading.background, reading.change):
            assert quantity.lower is not None and quantity.upper is not None
            assert quantity.lower <= quantity.value <= quantity.upper and quantity.error > 0
        assert reading.background.lower <= expected.value.upper  # type: ignore[operator]
        assert expected.value.lower <= reading.background.upper  # type: ignore[operator]
        assert reading.background.value == pytest.approx(expected.value.value, rel=2e-3)
        assert expected.change.value == 0 and expected.change.error == 0


def test_a_reading_is_the_sum_of_its_entries() -> None:
    answer = solved(GUARDED_SENSOR + READINGS + TARGET)
    front, guard = answer.names.index("front"), answer.names.index("guard")
    guarded, transmitted = answer.readings
    matrix = answer.maxwell.value
    assert guarded.value.value == pytest.approx(matrix[front, front] + matrix[front, guard], rel=1e-3)
    assert transmitted.value.value == pytest.approx(-matrix[front, guard], rel=1e-3)


def test_what_is_connected_to_ground_through_more_is_felt_more() -> None:
    """A self reading grows from absent over floating to grounded (Dirichlet's principle)."""
    words = ("floating", 'floating"\nto_ground = 1e-13 #', 'floating"\nto_ground = 1e-6 #', "grounded")
    scenes = [GUARDED_SENSOR + TARGET + f'potential = "{word}"\n' for word in words]
    changes = [float(on_one_mesh(text).change[0]) for text in scenes]
    assert 0 < changes[0] < 0.9 * changes[1] < 0.8 * changes[2]
    assert changes[2] == pytest.approx(changes[3], rel=1e-5)


def test_without_marks_every_object_comes_and_goes_and_every_sensor_is_read() -> None:
    text = GUARDED_SENSOR.split("[[object]]")[0] + TARGET.replace("target = true\n", "")
    answer = solved(text)
    (reading,) = answer.readings
    assert reading.name == "front"
    assert reading.change.value == pytest.approx(answer.delta_self.value[0], rel=1e-12)
    assert reading.value.value == answer.maxwell.value[0, 0]
    assert reading.change.lower is None and "lower" in reading_document(answer.readings[0])


def test_a_dielectric_target_is_the_medium_in_the_background() -> None:
    found = on_one_mesh(GUARDED_SENSOR + READINGS + SLAB + "material = { relative_permittivity = 50 }\n")
    alone = [reading.value.value for reading in solved(GUARDED_SENSOR + READINGS).readings]
    np.testing.assert_allclose(found.background, alone, rtol=3e-3)
    assert found.change[0] > 0


def test_only_readings_whose_conductors_were_asked_for_are_answered() -> None:
    readings = conductors(loads(GUARDED_SENSOR + READINGS + TARGET), columns=["guard"]).readings
    assert readings == () and conductors(loads(GUARDED_SENSOR), columns=["front"]).readings[0].sense == 0


def test_whether_the_readings_are_accurate_enough_is_a_boolean_that_json_knows() -> None:
    """JSON does not know the Booleans that comparing numbers of NumPy gives."""
    found = replace(solved(GUARDED_SENSOR + READINGS + TARGET), only_readings=True)
    tight = replace(found, rtol=found.worst / 2)
    assert type(found.worst) is float and type(tight.reached) is bool and not tight.reached


def test_people_get_a_table_with_proven_bounds() -> None:
    lines = readings_table(solved(GUARDED_SENSOR + READINGS + TARGET).readings)
    assert lines[2].startswith("guarded") and "±" in lines[2] and lines[3].startswith("  proven")


def test_a_part_of_a_conductor_cannot_come_and_go() -> None:
    arm = scenes.body("arm", "cuboid", size=[0.02, 0.02, 0.1], translation=[0, 0, 0.1])
    with pytest.raises(InputError, match='object "hand": target: is one conductor with "arm", which stays'):
        conductors(loads(GUARDED_SENSOR + arm + SLAB))
    assert conductors(loads(GUARDED_SENSOR + arm + SLAB.replace("target = true", ""))).targets == {"arm"}


TWO_SENSORS = (
    scenes.sensor("left", [[-0.11, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.sensor("right", [[0.01, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.body("grounded", "plate", size=[0.08, 0.08], translation=[0.02, 0, 0.05])
    + scenes.body("floating", "plate", size=[0.05, 0.1], translation=[-0.06, 0, 0.06], potential="floating")
)


@cache
def of_columns(*columns: str) -> Reference:
    return maxwell(loads(TWO_SENSORS), max_seconds=1e-3, columns=columns)


@pytest.mark.night
def test_what_was_asked_for_is_a_part_of_the_whole() -> None:
    """The mesh is coarser around what was not asked for; the intervals of both meshes hold the truth."""
    whole, part = of_columns(), of_columns("grounded", "right")
    assert (
        part.names == ("right", "grounded")
        and part.problem.grounded == ("left",)
        and whole.problem.grounded == ()
    )
    kept = np.ix_(*[[whole.names.index(name) for name in part.names]] * 2)
    assert np.all(part.lower <= whole.upper[kept]) and np.all(whole.lower[kept] <= part.upper)


def test_a_sensor_nobody_asked_for_takes_fewer_cells() -> None:
    whole, part = of_columns(), of_columns("right")
    assert part.levels[0].unknowns < whole.levels[0].unknowns
    assert part.maxwell.error[0, 0] < 1.2 * whole.maxwell.error[1, 1]


def test_the_change_of_a_sensor_is_the_same_beside_a_sensor_nobody_asked_for() -> None:
    whole, part = of_columns(), of_columns("grounded", "right")
    assert part.delta_self.value.shape == (1,)
    allowed = part.delta_self.error[0] + whole.delta_self.error[1]
    assert abs(part.delta_self.value[0] - whole.delta_self.value[1]) <= allowed
    assert allowed < 0.1 * whole.delta_self.value[1]


def test_the_table_names_what_has_no_row_and_why() -> None:
    lines = table(of_columns("grounded", "right")).splitlines()
    assert "grounded, their columns not asked for: left" in lines
    assert "floating, without charge and so without a row: floating" in lines


def test_an_object_alone_has_no_change_of_a_sensor() -> None:
    found = maxwell(loads(TWO_SENSORS), max_seconds=1e-3, columns=["grounded"], error="estimate")
    assert found.names == ("grounded",) and found.delta_self.value.shape == (0,) and 0 < found.worst < 0.1
