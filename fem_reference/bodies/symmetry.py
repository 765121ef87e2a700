"""Planes in which a scene is its own mirror image, found and not declared: they spare the mesh half of space each.

Every conductor has to be its own image, so that all potentials are symmetric and no field line crosses the plane. Where mirroring
exchanges conductors, no mesh is spared, but entries of the Maxwell matrix are equal, which checks the answer.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from fem_reference.bodies.shapes import Body, Cuboid, Disc, Rectangle
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Sphere

Array = NDArray[np.float64]

ROOM = -1
"""What a room's walls belong to, beside the numbers of the conductors."""

TOLERANCE = 1e-9
"""How far images may be off, over the unit of length (the scene's bounding sphere): rounding of poses, and far below the error
of any answer."""


@dataclass(frozen=True)
class Plane:
    """The points x with normal·x = offset; the normal (3,) is of unit length."""

    normal: Array
    offset: float

    def mirrored(self, points: Array) -> Array:
        """The images (…, 3) of points (…, 3)."""
        return points - 2 * (points @ self.normal - self.offset)[..., None] * self.normal

    def turned(self, directions: Array) -> Array:
        """The images (…, 3) of directions (…, 3)."""
        return directions - 2 * (directions @ self.normal)[..., None] * self.normal


def mirror_planes(
    bodies: Sequence[Body], owner: Sequence[int], room: Cuboid | None = None
) -> tuple[Plane, ...]:
    """Up to three planes at right angles, in each of which every conductor and every dielectric body is its own image.

    So is the room, when there is one.

    Planes in which a plate lies are left out: on the outline of a plate in the mesh's own boundary gmsh now and then makes a
    tetrahedron without volume. `owner[k]` is the conductor or dielectric body that body k belongs to. Lengths are over
    the scene's unit.
    """
    bodies, owner = _with_room(bodies, owner, room)
    found: list[Plane] = []
    for plane in _candidates(bodies, owner):
        upright = all(abs(plane.normal @ other.normal) < TOLERANCE for other in found)
        if upright and not _holds_a_plate(plane, bodies) and _is_own_image(plane, bodies, owner):
            found.append(plane)
    return tuple(found)


def exchanges(
    bodies: Sequence[Body], owner: Sequence[int], kinds: Sequence[Hashable], room: Cuboid | None = None
) -> tuple[tuple[int, ...], ...]:
    """The mirror images of the scene that are the scene with some of its conductors or dielectric bodies exchanged.

    Each is a tuple: number k of `owner` becomes the number in place k, which is of the same kind, `kinds[k]`. Entries of the
    Maxwell matrix that an exchange maps to each other are equal. The other arguments are those of `mirror_planes`.
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


def _with_room(
    bodies: Sequence[Body], owner: Sequence[int], room: Cuboid | None
) -> tuple[list[Body], list[int]]:
    """The bodies and their owners with the room, if any, as one body more."""
    if room is None:
        return list(bodies), list(owner)
    return [*bodies, room], [*owner, ROOM]


def _candidates(bodies: Sequence[Body], owner: Sequence[int]) -> Iterator[Plane]:
    """Planes of symmetry of the first body, and those that exchange it with another of its conductor."""
    first = bodies[0]
    centre = first.corners.mean(axis=0)
    # A sphere has any axes; of surfaces made of triangles none are known.
    axes = np.eye(3) if isinstance(first, Sphere | Polyhedron) else first.axes
    for axis in axes:
        yield Plane(axis, float(axis @ centre))
    # A square has two more.
    for one, other in combinations(axes, 2):
        for diagonal in ((one + other) / np.sqrt(2), (one - other) / np.sqrt(2)):
            yield Plane(diagonal, float(diagonal @ centre))
    own = [body for body, number in zip(bodies, owner) if number == owner[0]]
    yield from _bisectors(own)


def _bisectors(bodies: Sequence[Body]) -> Iterator[Plane]:
    """The planes in the middle between the first body's centre and those of the others."""
    centre = bodies[0].corners.mean(axis=0)
    for body in bodies[1:]:
        between = body.corners.mean(axis=0) - centre
        length = float(np.linalg.norm(between))
        if length > TOLERANCE:
            normal = between / length
            yield Plane(normal, float(normal @ (centre + between / 2)))


def _holds_a_plate(plane: Plane, bodies: Sequence[Body]) -> bool:
    plates = [body for body in bodies if isinstance(body, Rectangle | Disc)]
    return any(np.abs(plate.corners @ plane.normal - plane.offset).max() < TOLERANCE for plate in plates)


def _is_own_image(plane: Plane, bodies: Sequence[Body], owner: Sequence[int]) -> bool:
    """Whether every conductor and every dielectric body is its own mirror image."""
    images = _images(plane, bodies, owner)
    return images is not None and all(number == image for number, image in images.items())


def _images(plane: Plane, bodies: Sequence[Body], owner: Sequence[int]) -> dict[int, int] | None:
    """The number of `owner` that each number becomes in the mirror; None if the mirror image is another scene.

    All bodies of one number become bodies of one number, of as many.
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
    """Whether `other` is the mirror image of `body`; not known of surfaces made of triangles."""
    if type(body) is not type(other) or isinstance(body, Polyhedron):
        return False
    corners, wanted = plane.mirrored(body.corners), other.corners
    if isinstance(body, Sphere):
        return bool(
            np.allclose(corners.mean(axis=0), wanted.mean(axis=0), rtol=0, atol=TOLERANCE)
        ) and _same_lengths(body, other)
    distances = np.linalg.norm(corners[:, None] - wanted[None], axis=2)
    if distances.min(axis=1).max() > TOLERANCE:
        return False
    if isinstance(body, Rectangle | Cuboid):
        return True
    # Round bodies fill the boxes of their corners, so that the axes have to correspond too.
    assert isinstance(other, Disc | Cylinder | Cone | Arc)
    axis, wanted_axis = plane.turned(body.axes[2]), other.axes[2]
    along = float(axis @ wanted_axis) if isinstance(body, Cone) else abs(float(axis @ wanted_axis))
    middle = float(plane.turned(body.axes[0]) @ other.axes[0]) if isinstance(body, Arc) else 1.0
    return along > 1 - TOLERANCE and middle > 1 - TOLERANCE and _same_lengths(body, other)


def _same_lengths(body: Body, other: Body) -> bool:
    names = ("radius", "height", "inner_radius", "outer_radius", "half_angle")
    pairs = [(getattr(body, name), getattr(other, name)) for name in names if hasattr(body, name)]
    return all(abs(a - b) <= TOLERANCE for a, b in pairs)
