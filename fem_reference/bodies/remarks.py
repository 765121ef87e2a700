"""Remarks on scenes: sentences on what can be answered, but is probably not what was meant.

The C++ library makes the same remarks in the same words, from a reader of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_reference.bodies.polyhedron import signed_volume
from fem_reference.bodies.triangle_distances import winding_number
from geometries.common.arrays import Array, Indices
from geometries.scene.poses import Transform
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import MeshShape


# Longest plate of a sensor without a remark, in metres: the electrodes of proximity sensors are centimetres long, so that those written
# in millimetres seem to be more than 10 m.
_LONGEST_PLATE = 10.0
# Longest object without a remark, in metres: rooms in which such sensors work are shorter, and a finger written in millimetres seems to
# be longer.
_LONGEST_OBJECT = 20.0
# Shortest scene without a remark, in metres: one of a metre, read as if it were in millimetres.
_SHORTEST_SCENE = 1e-3
# Number of an object's vertices that are looked for inside another object.
_MOST_VERTICES = 8
# Number of names that a remark lists.
_MOST_NAMES = 3
_QUESTION = 'is it in millimetres? Then write units = "mm" at the top of the scene'


@dataclass(frozen=True)
class _Surface:
    """The triangles (n, 3, 3) of an object in its own frame and in the world, in metres."""

    body: Object
    own: Array
    triangles: Array

    @property
    def low(self) -> Array:
        return np.asarray(self.triangles.min(axis=(0, 1)))

    @property
    def high(self) -> Array:
        return np.asarray(self.triangles.max(axis=(0, 1)))

    @cached_property
    def is_closed(self) -> bool:
        return _is_closed(self.triangles)

    def contains(self, other: _Surface) -> bool:
        """Tells whether vertices of another surface, chosen evenly, are all inside this one."""
        # Strictly, because vertices on the surface are neither inside nor outside.
        if not ((self.low < other.low).all() and (other.high < self.high).all() and self.is_closed):
            return False
        count = min(len(other.triangles), _MOST_VERTICES)
        chosen = np.arange(count) * len(other.triangles) // count
        return bool((np.abs(winding_number(self.triangles, other.triangles[chosen, 0])) > 0.5).all())


def remarks(scene: Scene) -> list[str]:
    """Returns the remarks on a scene: on what the reader mended, sizes, triangles that do not count or face inwards, permittivities below 1, and objects in others."""
    surfaces = []
    for body in scene.objects:
        own = body.shape.triangles()
        surfaces.append(_Surface(body, own, Transform(*scene.pose_of_object(body.name)).points(own)))
    found = [*scene.changes, *_on_sizes(scene, surfaces)]
    for surface in surfaces:
        found += _on_triangles(surface.body)
    return found + _on_permittivities(scene) + _on_insides(surfaces)


def _on_sizes(scene: Scene, surfaces: list[_Surface]) -> list[str]:
    found = []
    plates = [
        (max(np.linalg.norm(plate.edge_u), np.linalg.norm(plate.edge_v)), sensor.name, index)
        for sensor in scene.sensors
        for index, plate in enumerate(sensor.plates)
    ]
    length, name, index = max(plates, key=lambda plate: plate[0], default=(0.0, "", 0))
    if length > _LONGEST_PLATE:
        found.append(f'sensor "{name}": plates[{index}] is {length:.3g} m long: {_QUESTION}')
    lengths = [float(np.ptp(surface.own, axis=(0, 1)).max()) for surface in surfaces]
    if lengths and max(lengths) > _LONGEST_OBJECT:
        body = surfaces[int(np.argmax(lengths))].body
        more = ", or scale = 0.001 in the object's shape" if isinstance(body.shape, MeshShape) else ""
        found.append(f'object "{body.name}" is {max(lengths):.3g} m long: {_QUESTION}{more}')
    points = [surface.triangles.reshape(-1, 3) for surface in surfaces]
    for sensor in scene.sensors:
        points += [np.array([c, c + u, c + v, c + u + v]) for c, u, v in scene.sensor_rectangles(sensor.name)]
    whole = float(np.ptp(np.concatenate(points), axis=0).max())
    if whole < _SHORTEST_SCENE:
        found.append(
            f"all of the scene is {whole:.3g} m long: are its lengths in other units than it says by units and scale?"
        )
    return found


def _on_triangles(body: Object) -> list[str]:
    """Remarks on triangles of a mesh that do not count, and on those that face inwards."""
    if not isinstance(body.shape, MeshShape):
        return []
    triangles = body.shape.triangles()
    sound = triangles[_doubled_areas(triangles) > 0]
    without_area, repeated = len(triangles) - len(sound), len(sound) - _different(sound)
    found, left_out = [], []
    if without_area:
        left_out.append(f"triangles without area: {without_area}")
    if repeated:
        left_out.append(f"triangles that repeat others: {repeated}")
    if left_out:
        found.append(f'object "{body.name}": {", ".join(left_out)}; they are left out')
    if _is_closed(triangles) and signed_volume(triangles) < 0:
        found.append(
            f'object "{body.name}": its triangles face inwards: with faces "facing" its far side counts, and the field solver wraps it; '
            "reverse the order of their vertices"
        )
    return found


def _on_permittivities(scene: Scene) -> list[str]:
    """Remarks on dielectric objects that polarise less than empty space."""
    return [
        f'object "{body.name}": its relative permittivity of {body.relative_permittivity:.3g} is less than that of empty space, 1; '
        "no material has it at rest"
        for body in scene.objects
        if body.relative_permittivity is not None and body.relative_permittivity < 1
    ]


def _on_insides(surfaces: list[_Surface]) -> list[str]:
    found = []
    for outer in surfaces:
        inside = [inner.body.name for inner in surfaces if inner is not outer and outer.contains(inner)]
        if inside:
            found.append(
                f'object "{outer.body.name}" contains {_listed(inside)}: the triangle integrals and the formula count what is inside as if '
                "it were not; the other methods take grounded objects as one, and refuse others"
            )
    return found


def _listed(names: list[str]) -> str:
    """Lists up to three names in quotation marks, and counts the others."""
    quoted = [f'"{name}"' for name in names[:_MOST_NAMES]]
    if len(names) > _MOST_NAMES:
        return f"{', '.join(quoted)} and {len(names) - _MOST_NAMES} more"
    return " and ".join(filter(None, [", ".join(quoted[:-1]), quoted[-1]]))


def _doubled_areas(triangles: Array) -> Array:
    """Returns twice the areas (n,), from the two shorter edges, which carry the smallest rounding error into the cross product."""
    edges = triangles[:, [2, 0, 1]] - triangles[:, [1, 2, 0]]
    longest = np.argmax(np.einsum("ijk,ijk->ij", edges, edges), axis=1)
    rows = np.arange(len(edges))
    return np.asarray(
        np.linalg.norm(np.cross(edges[rows, (longest + 1) % 3], edges[rows, (longest + 2) % 3]), axis=1)
    )


def _vertices(triangles: Array) -> Indices:
    """Returns the vertices' numbers (n, 3); vertices are the same if their coordinates are."""
    inverse = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)[1]
    return np.asarray(inverse, dtype=np.int64).reshape(-1, 3)


def _different(triangles: Array) -> int:
    """Counts the triangles that have different vertices, in any order."""
    return len(np.unique(np.sort(_vertices(triangles), axis=1), axis=0)) if len(triangles) else 0


def _is_closed(triangles: Array) -> bool:
    """Tells whether every edge is used as often in one direction as in the other."""
    corners = _vertices(triangles)
    starts, ends = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    edges, which = np.unique(
        np.column_stack([np.minimum(starts, ends), np.maximum(starts, ends)]), axis=0, return_inverse=True
    )
    balance = np.bincount(which.ravel(), np.sign(ends - starts), len(edges))
    return not balance.any()
