"""Triangle meshes from files, and their conversion between formats.

The formats of scenes have readers of their own, as strict as the C++ ones (CONTRIBUTING.md says why); meshio reads all others and writes.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geometries.common.errors import InputError
from geometries.common.files import whole_file
from geometries.common.tables import is_file
from geometries.scene import obj, ply, stl
from geometries.scene.mesh_numbers import Damaged

Array = NDArray[np.float64]

# The formats that the scene file allows, because the C++ reader knows them as well.
_READERS: dict[str, Callable[[bytes], Array]] = {
    ".stl": stl.triangles,
    ".obj": obj.triangles,
    ".ply": ply.triangles,
}
SCENE_FORMATS = tuple(_READERS)
_SURFACE_CELLS = ("triangle", "quad", "polygon")


def read_triangles(path: Path, key: str = "") -> Array:
    """Returns the triangles (n, 3, 3) of a mesh file, in the file's order and unit; polygons as fans from their first vertex.

    Volume meshes give the surface cells that they hold. InputError, naming `key`, when the file is missing, unreadable,
    or has no triangles, or when a vertex is missing or not finite.
    """
    if not is_file(path):
        raise InputError(str(path), key, "no such mesh file")
    own = _READERS.get(path.suffix.lower())
    if own is None:
        return _read_by_meshio(path, key)
    try:
        triangles = own(path.read_bytes())
    except OSError as error:
        raise InputError(str(path), key, f"cannot be read: {error.strerror}") from error
    except Damaged as damage:
        raise InputError(str(path), key, f"is not a mesh that can be read: it {damage}") from damage
    return _checked(triangles, path, key)


def _read_by_meshio(path: Path, key: str) -> Array:
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
    fans = [
        _fan(np.asarray(block.data))
        for block in mesh.cells
        if block.type.rstrip("0123456789") in _SURFACE_CELLS
    ]
    indices = np.concatenate(fans) if fans else np.empty((0, 3), dtype=np.int64)
    if not len(indices):
        raise InputError(str(path), key, "holds no triangles")
    if indices.min() < 0 or indices.max() >= len(points):
        raise InputError(str(path), key, "refers to a vertex that does not exist")
    return _checked(points[indices], path, key)


def _checked(triangles: Array, path: Path, key: str) -> Array:
    if not len(triangles):
        raise InputError(str(path), key, "holds no triangles")
    if not np.isfinite(triangles).all():
        raise InputError(str(path), key, "contains a vertex that is not finite")
    return triangles


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
    mesh = meshio.Mesh(points, [("triangle", inverse.reshape(-1, 3))])
    try:
        with whole_file(target) as unfinished:
            meshio.write(unfinished, mesh)
    except (Exception, SystemExit) as error:
        raise InputError(str(target), "", f"cannot be written: {error}") from error


def _fan(polygons: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns polygons (n, m) as fans of triangles (n·(m − 2), 3) from their first vertex."""
    last = polygons.shape[1] - 1
    fans = np.stack([polygons[:, [0, k, k + 1]] for k in range(1, last)], axis=1)
    return np.asarray(fans.reshape(-1, 3), dtype=np.int64)
