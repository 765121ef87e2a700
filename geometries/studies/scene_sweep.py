"""The family "scene" of a study: a scene file by itself, or one case for every frame of a motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from geometries.common.errors import InputError
from geometries.common.tables import Table
from geometries.scene import motion, reader
from geometries.scene.scene import Scene

FAMILY = "scene"


def scenes(sweep: Table) -> Iterator[tuple[dict[str, str], Scene]]:
    """Returns the parameters and the scene of each case. Paths are relative to the study; InputError names a wrong file."""
    sweep.allow_only(("family", "file", "motion", "reference"))
    scene = reader.load(_beside(sweep, "file"))
    frames = motion.load(_beside(sweep, "motion"), scene) if sweep.has("motion") else (motion.at_rest(scene),)
    stem = Path(sweep.text("file")).stem
    if not scene.sensors:
        raise InputError(sweep.source, sweep.key("file"), "the scene has no sensor")
    for number, frame in enumerate(frames, start=1):
        links = tuple(replace(link, pose=frame.poses[link.name], joint=None) for link in scene.links)
        yield {"scene": stem, "frame": f"{number} {frame.name}"}, replace(scene, links=links)


def without_objects(scene: Scene) -> Scene:
    """Returns the sensors alone, without readings.

    Those of one link are always as they are in its frame, wherever it has moved to: one case for all frames.
    """
    alone = replace(scene, objects=(), distance_sensors=(), readings=())
    if scene.room is not None or len({sensor.link for sensor in scene.sensors}) != 1:
        return alone
    return replace(alone, links=(), sensors=tuple(replace(sensor, link=None) for sensor in scene.sensors))


def _beside(sweep: Table, name: str) -> Path:
    path = Path(sweep.source).parent / sweep.text(name)
    if not path.is_file():
        raise sweep.error(name, f"{path} is not a file")
    return path
