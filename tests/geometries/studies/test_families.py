"""Each family puts its target where it says, judged by the nearest point of the sensor's plate (face, edge or corner)."""

from __future__ import annotations

import numpy as np
import pytest

from geometries.common.errors import InputError
from geometries.scene.scene import Scene
from geometries.studies import families

SENSOR = (0.1, 0.14)


def target_points(scene: Scene) -> np.ndarray:
    """A grid of points over the target, its vertices included."""
    first = scene.conductors()["target"][0]
    corner, u, v = first[0], first[1] - first[0], first[2] - first[1]
    steps = np.linspace(0, 1, 21)
    return np.array([corner + a * u + b * v for a in steps for b in steps])


def regions(points: np.ndarray, sensor_size: tuple[float, float]) -> set[int]:
    """1, 2 or 3 for face, edge or corner of the plate being nearest; points on a border belong to the inner region."""
    outside = np.abs(points[:, :2]) > np.asarray(sensor_size) / 2 + 1e-12
    return set(1 + outside.sum(axis=1))


def distance(points: np.ndarray, sensor_size: tuple[float, float]) -> float:
    half = np.asarray([*sensor_size, 0]) / 2
    return float(np.linalg.norm(points - np.clip(points, -half, half), axis=1).min())


def test_every_family_has_one_sensor_and_one_grounded_target() -> None:
    scene = families.parallel(SENSOR, (0.05, 0.05), 0.02)
    assert [sensor.name for sensor in scene.sensors] == ["sensor"]
    assert [(body.name, body.potential) for body in scene.objects] == [("target", "grounded")]
    np.testing.assert_allclose(scene.conductors()["sensor"].mean(axis=(0, 1)), 0, atol=0.02)


def test_the_empty_scene_is_the_sensor_alone() -> None:
    scene = families.empty(SENSOR)
    assert scene.sensors == families.parallel(SENSOR, (0.05, 0.05), 0.02).sensors
    assert not scene.objects


def test_parallel_lies_in_front_of_the_plate_at_its_gap() -> None:
    points = target_points(families.parallel(SENSOR, (0.05, 0.06), 0.0137, offset=(0.01, -0.02)))
    np.testing.assert_allclose(points[:, 2], 0.0137)
    np.testing.assert_allclose(points.mean(axis=0), [0.01, -0.02, 0.0137])
    assert regions(points, SENSOR) == {1}


@pytest.mark.parametrize("tilt", [0.0, 17.2, 90.0])
def test_inclined_turns_about_an_edge_that_stays_above_the_sensors_edge(tilt: float) -> None:
    points = target_points(families.inclined(SENSOR, (0.1, 0.05), 0.01, tilt))
    hinge = points[np.isclose(points[:, 2], points[:, 2].min()) & np.isclose(points[:, 0], -0.05)]
    np.testing.assert_allclose(hinge[[0, -1]], [(-0.05, -0.025, 0.01), (-0.05, 0.025, 0.01)], atol=1e-15)
    far = [-0.05 + 0.1 * np.cos(np.radians(tilt)), 0.01 + 0.1 * np.sin(np.radians(tilt))]
    np.testing.assert_allclose([points[:, 0].max(), points[:, 2].max()], far, atol=1e-15)


@pytest.mark.parametrize("tilt", [0.0, 45.0, 90.0])
@pytest.mark.parametrize("height", [0.0, 0.03])
def test_edge_lies_wholly_beside_the_edge(tilt: float, height: float) -> None:
    points = target_points(families.edge(SENSOR, (0.05, 0.14), 0.02, height, tilt))
    assert regions(points, SENSOR) == {2}
    assert distance(points, SENSOR) == pytest.approx(np.hypot(0.02, height))


@pytest.mark.parametrize("tilt", [0.0, 45.0, 90.0])
@pytest.mark.parametrize("turn", [0.0, 30.0, -100.0])
def test_corner_lies_wholly_diagonal_to_the_corner(tilt: float, turn: float) -> None:
    points = target_points(families.corner(SENSOR, (0.05, 0.2), (0.02, 0.01), 0.005, tilt, turn))
    assert regions(points, SENSOR) == {3}
    np.testing.assert_allclose(points.min(axis=0), [0.05 + 0.02, 0.07 + 0.01, 0.005], atol=1e-15)


