"""Invariances of the Maxwell matrices of random scenes: python3 -m tests.fem_reference.invariances [--count N] [--seed S].

A scene has sensors and bodies of every kind, in free space or in a room, with zero to three planes of symmetry. It is solved by
the field reference, for half of the scenes with proven bounds, and by boundary elements and the reduced method where they accept it.
Then it is solved again after one change that does not affect the true matrix, a different one from scene to scene. Prints a line for
each scene, and the text of every scene for which two answers differ by more than both their errors.
"""

import argparse
import logging
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "build" / "python"))

import fringe  # noqa: E402

from fem_reference import maxwell  # noqa: E402
from fem_reference.answer.reference import ErrorKind  # noqa: E402
from geometries.common.arrays import Array
from fem_reference.bodies.conductors import conductors  # noqa: E402
from geometries.common.errors import InputError  # noqa: E402
from geometries.scene import meshes  # noqa: E402
from geometries.scene.poses import AxisRotation, Pose, QuaternionRotation, Transform, Vector3  # noqa: E402
from geometries.scene.reader import load, loads  # noqa: E402
from geometries.scene.scene import Link, Object, Plate, Room, Scene, Sensor  # noqa: E402
from geometries.scene.shapes import (  # noqa: E402
    ROUND_SHAPES,
    SHEETS,
    Arc,
    Capsule,
    Cone,
    Cuboid,
    Cylinder,
    Disc,
    Ellipsoid,
    MeshShape,
    PlateShape,
    RoundedCuboid,
    Shape,
    Sphere,
)
from geometries.scene.writer import canonical  # noqa: E402
from tests import scenes  # noqa: E402
from tests.fem_reference.problems import prism  # noqa: E402

MIRROR = np.diag([1.0, -1.0, 1.0])
"""The reflection in y, which maps every shape of the scene format but polygons, in its own frame, to itself."""

RTOL = 1e-2
MOST_UNKNOWNS = {"enclosure": 1.0, "estimate": 1e5}
"""Limits on the unknowns, by kind of error: they allow one level of enclosures, and one to three levels of estimates. The errors need
not be small, since only the stated intervals are compared."""
FAR = 25.0
"""Distance (metres) from which a ball of 1 cm changes no entry by 1e-4 of itself (fem_reference/NUMERICS.md, section 10)."""


@dataclass(frozen=True)
class Answer:
    """The stated intervals of a matrix's entries; `names` are those of its rows."""

    names: tuple[str, ...]
    lower: Array
    upper: Array
    faceted: bool
    """Whether round bodies were represented by triangles rather than by their true shape."""

    def of(self, names: tuple[str, ...]) -> tuple[Array, Array]:
        """The lower and upper bounds of the entries of some rows, in this order."""
        order = np.ix_(*[[self.names.index(name) for name in names]] * 2)
        return self.lower[order], self.upper[order]


def agree(one: Answer, other: Answer, names: tuple[str, ...]) -> bool:
    """Whether the intervals of two answers overlap for every entry of these rows."""
    (below, above), (other_below, other_above) = one.of(names), other.of(names)
    return bool(np.all(below <= other_above) and np.all(other_below <= above))


# Random scenes.


def random_scene(number: int, seed: int, prism: MeshShape) -> Scene:
    """One or two sensors around z = 0, and up to two bodies above; they may come too close to each other to be solved.

    The bits of `number` say in which of two axes everything is symmetric, and whether there is a room.
    """
    random = np.random.default_rng([seed, number])
    centred, in_room, kind = [bool(number & 1), bool(number & 2)], bool(number & 4), number // 8 % 3
    half = random.uniform(0.03, 0.06, 2)
    sensors = [Sensor("sensor", (_rectangle(0.0, 0.0, half),), "all")]
    if kind == 1:
        # Side by side in y: two conductors, which a plane exchanges, or two plates of one.
        apart = half[1] + random.uniform(0.003, 0.02)
        plates = [_rectangle(0.0, side * apart, half) for side in (-1, 1)]
        if random.random() < 0.5:
            sensors = [Sensor("sensor", tuple(plates), "all")]
        else:
            sensors = [Sensor(f"sensor {k}", (plate,), "all") for k, plate in enumerate(plates)]
    objects = []
    height = random.uniform(0.01, 0.04)
    for k in range(int(random.integers(0 if kind == 1 else 1, 3))):
        shape = _shape(random, prism)
        reach = _reach(shape)
        aside = [0.0 if centred[axis] else float(random.uniform(-0.03, 0.03)) for axis in range(2)]
        turn: AxisRotation = AxisRotation((0.0, 0.0, 1.0), 90.0 * random.integers(4))
        if not any(centred):
            turn = AxisRotation(_vector(random.normal(size=3)), random.uniform(0, 180))
        where = (aside[0], aside[1], height + reach)
        height += 2 * reach + random.uniform(0.01, 0.03)
        objects.append(_object(random, f"object {k}", shape, Pose(where, turn)))
    room = _room(random, centred, height) if in_room else None
    scene = Scene(links=(Link("all"),), sensors=tuple(sensors), objects=tuple(objects), room=room)
    return scene if random.random() < 0.5 else moved(scene, random)


