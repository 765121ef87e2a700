"""Triangle meshes from files, and their conversion between formats.

The formats of scenes have readers of their own, as strict as the C++ ones (CONTRIBUTING.md says why); meshio reads all others and writes.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np

from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.common.files import whole_file
from geometries.common.tables import is_file
from geometries.scene import obj, ply, stl
from geometries.scene.faces import Surface, divided, name_points
from geometries.scene.mesh_numbers import Damaged


# The formats that the scene file allows, because the C++ reader knows them as well.
_READERS: dict[str, Callable[[bytes], Surface]] = {
    ".stl": stl.surface,
    ".obj": obj.surface,
    ".ply": ply.surface,
}
SCENE_FORMATS = tuple(_READERS)
# Surface cells by their names without a count of points, and how many of their points are corners; those of higher order have more.
_SURFACE_CELLS = {"triangle": 3, "quad": 4, "polygon": None}


def read_triangles(path: Path) -> Array:
    """Returns the triangles (n, 3, 3) of a mesh file, as `read_surface` does."""
    return read_surface(path).triangles


def read_surface(path: Path, key: str = "") -> Surface:
    """Returns the faces of a mesh file, in the file's order and unit.

    Volume meshes give the surface cells that they hold. InputError, naming `key`, when the file is missing, unreadable,
    or has no triangles, or when a vertex is missing or not finite.
    """
    if not is_file(path):
        raise InputError(str(path), key, "no such mesh file")
    own = _READERS.get(path.suffix.lower())
    if own is None:
        return _read_by_meshio(path, key)
    try:
        content = path.read_bytes()
        _require_content(content)
        surface = own(content)
    except OSError as error:
        raise InputError(str(path), key, f"cannot be read: {error.strerror}") from error
    except Damaged as damage:
        raise InputError(str(path), key, f"is not a mesh that can be read: it {damage}") from damage
    if not len(surface.triangles):
        raise InputError(str(path), key, "holds no triangles")
    if not np.isfinite(surface.triangles).all():
        raise InputError(str(path), key, "contains a vertex that is not finite")
    return surface


def _require_content(content: bytes) -> None:
    """Damaged if a file's content is not there; a pointer of Git LFS stands for a file that was not fetched."""
    if not content.strip(b"\0"):
        raise Damaged("holds nothing but zeros" if content else "is empty")
    if content.startswith(b"version https://git-lfs.github.com/spec/"):
        raise Damaged("is a pointer of Git LFS, whose content has to be fetched: git lfs pull")


def _read_by_meshio(path: Path, key: str) -> Surface:
    # Imported here: it takes a third of a second, and most scenes have no mesh.
    import meshio

    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.read(path)
    except SystemExit as error:
        reason = " ".join(said.getvalue().split())
        raise InputError(str(path), key, f"is not a mesh that can be read: {reason}") from error
    # meshio's parsers raise all kinds of errors for damaged files.
    except Exception as error:
        raise InputError(str(path), key, f"is not a mesh that can be read: {error}") from error
    points = np.zeros((len(mesh.points), 3))
    if len(points):
        coordinates = np.asarray(mesh.points, dtype=np.float64)
        points[:, : coordinates.shape[1]] = coordinates
    faces = [
        [int(corner) for corner in face[: _SURFACE_CELLS[kind]]]
        for block in mesh.cells
        if (kind := block.type.rstrip("0123456789")) in _SURFACE_CELLS
        for face in np.asarray(block.data)
    ]
    if not faces:
        raise InputError(str(path), key, "holds no triangles")
    if not name_points(faces, len(points)):
        raise InputError(str(path), key, "refers to a vertex that does not exist")
    if not np.isfinite(points).all():
        raise InputError(str(path), key, "contains a vertex that is not finite")
    return divided(points, faces)


def convert(source: Path, target: Path) -> int:
    """Writes the triangles of `source` (any format meshio knows) as STL, OBJ or PLY; returns their number.

    The target appears whole or not at all. InputError when the source cannot be read or the target cannot be written.
    """
    _require_format(target)
    triangles = read_triangles(source)
    write(triangles, target)
    return len(triangles)


def _require_format(target: Path) -> None:
    if target.suffix.lower() not in SCENE_FORMATS:
        raise InputError(str(target), "", f"must end in one of {', '.join(SCENE_FORMATS)}")


def write(triangles: Array, target: Path) -> None:
    """Writes triangles (n, 3, 3) as STL, OBJ or PLY, whole or not at all; InputError when the target cannot be written."""
    import meshio

    _require_format(target)
    points, inverse = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    # PLY has no 64-bit integers, which meshio would say on the terminal.
    mesh = meshio.Mesh(points, [("triangle", inverse.reshape(-1, 3).astype(np.int32))])
    try:
        with whole_file(target) as unfinished:
            meshio.write(unfinished, mesh)
    except (Exception, SystemExit) as error:
        raise InputError(str(target), "", f"cannot be written: {error}") from error