@pytest.mark.parametrize("tilt", [0.0, 45.0, 90.0])
def test_straddle_lies_in_several_regions_and_never_below_its_gap(tilt: float) -> None:
    points = target_points(families.straddle(SENSOR, (0.1, 0.1), 0.02, (0.03, 0.05), tilt, 20.0))
    assert len(regions(points, SENSOR)) >= 2 and 1 in regions(points, SENSOR)
    assert points[:, 2].min() == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda: families.empty((0.0, 0.1)), "sensor_size[0]"),
        (lambda: families.parallel(SENSOR, (0.1, -0.1), 0.01), "target_size[1]"),
        (lambda: families.parallel(SENSOR, SENSOR, 0.0), "gap"),
        (lambda: families.parallel(SENSOR, SENSOR, float("nan")), "gap"),
        (lambda: families.inclined(SENSOR, SENSOR, 0.0, 10.0), "hinge_gap"),
        (lambda: families.inclined(SENSOR, SENSOR, 0.01, 91.0), "tilt_degrees"),
        (lambda: families.inclined(SENSOR, SENSOR, 0.01, -1.0), "tilt_degrees"),
        (lambda: families.edge(SENSOR, SENSOR, 0.0, 0.0), "gap"),
        (lambda: families.edge(SENSOR, SENSOR, -0.01, 0.01), "gap"),
        (lambda: families.edge(SENSOR, SENSOR, 0.01, -0.01), "height"),
        (lambda: families.edge(SENSOR, (0.1, 0.15), 0.01, 0.0), "target_size[1]"),
        (lambda: families.corner(SENSOR, SENSOR, (0.0, 0.0), 0.0), "gap"),
        (lambda: families.corner(SENSOR, SENSOR, (0.01, -0.01), 0.0), "gap[1]"),
        (lambda: families.straddle(SENSOR, SENSOR, 0.0, (0.05, 0.0)), "gap"),
        (lambda: families.straddle(SENSOR, (0.02, 0.02), 0.01, (0.01, 0.0)), "offset"),
        (lambda: families.straddle(SENSOR, (0.02, 0.02), 0.01, (0.3, 0.0)), "offset"),
        (lambda: families.straddle(SENSOR, (0.1, 0.1), 0.01, (0.12, 0.14), 0.0, 45.0), "offset"),
    ],
)
def test_parameters_that_make_no_set_up_of_the_family_are_refused_by_name(make, key: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.key == key


def test_two_sensors_lie_side_by_side_with_the_target_before_the_first() -> None:
    scene = families.sensors(SENSOR, (0.05, 0.05), separation=0.02, gap=0.03, offset=(0.01, 0.0))
    alone = families.parallel(SENSOR, (0.05, 0.05), 0.03, (0.01, 0.0))
    assert scene.objects == alone.objects and scene.sensors[0] == alone.sensors[0]
    sensor, neighbour = (scene.conductors()[name].reshape(-1, 3) for name in ("sensor", "neighbour"))
    np.testing.assert_allclose(neighbour - [SENSOR[0] + 0.02, 0, 0], sensor, atol=1e-16)


@pytest.mark.parametrize(
    ("material", "permittivity", "expected"),
    [
        ("grounded", 1.0, ("grounded", None)),
        ("floating", 1.0, ("floating", None)),
        ("dielectric", 3.0, ("grounded", 3.0)),
    ],
)
def test_a_box_stands_on_its_gap_whatever_it_is_made_of(
    material: str, permittivity: float, expected: tuple[str, float | None]
) -> None:
    scene = families.box(SENSOR, (0.05, 0.06), 0.04, 0.02, (0.01, 0.0), material, permittivity)
    (body,) = scene.objects
    assert (body.potential, body.relative_permittivity) == expected
    rotation, translation = scene.pose_of_object("target")
    vertices = body.shape.triangles().reshape(-1, 3) @ rotation.T + translation
    np.testing.assert_allclose(vertices.min(axis=0), [-0.015, -0.03, 0.02])
    np.testing.assert_allclose(vertices.max(axis=0), [0.035, 0.03, 0.06])


def test_a_permittivity_is_for_dielectric_boxes_only() -> None:
    for material, permittivity in (("grounded", 3.0), ("floating", 3.0), ("dielectric", 1.0)):
        with pytest.raises(InputError, match="relative_permittivity"):
            families.box(
                SENSOR, (0.05, 0.05), 0.04, 0.02, material=material, relative_permittivity=permittivity
            )


MADE = {
    "parallel": lambda **more: families.parallel(SENSOR, (0.05, 0.05), 0.02, **more),
    "inclined": lambda **more: families.inclined(SENSOR, (0.05, 0.05), 0.01, 30.0, **more),
    "edge": lambda **more: families.edge(SENSOR, (0.05, 0.05), 0.02, 0.0, **more),
    "corner": lambda **more: families.corner(SENSOR, (0.05, 0.05), (0.02, 0.01), 0.0, 90.0, 20.0, **more),
    "straddle": lambda **more: families.straddle(SENSOR, (0.1, 0.1), 0.02, (0.03, 0.05), **more),
    "sensors": lambda **more: families.sensors(SENSOR, (0.05, 0.05), 0.02, 0.03, **more),
    "box": lambda **more: families.box(SENSOR, (0.05, 0.06), 0.04, 0.02, **more),
}


@pytest.mark.parametrize("family", MADE)
def test_the_target_of_every_family_may_float_or_be_connected_to_the_ground(family: str) -> None:
    assert set(MADE) == set(families.FAMILIES)
    make = MADE[family]
    connected = make(material="floating", to_ground=1e-10).objects[0]
    assert (connected.potential, connected.to_ground) == ("floating", 1e-10)
    assert make(material="floating").objects[0].to_ground == 0
    # As before, and so with the answers stored under its identity: a target that nothing says anything of.
    assert make(material="grounded", to_ground=0.0, machine="none") == make()
    assert not make().readings and not any(body.target for body in make().objects)


@pytest.mark.parametrize("family", MADE)
@pytest.mark.parametrize(
    ("wrong", "key"),
    [
        ({"machine": "crane"}, "machine"),
        ({"material": "wood"}, "material"),
        ({"to_ground": 1e-10}, "to_ground"),
        ({"material": "floating", "to_ground": -1e-10}, "to_ground"),
        ({"material": "floating", "to_ground": float("inf")}, "to_ground"),
    ],
)
def test_connections_and_machines_that_there_are_not_are_refused_by_name(
    family: str, wrong: dict[str, float | str], key: str
) -> None:
    with pytest.raises(InputError) as caught:
        MADE[family](**wrong)
    assert caught.value.key == key