def _rectangle(x: float, y: float, half: Array) -> Plate:
    a, b = map(float, half)
    return Plate((x - a, y - b, 0.0), (2 * a, 0.0, 0.0), (0.0, 2 * b, 0.0))


def _shape(random: np.random.Generator, prism: MeshShape) -> Shape:
    a, b, c = map(float, random.uniform(0.02, 0.06, 3))
    shapes: list[Shape] = [
        PlateShape((a, b)),
        Cuboid((a, b, c)),
        Cuboid((a, a, a)),
        Sphere(a / 2),
        Cylinder(a / 2, b),
        Cone(a / 2, b),
        Arc(0.7 * a, a, b, float(random.choice([120.0, 360.0]))),
        prism,
        Ellipsoid((a / 2, b / 2, c / 2)),
        Capsule(a / 2, b),
        RoundedCuboid((a, b, c), 0.4 * min(a, b, c)),
        Disc(a / 2),
    ]
    # Cones and arcs have by far the finest meshes.
    weights = np.array([4, 4, 2, 3, 2, 0.5, 0.5, 3, 1, 1, 1, 2])
    return shapes[int(random.choice(len(shapes), p=weights / weights.sum()))]


def _reach(shape: Shape) -> float:
    """The radius of a ball around the shape's origin that contains the shape."""
    return float(np.linalg.norm(shape.triangles().reshape(-1, 3), axis=1).max())


def _object(random: np.random.Generator, name: str, shape: Shape, pose: Pose) -> Object:
    draw = random.random()
    if draw < 0.2:
        return Object(name, shape, "all", pose, potential="floating")
    if draw < 0.35 and not isinstance(shape, SHEETS):
        return Object(name, shape, "all", pose, relative_permittivity=float(random.choice([0.5, 4.0])))
    return Object(name, shape, "all", pose)


def _room(random: np.random.Generator, centred: list[bool], height: float) -> Room:
    """Walls 3 to 20 cm from everything; its middle is that of the bodies in the centred axes."""
    x, y = (0.0 if centred[axis] else float(random.uniform(-0.02, 0.02)) for axis in range(2))
    below, above = random.uniform(0.03, 0.2, 2)
    size = (0.24 + float(random.uniform(0.06, 0.4)), 0.34 + float(random.uniform(0.06, 0.4)))
    tall = float(height + below + above)
    return Room((*size, tall), Pose((x, y, float(height + above) - tall / 2)))


def written_prism(path: Path) -> MeshShape:
    """An L-shaped prism of 5 cm by 4 cm by 3 cm, symmetric in y, its origin in the middle of its box."""
    # In the plane of z and x, so that the prism's third direction is y.
    outline = 0.01 * np.array([[-2, -2.5], [2, -2.5], [2, 0], [-0.5, 0], [-0.5, 2.5], [-2, 2.5]])
    triangles = prism(outline)[..., [1, 2, 0]] - [0, 0.5, 0]
    meshes.write(triangles * [1, 0.03, 1], path)
    shape = loads(scenes.body("prism", "mesh", file=str(path))).objects[0].shape
    assert isinstance(shape, MeshShape)
    return shape


# Changes that must not matter.


def moved(scene: Scene, random: np.random.Generator) -> Scene:
    """The scene turned about a random axis and moved by some millimetres, with its room."""
    rotation = Rotation.from_rotvec(random.normal(size=3))
    pose = _pose(Transform(rotation.as_matrix(), random.uniform(-5e-3, 5e-3, 3)))
    (link,) = scene.links
    outer = pose.transform()
    room = None
    if scene.room is not None:
        room = replace(scene.room, pose=_pose(outer.after(scene.room.pose.transform())))
    return replace(scene, links=(replace(link, pose=_pose(outer.after(link.pose.transform()))),), room=room)


def mirrored(scene: Scene, random: np.random.Generator) -> Scene:
    """The mirror image of the scene."""
    sensors = tuple(
        replace(sensor, plates=tuple(_mirrored_plate(plate) for plate in sensor.plates))
        for sensor in scene.sensors
    )
    objects = tuple(replace(body, pose=_mirrored_pose(body.pose)) for body in scene.objects)
    (link,) = scene.links
    links = (replace(link, pose=_mirrored_pose(link.pose)),)
    room = scene.room and replace(scene.room, pose=_mirrored_pose(scene.room.pose))
    return replace(scene, links=links, sensors=sensors, objects=objects, room=room)


def exchanged(scene: Scene, random: np.random.Generator) -> Scene:
    """The scene with its bodies in the opposite order."""
    return replace(scene, sensors=scene.sensors[::-1], objects=scene.objects[::-1])


