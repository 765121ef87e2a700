"""What a case of the corpus is, and the small scene that most of them spoil."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tests.scenes import SENSOR

SCENE = "scene.toml"
CUBE = 'type = "cube", size = 0.05'


def body(shape: str = CUBE, more: str = "translation = [0, 0, 0.1]") -> str:
    return f'\n[[object]]\nname = "body"\nshape = {{ {shape} }}\n{more}\n'


def mesh_body(file: str, more: str = "translation = [0, 0, 0.1]") -> str:
    """`file` as it stands in the scene, between double quotes."""
    return body(f'type = "mesh", file = "{file}"', more)


@dataclass(frozen=True)
class Case:
    """`make` fills a folder and returns the path to ask for. `place`: what every refusal must hold beside that path, such as
    the key; None: the input is legal. `unsolvable`: what the field reference says of a scene that is legal and has no
    capacitance. `long`: of a size for the long run only. `by_night`: like others of the same key.
    `commands`: of `fringe`, to be asked."""

    name: str
    make: Callable[[Path], Path]
    place: str | None
    unsolvable: str | None = None
    long: bool = False
    by_night: bool = False
    commands: tuple[str, ...] = ("capacitance", "collide", "sense")


def from_bytes(name: str, content: bytes, place: str | None, unsolvable: str | None = None) -> Case:
    """A scene file of these bytes."""

    def make(folder: Path) -> Path:
        (folder / SCENE).write_bytes(content)
        return folder / SCENE

    return Case(name, make, place, unsolvable)


def from_text(name: str, text: str, place: str | None, unsolvable: str | None = None) -> Case:
    return from_bytes(name, text.encode(), place, unsolvable)


def from_mesh(
    name: str, content: bytes | str, place: str | None, unsolvable: str | None = None, file: str = ""
) -> Case:
    """A scene with a mesh of this content, in `file` or else in one named like the case's first word."""
    named = file or f"mesh.{name.split()[0]}"

    def make(folder: Path) -> Path:
        (folder / named).write_bytes(content.encode() if isinstance(content, str) else content)
        (folder / SCENE).write_text(SENSOR + mesh_body(named), encoding="utf-8")
        return folder / SCENE

    return Case(name, make, place, unsolvable)


def from_files(name: str, arrange: Callable[[Path], None], file: str, place: str | None) -> Case:
    """A scene that names `file` as its mesh, in a folder that `arrange` has filled."""

    def make(folder: Path) -> Path:
        arrange(folder)
        (folder / SCENE).write_text(SENSOR + mesh_body(file), encoding="utf-8")
        return folder / SCENE

    return Case(name, make, place)


def as_root() -> bool:
    """Permissions do not stop root."""
    return os.geteuid() == 0
