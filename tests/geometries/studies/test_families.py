"""Families and machines: each family puts its target where it says, and no machine around it touches anything."""

from itertools import combinations

import numpy as np
import pytest

from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.readings import targets
from geometries.scene.scene import Reading, Scene
from geometries.scene.writer import canonical
from geometries.studies import families
from geometries.studies.machines import ARM, GUARD, HOUSING, MACHINES, NONE, TABLE

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
