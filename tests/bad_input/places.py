"""Paths that lead to no file, to what is none, or to a file by an unusual name."""

import os
from collections.abc import Callable
from pathlib import Path

from tests.bad_input.case import CUBE, SCENE, SENSOR, Case, body, from_files
from tests.bad_input.meshes import ascii_stl

WHOLE = SENSOR + body(CUBE)
NAMES = {
    "with spaces": "a scene of mine.toml",
    "in many alphabets": "Hände 手 ▢.toml",
    "with quotes": "a'b\"c.toml",
    "of a line's end": "a\nb.toml",
    "of bytes that are no UTF-8": os.fsdecode(b"\xff\xfe.toml"),
    "like an option of no ending": "scene",
}


def cases() -> list[Case]:
    return [*_scenes(), *_named(), *_meshes()]


def _scenes() -> list[Case]:
    def directory(path: Path) -> None:
        path.mkdir()

    def unreadable(path: Path) -> None:
        path.write_text(WHOLE)
        path.chmod(0)

    def beside(path: Path) -> None:
        path.with_name("other.toml").write_text(WHOLE)
        path.symlink_to("other.toml")

    made: dict[str, tuple[Callable[[Path], None], str | None]] = {
        "no file": (lambda path: None, ""),
        "a directory": (directory, ""),
        "a pipe": (lambda path: os.mkfifo(path), ""),
        "an unreadable file": (unreadable, ""),
        "a link to a scene": (beside, None),
        "a link to nothing": (lambda path: path.symlink_to("nowhere.toml"), ""),
        "a link to itself": (lambda path: path.symlink_to(SCENE), ""),
        "a link to a directory": (lambda path: path.symlink_to("."), ""),
        "a device without end": (lambda path: path.symlink_to("/dev/zero"), ""),
        "a device without bytes": (lambda path: path.symlink_to("/dev/null"), ""),
    }
    told = [_at(name, SCENE, arrange, place) for name, (arrange, place) in made.items()]
    told.append(_at("a path longer than any", "x" * 5000 + ".toml", lambda path: None, ""))
    told.append(
        _at("a path through a file", f"{SCENE}/{SCENE}", lambda path: path.parent.write_text(WHOLE), "")
    )
    return told


def _at(name: str, path: str, arrange: Callable[[Path], None], place: str | None) -> Case:
    def make(folder: Path) -> Path:
        arrange(folder / path)
        return folder / path

    return Case(f"the scene is {name}", make, place)


def _named() -> list[Case]:
    def write(path: Path) -> None:
        path.write_text(WHOLE)

    return [_at(f"a file {name}", file, write, None) for name, file in NAMES.items()]


def _meshes() -> list[Case]:
    def stl(name: str) -> Callable[[Path], None]:
        return lambda folder: (folder / name).write_text(ascii_stl()) and None

    def unreadable(folder: Path) -> None:
        stl("mesh.stl")(folder)
        (folder / "mesh.stl").chmod(0)

    def linked(folder: Path) -> None:
        stl("other.stl")(folder)
        (folder / "mesh.stl").symlink_to("other.stl")

    def deeper(folder: Path) -> None:
        (folder / "deep er").mkdir()
        stl("deep er/mesh.stl")(folder)

    made: list[tuple[str, Callable[[Path], None], str, str | None]] = [
        ("missing", lambda folder: None, "mesh.stl", "file"),
        ("a directory", lambda folder: (folder / "mesh.stl").mkdir(), "mesh.stl", "file"),
        ("a pipe", lambda folder: os.mkfifo(folder / "mesh.stl"), "mesh.stl", "file"),
        ("an unreadable file", unreadable, "mesh.stl", "file"),
        (
            "a device without end",
            lambda folder: (folder / "mesh.stl").symlink_to("/dev/zero"),
            "mesh.stl",
            "file",
        ),
        ("a link", linked, "mesh.stl", None),
        ("a link to itself", lambda folder: (folder / "mesh.stl").symlink_to("mesh.stl"), "mesh.stl", "file"),
        ("in a folder with a space", deeper, "deep er/mesh.stl", None),
        ("in a folder that is none", deeper, "deep er/mesh.stl/mesh.stl", "file"),
        ("in many alphabets", stl("Hände 手.stl"), "Hände 手.stl", None),
        ("in capitals", stl("MESH.STL"), "MESH.STL", None),
        ("of an unknown ending", stl("mesh.blend"), "mesh.blend", "file"),
        ("of no ending", stl("mesh"), "mesh", "file"),
        ("of an ending alone", stl(".stl"), ".stl", "file"),
        ("of a name with NUL", stl("mesh.stl"), "mesh.stl\\u0000.stl", "file"),
        ("of a name with a line's end", stl("me\nsh.stl"), "me\\nsh.stl", None),
        ("missing, of a name with a line's end", lambda folder: None, "me\\nsh.stl", "file"),
        ("of a name longer than any", lambda folder: None, "x" * 5000 + ".stl", "file"),
        ("the scene itself", lambda folder: None, SCENE, "file"),
        ("no name", lambda folder: None, "", "file"),
    ]
    return [from_files(f"the mesh is {name}", arrange, file, place) for name, arrange, file, place in made]
