"""Machines: what they consist of, that they touch nothing, and what is read before them."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from geometries.scene import reader
from geometries.scene.readings import targets
from geometries.scene.scene import Reading, Scene
from geometries.scene.writer import canonical
from geometries.studies import families, machines
from geometries.studies.machines import ARM, GUARD, HOUSING, MACHINES, NONE, TABLE
from tests.geometries.studies.test_families import MADE, SENSOR

LINKS = ["link 1", "link 2", "link 3"]
BODIES = {NONE: [], HOUSING: ["housing"], GUARD: ["housing", "guard"], ARM: LINKS, TABLE: ["table"]}


def boxes(scene: Scene) -> dict[str, np.ndarray]:
    """The bounding box (2, 3) of every sensor and object."""
    return {
        name: np.array([own.reshape(-1, 3).min(axis=0), own.reshape(-1, 3).max(axis=0)])
        for name, own in scene.conductors().items()
    }


def test_every_machine_has_its_bodies() -> None:
    assert set(BODIES) == set(MACHINES)
    for machine, names in BODIES.items():
        scene = families.parallel(SENSOR, SENSOR, 0.05, machine=machine)
        assert [body.name for body in scene.objects] == ["target", *names]
        potentials = {body.name: body.potential for body in scene.objects}
        assert all(
            potentials[name] == ("electrode" if name == "guard" else "grounded") for name in potentials
        )


@pytest.mark.parametrize("family", MADE)
@pytest.mark.parametrize("machine", MACHINES[1:])
def test_the_target_alone_comes_and_goes_and_every_sensor_is_read_with_the_guard(
    family: str, machine: str
) -> None:
    scene = MADE[family](machine=machine)
    names = [body.name for body in scene.objects]
    assert [name for name, target in zip(names, targets(scene)) if target] == ["target"]
    guard = ["guard"] if machine == GUARD else []
    assert scene.readings == tuple(
        Reading(sensor.name, sensor.name, (sensor.name, *guard)) for sensor in scene.sensors
    )
    assert reader.loads(canonical(scene)) == scene


@pytest.mark.parametrize("family", MADE)
@pytest.mark.parametrize("machine", MACHINES)
def test_nothing_touches_a_machine_wherever_the_family_puts_its_target(family: str, machine: str) -> None:
    for (first, one), (second, other) in combinations(boxes(MADE[family](machine=machine)).items(), 2):
        assert {first, second} <= set(LINKS) or np.max(np.maximum(one[0] - other[1], other[0] - one[1])) > 0


def test_an_arm_has_links_that_overlap_one_after_another_and_a_sensor_on_either_side() -> None:
    scene = families.parallel(SENSOR, SENSOR, 0.05, machine=ARM)
    found = boxes(scene)
    for first, second in zip(LINKS, LINKS[1:]):
        assert np.all(
            np.minimum(found[first][1], found[second][1]) > np.maximum(found[first][0], found[second][0])
        )
    assert [sensor.name for sensor in scene.sensors] == ["sensor", "left", "right"]
    shift = [0, SENSOR[1] + 0.1 * np.sqrt(SENSOR[0] * SENSOR[1]), 0]
    np.testing.assert_allclose(found["right"], found["sensor"] + shift)
    np.testing.assert_allclose(found["left"], found["sensor"] - shift)


def test_sizes_follow_the_rectangle_of_the_sensor() -> None:
    x, y = 0.04, 0.09
    size = 0.06
    found = boxes(families.parallel((x, y), (x, y), 0.05, machine=GUARD))
    np.testing.assert_allclose(found["housing"], [[-x, -y, -1.2 * size], [x, y, -0.2 * size]])
    np.testing.assert_allclose(
        found["guard"], [[-0.7 * x, -0.7 * y, -0.1 * size], [0.7 * x, 0.7 * y, -0.1 * size]]
    )
    table = boxes(families.box((x, y), (x, y), 0.03, 0.05, machine=TABLE))["table"]
    np.testing.assert_allclose(
        table, [[-2.5 * size, -2 * size, 0.08 + size], [2.5 * size, 2 * size, 0.08 + 2 * size]]
    )


def test_the_rectangle_is_that_around_all_sensors() -> None:
    found = boxes(families.sensors((0.1, 0.1), (0.05, 0.05), 0.02, 0.03, machine=HOUSING))
    both = np.array([found["sensor"], found["neighbour"]])
    low, high = both[:, 0].min(axis=0), both[:, 1].max(axis=0)
    middle, reach = (low + high)[:2] / 2, (high - low)[:2]
    np.testing.assert_allclose(found["housing"][:, :2], [middle - reach, middle + reach])


def test_without_a_machine_a_scene_is_itself() -> None:
    scene = families.parallel(SENSOR, SENSOR, 0.05)
    assert machines.around(scene, NONE) is scene
