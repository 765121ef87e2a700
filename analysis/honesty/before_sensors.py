"""Random scenes of targets before sensors, which are alone or on a machine: one function for each kind."""

from __future__ import annotations

from dataclasses import replace

from analysis.honesty.drawing import (
    Chance,
    angular,
    aside,
    before,
    logarithmic,
    round_body,
    sensor,
    turn,
    uniform,
)
from geometries.scene.covers import covers
from geometries.scene.person import Person
from geometries.scene.scene import Object, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid, PlateShape, Shape, Sphere
from geometries.studies.machines import ARM, GUARD, HOUSING, NONE, around, before as with_readings

_GAPS = (0.005, 0.3)
TARGET = "target"


def on_machine(chance: Chance, scene: Scene, *machines: str) -> Scene:
    """Draws one of the machines around sensors and targets. Without one, targets are marked and readings named in half of the scenes:
    some methods answer for changes only where a scene asks for them."""
    machine = chance.choice(machines)
    return with_readings(scene, ()) if machine == NONE and chance.random() < 0.5 else around(scene, machine)


def plates(chance: Chance) -> Scene:
    """A sensor by itself before a plate in any direction."""
    size = logarithmic(chance, 0.02, 0.3), logarithmic(chance, 0.02, 0.3)
    rotation = turn(chance)
    target = before(TARGET, PlateShape(size), _gap(chance), aside(chance), rotation)
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), NONE)


def sizes(chance: Chance) -> Scene:
    """A machine before a wall, a box, a ball or a person of 1 cm to 5 m."""
    gap, size = logarithmic(chance, 0.005, 0.5), logarithmic(chance, 0.01, 5.0)
    shapes: dict[str, Shape] = {
        "wall": Cuboid((size, size, 0.1)),
        "box": Cuboid((size, uniform(chance, 0.3, 1) * size, uniform(chance, 0.3, 1) * size)),
        "ball": Sphere(size / 2, 48),
        "person": Person(
            min(max(size, 0.4), 1.9), posture=chance.choice(("standing", "lying", "arm_stretched"))
        ),
    }
    target = before(TARGET, shapes[chance.choice(sorted(shapes))], gap, aside(chance, 0.3 * size))
    scene = Scene(sensors=(sensor(chance),), objects=(target,))
    return on_machine(chance, scene, HOUSING, GUARD, ARM)


def round_targets(chance: Chance) -> Scene:
    """A sensor, alone or before a housing, and a body with a curved surface."""
    target = before(TARGET, round_body(chance), _gap(chance), aside(chance), turn(chance))
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), NONE, HOUSING)


def flat_boxes(chance: Chance) -> Scene:
    """A sensor, alone or before a housing, and boxes a tenth to a thousandth as thick as they are wide."""
    bodies = []
    for number in range(chance.choice((1, 1, 2))):
        width, depth = (logarithmic(chance, 0.03, 0.3) for _ in range(2))
        thickness = width * logarithmic(chance, 1e-3, 0.1)
        # The second one lies beyond the first, which lies flat.
        gap = _gap(chance) + 0.5 * number
        rotation = turn(chance) if number == 0 and chance.random() < 0.5 else None
        name = TARGET if number == 0 else "second target"
        shape = Cuboid((width, depth, thickness))
        at = aside(chance)
        bodies.append(
            before(name, shape, gap, at, rotation) if rotation is not None else before(name, shape, gap, at)
        )
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=tuple(bodies)), NONE, HOUSING)


def covered(chance: Chance) -> Scene:
    """Two sensors on a housing, of which one or both have a cover of an insulator."""
    thickness = logarithmic(chance, 0.0005, 0.004)
    pair = _pair(chance)
    gap = thickness + _gap(chance)
    shape = angular(chance) if chance.random() < 0.5 else round_body(chance)
    scene = Scene(sensors=pair, objects=(before(TARGET, shape, gap, aside(chance), turn(chance)),))
    whole = around(scene, HOUSING)
    chosen = chance.choice((pair[:1], pair[1:], pair[1:], pair))
    layers = tuple(layer for each in chosen for layer in covers(each, thickness, uniform(chance, 1.5, 10)))
    # Readers put covers first.
    return replace(whole, objects=(*layers, *whole.objects))


def insulators(chance: Chance) -> Scene:
    """A sensor, alone or before a housing, and a target of an insulator with a permittivity of 1 to 1e6."""
    shape = round_body(chance, is_solid=True) if chance.random() < 0.5 else _box(chance)
    material = 1.0 if chance.random() < 0.05 else logarithmic(chance, 1.05, 1e6)
    target = before(TARGET, shape, _gap(chance), aside(chance), turn(chance), relative_permittivity=material)
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), NONE, HOUSING)


def floating(chance: Chance) -> Scene:
    """A sensor on a machine, and a target that floats, or is connected to the ground through 0.01 to 100 pF."""
    shape = angular(chance) if chance.random() < 0.7 else round_body(chance)
    to_ground = chance.choice((0.0, logarithmic(chance, 1e-14, 1e-10)))
    target = before(
        TARGET, shape, _gap(chance), aside(chance), turn(chance), potential="floating", to_ground=to_ground
    )
    return on_machine(chance, Scene(sensors=(sensor(chance),), objects=(target,)), HOUSING, GUARD)


def guarded(chance: Chance) -> Scene:
    """A sensor before its guard and a housing, read with the guard driven, grounded, and driven alone."""
    target = before(TARGET, angular(chance), _gap(chance), aside(chance), turn(chance))
    scene = around(Scene(sensors=(sensor(chance),), objects=(target,)), GUARD)
    more = (Reading("guard grounded", "front", ("front",)), Reading("from the guard", "front", ("guard",)))
    return replace(scene, readings=(*scene.readings, *more))


def transmitted(chance: Chance) -> Scene:
    """Two sensors, alone or on a housing: each by itself, and one that senses what the other drives."""
    target = before(TARGET, angular(chance), _gap(chance), aside(chance), turn(chance))
    scene = on_machine(chance, Scene(sensors=_pair(chance), objects=(target,)), NONE, HOUSING)
    own = tuple(Reading(each.name, each.name, (each.name,)) for each in scene.sensors)
    return replace(scene, readings=(*own, Reading("transmitted", "front", ("beside",))))


def _pair(chance: Chance) -> tuple[Sensor, Sensor]:
    """Draws two sensors beside each other."""
    first = sensor(chance)
    second = sensor(chance, "beside")
    half = sum(each.plates[0].edge_u[0] / 2 for each in (first, second))
    shift = round(half + logarithmic(chance, 0.003, 0.05), 6)
    plate = second.plates[0]
    x, y, z = plate.corner
    return first, replace(second, plates=(replace(plate, corner=(x + shift, y, z)),))


def _box(chance: Chance) -> Cuboid:
    x, y, z = (logarithmic(chance, 0.02, 0.2) for _ in range(3))
    return Cuboid((x, y, z))


def _gap(chance: Chance) -> float:
    return logarithmic(chance, *_GAPS)


def hand(chance: Chance, link: str | None = None) -> Object:
    """Draws a hand: a box or a round body of 4 to 20 cm before the origin of a link."""
    shape = _box(chance) if chance.random() < 0.5 else round_body(chance, 0.04, 0.2, is_solid=True)
    return replace(before(TARGET, shape, _gap(chance), aside(chance), turn(chance), target=True), link=link)