def with_a_distant_ball(scene: Scene, random: np.random.Generator) -> Scene:
    """The scene with a small ball too far away to matter; a room has no place for it."""
    if scene.room is not None:
        return moved(scene, random)
    where = FAR * random.normal(size=3)
    where *= max(1.0, FAR / float(np.linalg.norm(where)))
    return replace(
        scene, objects=(*scene.objects, Object("distant", Sphere(0.01), None, Pose(_vector(where))))
    )


def unchanged(scene: Scene, random: np.random.Generator) -> Scene:
    """The same scene, to be solved without the use of symmetry."""
    return scene


CHANGES: tuple[Callable[[Scene, np.random.Generator], Scene], ...] = (
    unchanged,
    moved,
    mirrored,
    exchanged,
    with_a_distant_ball,
)


def _mirrored_plate(plate: Plate) -> Plate:
    corner, edge_u, edge_v = (
        _vector(MIRROR @ np.array(v)) for v in (plate.corner, plate.edge_u, plate.edge_v)
    )
    return Plate(corner, edge_u, edge_v)


def _mirrored_pose(pose: Pose) -> Pose:
    """Of a frame whose contents are mirrored in its own plane: MRM is a rotation again."""
    transform = pose.transform()
    return _pose(Transform(MIRROR @ transform.rotation @ MIRROR, MIRROR @ transform.translation))


def _pose(transform: Transform) -> Pose:
    x, y, z, w = Rotation.from_matrix(transform.rotation).as_quat().tolist()
    return Pose(_vector(transform.translation), QuaternionRotation((w, x, y, z)))


def _vector(values: Array) -> Vector3:
    x, y, z = map(float, values)
    return (x, y, z)


# Methods whose answers are compared.


def by_the_field(scene: Path, error: ErrorKind, symmetry: bool) -> Answer:
    """Solve by the field reference."""
    found = maxwell(
        load(scene),
        rtol=RTOL,
        max_unknowns=MOST_UNKNOWNS[error],
        error=error,
        columns=[name for name in conductors(load(scene)).names if name != "distant"],
        symmetry=symmetry,
    )
    return Answer(found.names, found.lower, found.upper, faceted=False)


def by_panels(scene: Path, method: str) -> Answer | None:
    """Solve by boundary elements or the reduced method; None for a scene that the method refuses."""
    try:
        found = fringe.Scene.load(scene).maxwell(method=method, rtol=RTOL)
    except fringe.InputError:
        return None
    value, error = np.array(found["maxwell"]), np.array(found["error"])
    return Answer(tuple(found["conductors"]), value - error, value + error, faceted=True)


@dataclass(frozen=True)
class Compared:
    """The result for one scene: the change made to it, the number of pairs of answers compared, and the pairs that disagree."""

    change: str
    pairs: int
    disagree: tuple[str, ...]


def compared(scene: Scene, number: int, folder: Path) -> Compared | None:
    """Solve a scene and its changed copy by every method that accepts them; None when the field reference refuses the scene."""
    change = CHANGES[number % len(CHANGES)]
    random = np.random.default_rng([7, number])
    before, after = folder / "scene.toml", folder / "changed.toml"
    before.write_text(canonical(scene))
    after.write_text(canonical(change(scene, random)))
    error: ErrorKind = "estimate" if number // len(CHANGES) % 2 else "enclosure"
    answers: dict[str, Answer] = {}
    try:
        answers["field"] = by_the_field(before, error, True)
        answers["field, changed"] = by_the_field(after, error, change is not unchanged)
    except InputError:
        return None
    for method in ("boundary-elements", "reduced"):
        for path, words in ((before, method), (after, f"{method}, changed")):
            found = by_panels(path, method)
            if found is not None:
                answers[words] = found
    names = answers["field"].names
    round_bodies = any(isinstance(body.shape, ROUND_SHAPES) for body in scene.objects)
    pairs = [
        (a, b)
        for a, b in combinations(answers, 2)
        if not round_bodies or answers[a].faceted == answers[b].faceted
    ]
    wrong = [f"{a} / {b}" for a, b in pairs if not agree(answers[a], answers[b], names)]
    return Compared(change.__name__, len(pairs), tuple(wrong))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="number of the first scene (default 0)")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    logging.disable(logging.INFO)
    wrong = refused = pairs = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        prism = written_prism(folder / "prism.obj")
        for number in range(options.first, options.first + options.count):
            scene = random_scene(number, options.seed, prism)
            start = time.monotonic()
            found = compared(scene, number, folder)
            took = time.monotonic() - start
            if found is None:
                refused += 1
                print(f"{number:3}: refused, bodies too close", flush=True)
                continue
            pairs += found.pairs
            wrong += len(found.disagree)
            words = "; ".join(found.disagree) or "agree"
            print(f"{number:3}: {found.change}, {found.pairs} pairs {words} ({took:.0f} s)", flush=True)
            if found.disagree:
                print(canonical(scene))
    print(
        f"{options.count - refused} scenes, {refused} refused; {wrong} of {pairs} pairs of answers disagree"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
