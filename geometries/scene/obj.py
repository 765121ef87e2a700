"""OBJ files: vertices and faces; groups, normals, materials and whatever else there may be are left out."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from geometries.scene.mesh_numbers import Damaged, decimals, shown, whole

Array = NDArray[np.float64]

# Numbers of a vertex: its coordinates, and a colour that some programs add.
_NUMBERS_OF_VERTEX = (3, 6)


def triangles(content: bytes) -> Array:
    """Returns the triangles (n, 3, 3) of a file's bytes in their order, polygons as fans; Damaged when there is something else."""
    vertices: list[Array] = []
    faces: list[tuple[int, list[int]]] = []
    for line, words in _statements(content):
        if words[0] == b"v":
            if len(words) - 1 not in _NUMBERS_OF_VERTEX:
                raise Damaged(f"has a vertex of {len(words) - 1} numbers in line {line}")
            vertices.append(decimals(words[1:4]))
        elif words[0] == b"f":
            faces.append((line, [_index(corner, len(vertices), line) for corner in words[1:]]))
    indices = []
    for line, corners in faces:
        if len(corners) < 3:
            raise Damaged(f"has a face of fewer than three vertices in line {line}")
        if max(corners) >= len(vertices):
            raise Damaged(f"refers to a vertex that does not exist in line {line}")
        indices += [(corners[0], here, after) for here, after in zip(corners[1:], corners[2:])]
    if not indices:
        return np.empty((0, 3, 3))
    return np.asarray(np.array(vertices)[np.array(indices)])


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
