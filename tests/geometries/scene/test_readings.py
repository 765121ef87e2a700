"""Readings and targets of a scene, also those that it leaves out."""

from __future__ import annotations

from geometries.scene.readings import readings, targets
from geometries.scene.scene import Object, Plate, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid

CUBE = Cuboid((1.0, 1.0, 1.0))
PLATE = Plate((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
SENSORS = (Sensor("front", (PLATE,)), Sensor("back", (PLATE,)))
HAND = Object("hand", CUBE, potential="floating")
GUARD = Object("guard", CUBE, potential="electrode")
GLASS = Object("glass", CUBE, relative_permittivity=5.0)


def test_a_scene_without_readings_has_one_for_every_sensor() -> None:
    scene = Scene(sensors=SENSORS, objects=(GUARD,))
    assert readings(scene) == (Reading("front", "front", ("front",)), Reading("back", "back", ("back",)))


def test_a_scene_with_readings_has_those_alone() -> None:
    guarded = Reading("guarded", "front", ("front", "guard"))
    assert readings(Scene(sensors=SENSORS, objects=(GUARD,), readings=(guarded,))) == (guarded,)


def test_the_threshold_is_five_times_the_noise_unless_it_is_given() -> None:
    scene = Scene(
        sensors=SENSORS,
        readings=(Reading("a", "front", ("front",), 2e-15), Reading("b", "front", ("front",), 2e-15, 3e-15)),
    )
    assert [reading.threshold for reading in readings(scene)] == [5 * 2e-15, 3e-15]


def test_without_a_mark_every_object_is_a_target_but_electrodes() -> None:
    assert targets(Scene(objects=(HAND, GUARD, GLASS))) == (True, False, True)


def test_with_a_mark_only_the_marked_objects_are_targets() -> None:
    marked = Object("hand", CUBE, potential="floating", target=True)
    assert targets(Scene(objects=(marked, GUARD, GLASS))) == (True, False, False)
