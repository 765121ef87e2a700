"""Finds the planes in which a scene is its own mirror image; each of them halves the space to be meshed.

Every conductor has to be its own mirror image, so that all potentials are symmetric and no field line crosses the plane. A plane in
which mirroring exchanges conductors does not reduce the mesh; but it makes entries of the Maxwell matrix equal, which checks the answer.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from fem_reference.bodies.shapes import SHEETS, Body, Cuboid, Disc, PlanePolygon, Rectangle
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, Sphere, Swept
from geometries.common.arrays import Array

ROOM = -1
"""The owner number of a room's walls, which no conductor has."""

TOLERANCE = 1e-9
"""Largest distance between a mirror image and the body it has to coincide with, over the unit of length (the radius of the scene's
bounding sphere). It allows for the rounding of poses, and is far below the error of any answer."""


@dataclass(frozen=True)
class Plane:
    """The plane of the points x with normal·x = offset, where the normal (3,) has unit length."""

    normal: Array
    offset: float

    def mirrored(self, points: Array) -> Array:
        """The mirror images (…, 3) of points (…, 3)."""
        return points - 2 * (points @ self.normal - self.offset)[..., None] * self.normal

    def turned(self, directions: Array) -> Array:
        """The mirror images (…, 3) of directions (…, 3)."""
        return directions - 2 * (directions @ self.normal)[..., None] * self.normal


def mirror_planes(
    bodies: Sequence[Body], owner: Sequence[int], room: Cuboid | None = None
) -> tuple[Plane, ...]:
    """Find up to three planes at right angles in which every conductor, every dielectric body and the room are their own images.

    Planes in which a plate lies are left out: where the outline of a plate lies in the boundary of the mesh, gmsh sometimes makes
    tetrahedra without volume. `owner[k]` is the conductor or dielectric body that body k belongs to. Lengths are over the scene's
    unit.
    """
    bodies, owner = _with_room(bodies, owner, room)
    found: list[Plane] = []
    for plane in _candidates(bodies, owner):
        upright = all(abs(plane.normal @ other.normal) < TOLERANCE for other in found)
        if upright and not _contains_a_plate(plane, bodies) and _is_own_image(plane, bodies, owner):
            found.append(plane)
    return tuple(found)


def exchanges(
    bodies: Sequence[Body], owner: Sequence[int], kinds: Sequence[Hashable], room: Cuboid | None = None
) -> tuple[tuple[int, ...], ...]:
    """Find the planes in which the scene is mirrored to itself with some of its conductors or dielectric bodies exchanged.

    Each plane is described by the permutation of the numbers in `owner`, as a tuple: mirroring takes number k to the number in place
    k, which has the same kind, `kinds[k]`. Entries of the Maxwell matrix that the permutation maps to each other are equal. The other
    arguments are those of `mirror_planes`.
    """
    bodies, owner = _with_room(bodies, owner, room)
    found: list[tuple[int, ...]] = []
    for plane in [*_candidates(bodies, owner), *_bisectors(bodies)]:
        images = _images(plane, bodies, owner)
        if images is None:
            continue
        exchange = tuple(images[number] for number in range(len(kinds)))
        same_kinds = all(kinds[number] == kinds[image] for number, image in enumerate(exchange))
        if same_kinds and exchange != tuple(range(len(kinds))) and exchange not in found:
            found.append(exchange)
    return tuple(found)


def orbits(
    bodies: Sequence[Body], owner: Sequence[int], planes: Sequence[Plane]
) -> tuple[frozenset[int], ...]:
    """The sets of bodies, by number, that these planes of symmetry map to each other."""
    sets = [frozenset([k]) for k in range(len(bodies))]
    for plane in planes:
        for k, body in enumerate(bodies):
            for j in range(k):
                if owner[j] == owner[k] and _is_image(body, bodies[j], plane):
                    both = sets[j] | sets[k]
                    sets = [both if own & both else own for own in sets]
    return tuple(dict.fromkeys(sets))


def _with_room(
    bodies: Sequence[Body], owner: Sequence[int], room: Cuboid | None
) -> tuple[list[Body], list[int]]:
    """The bodies and their owners, with the room, if any, as an additional body."""
    if room is None:
        return list(bodies), list(owner)
    return [*bodies, room], [*owner, ROOM]


