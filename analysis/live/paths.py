"""Paths of a live page: the motion beside a scene, and two that its target takes before its first sensor; with reference readings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.results.store import Document
from analysis.show.data import in_frame
from geometries.common.arrays import Array
from geometries.scene import poses as scene_poses
from geometries.scene.motion import Frame, at_rest
from geometries.scene.poses import Pose
from geometries.scene.scene import Object, Scene


HEIGHTS = (0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01)
"""Distances (m) of the target from the sensor's plane on the approach."""
EDGE_HEIGHT = 0.03
"""Distance (m) of the target from the sensor's plane on the way over its edge."""
EDGE_FRAMES = 9
_BEYOND = 0.02
"""Gap (m) between the target and the sensor, seen from above, at both ends of the way over its edge."""


@dataclass(frozen=True)
class Path:
    """Frames through which the page moves; `said` tells in a sentence what moves."""

    name: str
    said: str
    frames: tuple[Frame, ...]


def of_scene(scene: Scene, motion: Sequence[Frame]) -> list[Path]:
    """Returns the paths of a scene; `motion` has the frames of the motion beside it, if any. The target that a link of its own carries
    approaches the first sensor, and slides over its edge."""
    paths = [Path("motion", "The frames of the motion file.", tuple(motion))] if motion else []
    target = _carried_target(scene)
    if target is None:
        return paths
    place, sensor = _Place.of(scene, target), scene.sensors[0].name
    approach = tuple(place.frame(f"{1000 * height:.0f} mm", height, place.beside) for height in HEIGHTS)
    half = place.length / 2 + place.half_width + _BEYOND
    over = tuple(
        place.frame(f"{1000 * beside:.0f} mm".replace("-", "−"), EDGE_HEIGHT, float(beside))
        for beside in np.linspace(-half, half, EDGE_FRAMES)
    )
    ends = f"{100 * HEIGHTS[0]:g} cm to {100 * HEIGHTS[-1]:g} cm"
    return [
        *paths,
        Path("approach", f"“{target.name}” comes from {ends} before “{sensor}”.", approach),
        Path(
            "over the edge",
            f"“{target.name}” slides over the edges of “{sensor}”, {100 * EDGE_HEIGHT:g} cm before it; places are those of its centre.",
            over,
        ),
    ]


def _carried_target(scene: Scene) -> Object | None:
    """Returns the first marked target, or the only object, on a link that carries no sensor and has no joint; None where there is no
    such or no sensor."""
    with_sensor = {sensor.link for sensor in scene.sensors} | {None}
    jointed = {link.name for link in scene.links if link.joint is not None}
    found = (
        body
        for body in scene.objects
        if (body.target or len(scene.objects) == 1) and body.link not in with_sensor | jointed
    )
    return next(found, None) if scene.sensors else None


@dataclass(frozen=True)
class _Place:
    """Where a target is before the first plate of a sensor; metres, in the world."""

    scene: Scene
    link: str
    normal: Array
    along: Array  # of length 1, along the plate's first edge
    length: float  # of that edge
    height: float  # of the target's lowest point
    beside: float  # of the target's centre, from the plate's, along that edge
    half_width: float  # of the target along that edge

    @staticmethod
    def of(scene: Scene, target: Object) -> _Place:
        corner, u, v = scene.sensor_rectangles(scene.sensors[0].name)[0]
        points = scene.conductors()[target.name].reshape(-1, 3) - (corner + (u + v) / 2)
        normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        if points.mean(axis=0) @ normal < 0:
            normal = -normal
        along, length = u / np.linalg.norm(u), float(np.linalg.norm(u))
        low, high = (points @ along).min(), (points @ along).max()
        assert target.link is not None
        return _Place(
            scene,
            target.link,
            normal,
            along,
            length,
            float((points @ normal).min()),
            float(low + high) / 2,
            float(high - low) / 2,
        )

    def frame(self, name: str, height: float, beside: float) -> Frame:
        """Returns the frame in which the target is so high above the plate, and so far beside its centre."""
        shift = (height - self.height) * self.normal + (beside - self.beside) * self.along
        link = {link.name: link for link in self.scene.links}[self.link]
        local = self.scene.transform_of_link(link.parent).rotation.T @ shift
        x, y, z = (float(a + b) for a, b in zip(link.pose.translation, local))
        return Frame(name, at_rest(self.scene).poses | {self.link: replace(link.pose, translation=(x, y, z))})


def described(path: Path, reference: list[Document] | None) -> Document:
    """Describes a path for the page: the poses of all links in every frame, and the reference readings if they are solved."""
    frames = [
        {"name": frame.name, "poses": [_pose(pose) for pose in frame.poses.values()]} for frame in path.frames
    ]
    return {"name": path.name, "said": path.said, "frames": frames, "reference": reference}


def _pose(pose: Pose) -> Document:
    return {
        "translation": list(pose.translation),
        "quaternion": scene_poses.quaternion(pose.rotation).tolist(),
    }


def solved(path: Path, live: Any, rtol: float, tell: Callable[[], None]) -> list[Document]:
    """Returns for every frame of a path, by the name of the reading, its change and the error of that (F), by boundary elements.

    `live` is the scene of the module fringe; `tell` is called after each frame. A frame that boundary elements refuse has no entries.
    """
    frames: list[Document] = []
    for frame in path.frames:
        try:
            readings = in_frame(live, frame, "boundary-elements", rtol=rtol)
        except ValueError:
            readings = {}
        frames.append(
            {
                name: [reading.change, reading.error["change"] or 0.0]
                for name, reading in readings.items()
                if reading.change is not None
            }
        )
        tell()
    return frames
