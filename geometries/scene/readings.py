"""What a scene measures, and what of it comes and goes, with what the file leaves out filled in."""

from __future__ import annotations

from dataclasses import replace

from geometries.scene.covers import is_cover
from geometries.scene.scene import Reading, Scene

# Threshold of a reading, in standard deviations of its noise.
_DEVIATIONS_NOTICED = 5.0


def readings(scene: Scene) -> tuple[Reading, ...]:
    """Returns the readings of a scene, with five times the noise (F) as the threshold where only the noise is given.

    A scene without any has one for every sensor, with its name, that senses and drives it.
    """
    held = scene.readings or tuple(
        Reading(sensor.name, sensor.name, (sensor.name,)) for sensor in scene.sensors
    )
    return tuple(_with_threshold(reading) for reading in held)


def targets(scene: Scene) -> tuple[bool, ...]:
    """Tells of every object whether it is a target: those that are marked, or, if none is, all except electrodes and covers."""
    if any(body.target for body in scene.objects):
        return tuple(body.target for body in scene.objects)
    return tuple(body.potential != "electrode" and not is_cover(body) for body in scene.objects)


def _with_threshold(reading: Reading) -> Reading:
    if reading.noise is None or reading.threshold is not None:
        return reading
    return replace(reading, threshold=_DEVIATIONS_NOTICED * reading.noise)