def _candidates(bodies: Sequence[Body], owner: Sequence[int]) -> Iterator[Plane]:
    """Planes of symmetry of the first body, and planes that may exchange it with another body of its conductor."""
    first = bodies[0]
    centre = first.corners.mean(axis=0)
    # For a sphere any axes will do; for a triangle mesh no axes are known.
    axes = np.eye(3) if isinstance(first, Sphere | Polyhedron) else first.axes
    for axis in axes:
        yield Plane(axis, float(axis @ centre))
    # A square is symmetric about its diagonals as well.
    for one, other in combinations(axes, 2):
        for diagonal in ((one + other) / np.sqrt(2), (one - other) / np.sqrt(2)):
            yield Plane(diagonal, float(diagonal @ centre))
    own = [body for body, number in zip(bodies, owner) if number == owner[0]]
    yield from _bisectors(own)


def _bisectors(bodies: Sequence[Body]) -> Iterator[Plane]:
    """The perpendicular bisectors between the centre of the first body and those of the other bodies."""
    centre = bodies[0].corners.mean(axis=0)
    for body in bodies[1:]:
        between = body.corners.mean(axis=0) - centre
        length = float(np.linalg.norm(between))
        if length > TOLERANCE:
            normal = between / length
            yield Plane(normal, float(normal @ (centre + between / 2)))


def _contains_a_plate(plane: Plane, bodies: Sequence[Body]) -> bool:
    """Whether a plate lies in the plane."""
    plates = [body for body in bodies if isinstance(body, SHEETS)]
    return any(np.abs(plate.corners @ plane.normal - plane.offset).max() < TOLERANCE for plate in plates)


def _is_own_image(plane: Plane, bodies: Sequence[Body], owner: Sequence[int]) -> bool:
    """Whether every conductor and every dielectric body is its own mirror image."""
    images = _images(plane, bodies, owner)
    return images is not None and all(number == image for number, image in images.items())


def _images(plane: Plane, bodies: Sequence[Body], owner: Sequence[int]) -> dict[int, int] | None:
    """The number of `owner` to which mirroring takes each number; None if the mirror image is a different scene.

    All bodies of one number must become bodies of a single number, which has as many bodies.
    """
    images: dict[int, int] = {}
    for body, own in zip(bodies, owner):
        candidates = {other for image, other in zip(bodies, owner) if _is_image(body, image, plane)}
        if own in images:
            candidates &= {images[own]}
        if not candidates:
            return None
        images[own] = own if own in candidates else min(candidates)
    one_to_one = len(set(images.values())) == len(images)
    as_many = all(owner.count(own) == owner.count(image) for own, image in images.items())
    return images if one_to_one and as_many else None


def _is_image(body: Body, other: Body, plane: Plane) -> bool:
    """Whether `other` is the mirror image of `body`; False for triangle meshes and polygons, for which this is not examined."""
    if type(body) is not type(other) or isinstance(body, Polyhedron | PlanePolygon):
        return False
    corners, wanted = plane.mirrored(body.corners), other.corners
    if isinstance(body, Sphere):
        return bool(
            np.allclose(corners.mean(axis=0), wanted.mean(axis=0), rtol=0, atol=TOLERANCE)
        ) and _same_lengths(body, other)
    distances = np.linalg.norm(corners[:, None] - wanted[None], axis=2)
    if distances.min(axis=1).max() > TOLERANCE:
        return False
    if isinstance(body, Rectangle | Cuboid | Ellipsoid):
        return True
    if isinstance(body, Swept):
        return _same_lengths(body, other)
    # Round bodies with the same bounding box may still have different axes, so that the axes have to correspond too.
    assert isinstance(other, Disc | Cylinder | Cone | Arc)
    axis, wanted_axis = plane.turned(body.axes[2]), other.axes[2]
    along = float(axis @ wanted_axis) if isinstance(body, Cone) else abs(float(axis @ wanted_axis))
    middle = float(plane.turned(body.axes[0]) @ other.axes[0]) if isinstance(body, Arc) else 1.0
    return along > 1 - TOLERANCE and middle > 1 - TOLERANCE and _same_lengths(body, other)


def _same_lengths(body: Body, other: Body) -> bool:
    """Whether all lengths and angles of two round bodies agree within TOLERANCE."""
    names = ("radius", "height", "inner_radius", "outer_radius", "half_angle")
    pairs = [(getattr(body, name), getattr(other, name)) for name in names if hasattr(body, name)]
    return all(abs(a - b) <= TOLERANCE for a, b in pairs)
