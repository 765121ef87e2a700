"""OBJ files: vertices and faces; groups, normals, materials and whatever else there may be are left out."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geometries.common.arrays import Array
from geometries.scene.faces import Surface, divided
from geometries.scene.mesh_numbers import Damaged, decimals, plain_text, shown, whole


# Numbers of a vertex: its coordinates, and a weight or a colour.
_NUMBERS_OF_VERTEX = (3, 4, 6)


def surface(content: bytes) -> Surface:
    """Returns the faces of a file's bytes in their order; Damaged when there is something else."""
    content = plain_text(content)
    vertices: list[Array] = []
    faces: list[list[int]] = []
    lines: list[int] = []
    for line, words in _statements(content):
        if words[0] == b"v":
            vertices.append(_vertex(words, line))
        elif words[0] == b"f":
            faces.append([_index(corner, len(vertices), line) for corner in words[1:]])
            lines.append(line)
    for line, corners in zip(lines, faces):
        if len(corners) < 3:
            raise Damaged(f"has a face of fewer than three vertices in line {line}")
        if max(corners) >= len(vertices):
            raise Damaged(f"refers to a vertex that does not exist in line {line}")
    return divided(np.array(vertices).reshape(-1, 3), faces)


def _vertex(words: list[bytes], line: int) -> Array:
    """Returns the point of a vertex x y z, to which a weight or, by some programs, a colour may be added."""
    numbers = len(words) - 1
    if numbers not in _NUMBERS_OF_VERTEX:
        raise Damaged(f"has a vertex of {numbers} numbers in line {line}")
    try:
        found = decimals(words[1:5] if numbers == 4 else words[1:4])
    except Damaged as damage:
        raise Damaged(f"{damage} in line {line}") from damage
    if numbers == 4 and found[3] != 1:
        raise Damaged(f"has a vertex of the weight {shown(words[4])} in line {line}; only 1 is read")
    return found[:3]


def _statements(content: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Returns the words of each statement and the line it begins on; a backslash at the end of a line continues it on the next."""
    first, words = 0, []
    for number, line in enumerate(content.split(b"\n"), 1):
        line = line.removesuffix(b"\r")
        first = first or number
        words += line.removesuffix(b"\\").split()
        if line.endswith(b"\\"):
            continue
        if stated := _stated(words):
            yield first, stated
        first, words = 0, []
    if stated := _stated(words):
        yield first, stated


def _stated(words: list[bytes]) -> list[bytes]:
    """Returns the words before a comment."""
    return words[: next((at for at, word in enumerate(words) if word.startswith(b"#")), None)]


def _index(corner: bytes, before: int, line: int) -> int:
    """Returns the vertex, from 0, of a corner as 3, 3/1, 3//2 or -1/1/2: by number from 1, or backwards from the last one `before`."""
    number = whole(corner.split(b"/")[0])
    if number == 0 or -number > before:
        raise Damaged(f"refers to the vertex {shown(corner)}, which does not exist, in line {line}")
    return number - 1 if number > 0 else before + number
