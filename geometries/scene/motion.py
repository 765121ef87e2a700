"""Reads motion files: frames, each with the poses of a scene's links."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from geometries.common.errors import InputError
from geometries.common.tables import Table, parse, read_text
from geometries.scene import reader
from geometries.scene.poses import Pose
from geometries.scene.scene import Scene


@dataclass(frozen=True)
class Frame:
    """The pose of every link relative to its parent, in the scene's order."""

    name: str
    poses: dict[str, Pose]


def load(path: Path | str, scene: Scene) -> tuple[Frame, ...]:
    """Returns the frames in a file; InputError when the file cannot be used with the scene."""
    return loads(read_text(Path(path)), scene, source=str(path))


def loads(text: str, scene: Scene, source: str = "motion") -> tuple[Frame, ...]:
    """Returns the frames in a text; `source` stands for it in errors."""
    root = parse(text, source)
    root.known_format()
    poses = at_rest(scene).poses
    frames = []
    for index, table in enumerate(root.tables("frame")):
        # A frame's name need not be unique, so errors give its index.
        table.label = f"frame[{index}]"
        name = table.text("name", f"frame {index + 1}")
        poses = poses | _moved(table, poses)
        table.finish()
        frames.append(Frame(name, poses))
    root.finish()
    if not frames:
        raise InputError(source, "frame", "a motion needs at least one frame")
    return tuple(frames)


def at_rest(scene: Scene) -> Frame:
    """Returns the frame with the poses of the scene's file."""
    return Frame("as in the scene", {link.name: link.pose for link in scene.links})


def _moved(frame: Table, before: dict[str, Pose]) -> dict[str, Pose]:
    moved: dict[str, Pose] = {}
    for table in frame.tables("poses"):
        link = table.text("link")
        if link not in before:
            raise table.error("link", f"there is no link {link!r}")
        if link in moved:
            raise table.error("link", f"{link!r} has a pose in this frame already")
        turns = table.has("rotation") or table.has("quaternion")
        moved[link] = Pose(
            table.vector3("translation", before[link].translation),
            reader.rotation(table) if turns else before[link].rotation,
        )
        table.finish()
    return moved
