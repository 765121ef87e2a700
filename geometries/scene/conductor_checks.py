"""Checks of a scene that concern several of its objects and readings: what one conductor may be, what a target, what is measured."""

from __future__ import annotations

from geometries.common.errors import InputError
from geometries.scene.scene import Object, Scene

# Most names that a message lists.
_MOST_NAMES = 10


def check_conductors(scene: Scene, source: str) -> None:
    """Refuses conductors whose bodies differ in potential or in the capacitance to ground, and names of conductors that others have."""
    sensors = {sensor.name for sensor in scene.sensors} | {sensor.name for sensor in scene.distance_sensors}
    conductor_of = {body.name: body.conductor for body in scene.objects}
    first: dict[str, Object] = {}
    for body in scene.objects:
        if body.conductor is None:
            continue
        name = body.conductor
        if name in sensors:
            raise _error(source, body, "conductor", f'"{name}" is the name of a sensor')
        if conductor_of.get(name, name) != name:
            reason = f'"{name}" is the name of an object outside this conductor'
            raise _error(source, body, "conductor", reason)
        other = first.setdefault(name, body)
        if other.potential != body.potential:
            reason = f'"{other.name}" is {other.potential} and "{body.name}" is {body.potential}'
            raise _error(source, body, "conductor", f"one conductor has one potential, but {reason}")
        if other.to_ground != body.to_ground:
            reason = (
                f'one conductor has one capacitance to ground, but "{other.name}" and "{body.name}" differ'
            )
            raise _error(source, body, "to_ground", reason)


def check_targets(scene: Scene, source: str) -> None:
    """Refuses targets that are electrodes, that carry a sensor, or that are a part of a floating conductor only."""
    carried: dict[str, str] = {}
    for sensor in scene.sensors:
        if sensor.link is not None:
            carried.setdefault(sensor.link, sensor.name)
    first: dict[str, Object] = {}
    for body in scene.objects:
        if body.target and body.potential == "electrode":
            raise _error(source, body, "target", "an electrode cannot be a target")
        if body.target and body.link in carried:
            reason = f'a target cannot carry a sensor, but its link carries "{carried[body.link]}"'
            raise _error(source, body, "target", reason)
        if body.conductor is None or body.potential != "floating":
            continue
        other = first.setdefault(body.conductor, body)
        if other.target != body.target:
            target, rest = (other, body) if other.target else (body, other)
            reason = "all objects of a floating conductor are targets or none is"
            raise _error(source, body, "target", f'{reason}, but "{target.name}" is and "{rest.name}" is not')


def check_readings(scene: Scene, source: str) -> None:
    """Refuses readings that sense or drive what is neither a sensor nor the conductor of an electrode."""
    # A dictionary keeps the order and has each name once.
    known = dict.fromkeys(sensor.name for sensor in scene.sensors)
    known |= dict.fromkeys(
        body.conductor or body.name for body in scene.objects if body.potential == "electrode"
    )
    for reading in scene.readings:
        for key, names in (("sense", (reading.sense,)), ("drive", reading.drive)):
            for name in names:
                if name not in known:
                    reason = f'"{name}" is neither a sensor nor the conductor of an electrode'
                    place = f'reading "{reading.name}": {key}'
                    raise InputError(source, place, f"{reason}; {_described(list(known))}")


def _error(source: str, body: Object, key: str, reason: str) -> InputError:
    return InputError(source, f'object "{body.name}": {key}', reason)


def _described(names: list[str]) -> str:
    if not names:
        return "the scene has none"
    text = "the scene has " + ", ".join(f'"{name}"' for name in names[:_MOST_NAMES])
    return text if len(names) <= _MOST_NAMES else f"{text} and {len(names) - _MOST_NAMES} more"
