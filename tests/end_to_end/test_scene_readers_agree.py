"""Two readers of one format, C++ for the model and Python for the reference: same file, same names, same triangles."""

from itertools import cycle, product
from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from fem_reference.bodies.remarks import remarks
from geometries.scene import motion, reader
from geometries.scene.person import BUILDS, POSTURES
from geometries.scene.writer import canonical
from geometries.studies import study
from tests import scenes
from tests.bad_input import meshes
from tests.by_night import all_but
from tests.fuzz.compare_readers import scene_roles

SENSOR = scenes.sensor(
    "front",
    [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]],
    [[0.1, -0.05, 0.02], [0, 0.03, 0.04], [0.2, 0, 0]],
)
LINKS = """
[[link]]
name = "arm"
parent = "room"
translation = [0.3, -0.2, 0.5]
rotation = { axis = [1, 2, -3], degrees = 77.7 }
[[link]]
name = "hand"
parent = "arm"
quaternion = [0.3, -0.4, 0.5, 2]
joint = { name = "wrist", type = "revolute", axis = [1, -2, 0.5], position = 1.1 }
[[link]]
name = "room"
translation = [1, 2, 3]
rotation = { quaternion = [1, 0, 0, 1] }
joint = { name = "slide", type = "prismatic", axis = [1, 1, 0], mimic = { joint = "wrist", multiplier = -0.2, offset = 3 } }
"""
SHAPES = {
    "plate": 'type = "plate", size = [0.073, 0.119]',
    "plane": 'type = "plane", size = [0.1, 0.2]',
    "cube": 'type = "cube", size = 0.05',
    "cuboid": 'type = "cuboid", size = [0.01, 0.02, 0.03]',
    "box": 'type = "box", size = [0.01, 0.02, 0.03]',
    "cylinder": 'type = "cylinder", radius = 0.03, height = 0.1',
    "cylinder of 5": 'type = "cylinder", radius = 0.03, height = 0.1, segments = 5',
    "cone": 'type = "cone", radius = 0.03, height = 0.1, segments = 7',
    "arc": 'type = "arc", inner_radius = 0.03, outer_radius = 0.04, height = 0.1, degrees = 100',
    "ring": 'type = "arc", inner_radius = 0.03, outer_radius = 0.04, height = 0.1, degrees = 360, segments = 9',
    "sphere": 'type = "sphere", radius = 0.05',
    "sphere of 3": 'type = "sphere", radius = 0.05, segments = 3',
    "sphere of 5": 'type = "sphere", radius = 0.05, segments = 5',
    "ellipsoid": 'type = "ellipsoid", semi_axes = [0.05, 0.02, 0.03], segments = 7',
    "capsule": 'type = "capsule", radius = 0.03, length = 0.1',
    "capsule of 3": 'type = "capsule", radius = 0.03, length = 0.1, segments = 3',
    "rounded": 'type = "box", size = [0.1, 0.2, 0.3], rounding = 0.02, segments = 13',
    "stadium": 'type = "cuboid", size = [0.1, 0.2, 0.3], rounding = 0.05, segments = 8',
    "not rounded": 'type = "cuboid", size = [0.1, 0.2, 0.3], rounding = 0',
    "rounded to a capsule": 'type = "cuboid", size = [0.1, 0.2, 0.1], rounding = 0.05, segments = 8',
    "rounded to a ball": 'type = "cuboid", size = [0.1, 0.1, 0.1], rounding = 0.05, segments = 8',
    "disc": 'type = "disc", radius = 0.03, segments = 9',
    "polygon": 'type = "polygon", vertices = [[0, 0], [0.2, 0], [0.2, 0.2], [0.1, 0.2], [0.1, 0.1], [0, 0.1]]',
    "clockwise": 'type = "polygon", vertices = [[0, 0.1], [0.1, 0.13], [0.1, 0.2], [0.2, 0.2], [0.2, 0], [0.1, 0]]',
    "person": 'type = "person", height = 1.75',
    "obj": 'type = "mesh", file = "body.obj", scale = 0.001',
    "stl": 'type = "mesh", file = "body.stl"',
    "ply": 'type = "mesh", file = "body.ply", scale = 2',
}
SHAPES |= {
    f"{age}, {posture}": f'type = "person", height = 1.2, age = "{age}", posture = "{posture}"'
    for age, posture in product(BUILDS, POSTURES)
}
_TURNS = np.linspace(0, 2 * np.pi, 30, endpoint=False)
_RADII = np.random.default_rng(1).uniform(0.02, 0.2, 30)
_STAR = np.column_stack([_RADII * np.cos(_TURNS), _RADII * np.sin(_TURNS)]).tolist()
SHAPES["star"] = f'type = "polygon", vertices = {_STAR}'
POSES = {
    "as it is": "",
    "rotated": "translation = [0.1, -0.2, 0.3]\nrotation = { axis = [1, 1, 0], degrees = 17.2 }",
    "turned by a quaternion": "quaternion = [1, 2, 3, 4]",
    "on a link": 'link = "hand"\ntranslation = [0.1, 0, 0]\nrotation = { axis = [0, 1, 0], degrees = -250 }',
}
# A square, a pentagon and two triangles, so that polygons have to be cut in the same way.
MIXED: list[meshes.Point] = [(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0), (5, 15, 1), (2, 3, 9.5)]
MIXED_FACES = [(0, 1, 2, 3), (0, 1, 2, 4, 3), (0, 1, 5), (2, 1, 5)]
# In the planes of the axes and across them: an arrowhead, a comb, a square around a hole, a bow tie, one that is bent, one with corners
# in the middle of sides, and one whose outline touches its first corner from within.
POLYGONS = (
    [(2, 0, 0), (1, 0.25, 0), (1, 2, 0), (0, 0, 0)],
    [(0, 0, 0), (0, 4, 1), (0, 4, 4), (0, 0, 4), (0, 0, 3), (0, 3, 3), (0, 3, 1), (0, 0, 1)],
    [
        (0, 1, 0),
        (0, 1, 4),
        (4, 1, 4),
        (4, 1, 0),
        (0, 1, 0),
        (1, 1, 1),
        (3, 1, 1),
        (3, 1, 3),
        (1, 1, 3),
        (1, 1, 1),
    ],
    [(0, 0, 5), (1, 1, 6), (1, 0, 6), (0, 1, 5)],
    [(0, 0, 7), (0.3, 0.1, 7.2), (1, 0, 7.1), (0.1, 1, 7.3), (0, 0.7, 6)],
    [(0, 0, 8), (1, 0, 8), (2, 0, 8), (2, 2, 8), (1, 2, 8), (0, 2, 8)],
    [(0, 0, 9), (4, 0, 9), (4, 4, 9), (0, 4, 9), (0, 0, 9), (1, 2, 9), (2, 2, 9), (2, 1, 9)],
)
# Binary fractions: in a mesh file the model's reader keeps seven digits of a decimal number.
TRIANGLES: list[meshes.Point] = [
    (0, 0, 0),
    (0.75, 0, 0),
    (0, 0.75, 0),
    (0, 0, 0.25),
    (0.75, 0, 0),
    (0, 0.5, 0.125),
]
CONSTRUCTED, SINGLE_PRECISION = 1e-12, 2e-7


def assert_same_conductors(path: Path, tolerance: float = CONSTRUCTED) -> None:
    here, there = reader.load(path).conductors(), model_module().Scene.load(str(path)).conductors()
    assert list(here) == list(there)
    for name, triangles in here.items():
        size = np.ptp(triangles.reshape(-1, 3), axis=0).max()
        reach = np.abs(triangles).max()
        assert there[name].shape == triangles.shape
        assert np.abs(there[name] - triangles).max() <= tolerance * max(size, reach)


def assert_same_canonically(folder: Path) -> None:
    """Of the scene's canonical text, which means the same."""
    scene = reader.load(folder / "scene.toml")
    (folder / "canonical.toml").write_text(canonical(scene))
    assert reader.load(folder / "canonical.toml") == scene
    assert_same_conductors(folder / "canonical.toml")


def assert_same_roles(path: Path) -> None:
    assert scene_roles(reader.load(path)) == model_module().Scene.load(str(path)).roles()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "body.obj").write_text(meshes.obj(MIXED, MIXED_FACES))
    (tmp_path / "body.stl").write_text(meshes.ascii_stl(TRIANGLES, [(0, 1, 2), (3, 4, 5)]))
    (tmp_path / "body.ply").write_text(meshes.ply(TRIANGLES, [(0, 1, 2), (3, 4, 5)], "double"))
    return tmp_path


# A shape knows nothing of its pose: by day each has one of them here, and that on the link below.
@pytest.mark.parametrize("placed", all_but(list(zip(SHAPES, cycle(POSES))), product(SHAPES, POSES)), ids=str)
def test_every_shape_in_every_pose(folder: Path, placed: tuple[str, str]) -> None:
    shape, pose = placed
    body = f'[[object]]\nname = "body"\nshape = {{ {SHAPES[shape]} }}\n{POSES[pose]}\n'
    (folder / "scene.toml").write_text(SENSOR + LINKS + body)
    assert_same_conductors(folder / "scene.toml")


@pytest.mark.parametrize("shape", SHAPES)
def test_every_shape_in_millimetres(folder: Path, shape: str) -> None:
    body = f'[[object]]\nname = "body"\nshape = {{ {SHAPES[shape]} }}\n{POSES["on a link"]}\n'
    (folder / "scene.toml").write_text('units = "mm"\n' + SENSOR + LINKS + body)
    assert_same_conductors(folder / "scene.toml")
    assert_same_canonically(folder)


def test_squared_plates_have_the_same_bits(folder: Path) -> None:
    random = np.random.default_rng(7)
    plates = []
    for _ in range(300):
        frame, scale = np.linalg.qr(random.normal(size=(3, 3)))[0], 10 ** random.uniform(-4, 1, 2)
        lean = random.choice([-1, 1]) * 10 ** random.uniform(-8.5, -4.1)
        u, v = scale[0] * frame[0], scale[1] * (frame[1] + lean * frame[0])
        plates.append(f"{{ corner = [0, 0, 0], edge_u = {u.tolist()}, edge_v = {v.tolist()} }}")
    (folder / "scene.toml").write_text(f'[[sensor]]\nname = "front"\nplates = [{", ".join(plates)}]\n')
    here, there = reader.load(folder / "scene.toml"), model_module().Scene.load(str(folder / "scene.toml"))
    assert np.array_equal(here.conductors()["front"], there.conductors()["front"])
    assert len(here.changes) == 300
    assert list(here.changes) == there.remarks == remarks(here)


@pytest.mark.parametrize(
    "objects",
    [
        scenes.body("hand", "mesh", file="body.obj", translation=[0, 0, 1]),
        scenes.body("hand", "mesh", file="body.obj", scale=100),
        scenes.body("hand", "mesh", file="inward.obj"),
        scenes.body("hand", "mesh", file="twice.obj"),
        scenes.body("arm", "cube", size=30)
        + "".join(scenes.body(name, "sphere", radius=1) for name in "abcde"),
        scenes.body("ring", "arc", inner_radius=0.05, outer_radius=0.06, height=0.1, degrees=360)
        + scenes.body("ball", "sphere", radius=0.01, translation=[0, 0, 0]),
    ],
)
def test_both_make_the_same_remarks(folder: Path, objects: str) -> None:
    tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    (folder / "inward.obj").write_text(tetrahedron + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n")
    (folder / "twice.obj").write_text(tetrahedron + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 1 2\nf 3 2 1\n")
    for units in ("", 'units = "mm"\n'):
        (folder / "scene.toml").write_text(units + SENSOR + objects)
        found = remarks(reader.load(folder / "scene.toml"))
        assert found == model_module().Scene.load(str(folder / "scene.toml")).remarks
        assert found or "translation" in objects


@pytest.mark.parametrize("shape", ["obj", "stl", "ply"])
def test_mesh_files_with_decimal_coordinates_agree_to_single_precision(folder: Path, shape: str) -> None:
    for name in ("body.obj", "body.stl", "body.ply"):
        (folder / name).write_text((folder / name).read_text().replace("0.75", "0.1").replace("9.5", "9.7"))
    body = f'[[object]]\nname = "body"\nshape = {{ {SHAPES[shape]} }}\n'
    (folder / "scene.toml").write_text(SENSOR + body)
    assert_same_conductors(folder / "scene.toml", SINGLE_PRECISION)


@pytest.mark.parametrize("suffix", ["obj", "ply"])
def test_polygons_are_divided_alike_and_have_the_same_remarks(folder: Path, suffix: str) -> None:
    random = np.random.default_rng(3)
    frames = [np.eye(3), *(np.linalg.qr(random.normal(size=(3, 3)))[0] for _ in range(20))]
    faces = [np.array(face) @ frame for frame in frames for face in POLYGONS]
    faces += [random.normal(size=(n, 3)) * [1, 1, flat] for n in range(4, 12) for flat in (1, 0.1, 0)]
    points, ends = np.concatenate(faces), np.cumsum([len(face) for face in faces])
    corners = [list(range(end - len(face), end)) for face, end in zip(faces, ends)]
    given = (points.tolist(), corners)
    text = meshes.obj(*given) if suffix == "obj" else meshes.ply(*given, "double")
    (folder / f"faces.{suffix}").write_text(text)
    (folder / "scene.toml").write_text(
        SENSOR + scenes.body("body", "mesh", file=f"faces.{suffix}", scale=0.01)
    )
    here, there = reader.load(folder / "scene.toml"), model_module().Scene.load(str(folder / "scene.toml"))
    assert np.array_equal(here.conductors()["body"], there.conductors()["body"])
    assert len(here.changes) == 2 and remarks(here) == there.remarks


def test_sensors_on_links(folder: Path) -> None:
    (folder / "scene.toml").write_text(SENSOR + 'link = "hand"\n' + LINKS)
    assert_same_conductors(folder / "scene.toml")


def test_a_room_is_read_by_both_and_moves_nothing(folder: Path) -> None:
    room = "[room]\nsize = [9, 8, 7]\ntranslation = [0, 0, 1]\nrotation = { axis = [0, 0, 1], degrees = 5 }\n"
    (folder / "scene.toml").write_text(room + SENSOR + LINKS)
    assert_same_conductors(folder / "scene.toml")
    assert_same_canonically(folder)


def test_a_motion_puts_the_links_in_the_same_places() -> None:
    path = Path(reader.__file__).parents[1] / "scenes" / "x_ray_arm.toml"
    motion_file = path.with_suffix(".motion.toml")
    live, frames = model_module().Scene.load(str(path)), motion.load(motion_file, reader.load(path))
    poses = np.tile(np.eye(4), (len(frames), len(live.links), 1, 1))
    for frame, of_links in zip(frames, poses, strict=True):
        for link, matrix in zip(live.links, of_links, strict=True):
            matrix[:3, :3], matrix[:3, 3] = frame.poses[link].rotation.matrix(), frame.poses[link].translation
    found, expected = (live.readings_of(moved, "exact").change for moved in (str(motion_file), poses))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_the_canonical_text_of_every_default_case(folder: Path) -> None:
    for case in study.load(study.find("default")).cases():
        (folder / "scene.toml").write_text(canonical(case.scene))
        assert_same_conductors(folder / "scene.toml")


def object_of(name: str, more: str) -> str:
    return f'[[object]]\nname = "{name}"\nshape = {{ type = "cube", size = 1 }}\n{more}\n'


FLOATING = 'potential = "floating"\nconductor = "body"\n'


def reading_of(sense: str, *drive: str) -> str:
    return f'[[reading]]\nname = "r"\nsense = "{sense}"\ndrive = {list(drive)}\n'


def polygon(vertices: str) -> str:
    return f'[[object]]\nname = "o"\nshape = {{ type = "polygon", vertices = {vertices} }}\n'


GLASS = "material = { relative_permittivity = 2 }\n"
ELECTRODE = 'potential = "electrode"\n'
ON_HAND = 'link = "hand"\n'
SIDE = SENSOR.replace("front", "side") + ON_HAND
ROUND_PLATE = '[[sensor]]\nname = "round"\nplates = [ { centre = [0, 0, 0], radius = 0.1 } ]\n'
READING = '[[reading]]\nname = "r"\n'
ELEVEN = "".join(SENSOR.replace("front", str(k)) for k in range(11))
MEETS = "(from vertex 0) meets edge {}: the outline must not cross or touch itself"
# Each row has what the scene has beside its sensor, and the reason that both readers give.
REFUSED = [
    (object_of("a", 'conductor = ""'), 'object "a": conductor: must not be empty'),
    (
        object_of("a", 'conductor = "arm"') + object_of("b", 'conductor = "arm"\n' + ELECTRODE),
        'object "b": conductor: one conductor has one potential, but "a" is grounded and "b" is electrode',
    ),
    (object_of("a", 'conductor = "front"'), 'object "a": conductor: "front" is the name of a sensor'),
    (
        object_of("a", 'conductor = "b"') + object_of("b", 'conductor = "arm"'),
        'object "a": conductor: "b" is the name of an object outside this conductor',
    ),
    (object_of("a", 'conductor = "arm"\n' + GLASS), 'object "a": material: cannot be combined with conductor'),
    (object_of("a", 'potential = "high"'), 'object "a": potential: must be "grounded", "floating" or "electrode"'),
    (object_of("a", "to_ground = 1e-10"), 'object "a": to_ground: is a key of floating objects, and this one is grounded'),
    (object_of("a", GLASS + "to_ground = 1e-10"), 'object "a": material: cannot be combined with to_ground'),
    (
        object_of("a", FLOATING + "to_ground = 1e-10") + object_of("b", FLOATING + "to_ground = 2e-10"),
        'object "b": to_ground: one conductor has one capacitance to ground, but "a" and "b" differ',
    ),
    (object_of("a", ELECTRODE + "target = true"), 'object "a": target: an electrode cannot be a target'),
    (
        LINKS + SIDE + object_of("a", ON_HAND + "target = true"),
        'object "a": target: a target cannot carry a sensor, but its link carries "side"',
    ),
    (
        object_of("a", FLOATING + "target = true") + object_of("b", FLOATING),
        'object "b": target: all objects of a floating conductor are targets or none is, but "a" is and "b" is not',
    ),
    (
        object_of("a", FLOATING) + object_of("b", FLOATING + "target = true"),
        'object "b": target: all objects of a floating conductor are targets or none is, but "b" is and "a" is not',
    ),
    (object_of("a", ELECTRODE + "to_ground = 1e-10"), 'object "a": to_ground: is a key of floating objects, and this one is electrode'),
    (
        ROUND_PLATE,
        "plates[0].corner: is missing: a plate is a rectangle with corner, edge_u and edge_v; an electrode of another shape is an object "
        'with potential = "electrode"',
    ),
    (READING + 'drive = ["front"]', 'reading "r": sense: is missing'),
    (READING + 'sense = "front"', 'reading "r": drive: is missing'),
    (READING + 'sense = "front"\ndrive = "front"\n', 'reading "r": drive: must be a list of strings'),
    (reading_of("front"), 'reading "r": drive: must not be empty'),
    (reading_of("front", "front", "front"), 'reading "r": drive: "front" is named twice'),
    (
        object_of("a", FLOATING) + reading_of("a", "front"),
        'reading "r": sense: "a" is neither a sensor nor the conductor of an electrode; the scene has "front"',
    ),
    (
        object_of("a", ELECTRODE + 'conductor = "guard"') + reading_of("front", "a"),
        'reading "r": drive: "a" is neither a sensor nor the conductor of an electrode; the scene has "front", "guard"',
    ),
    (ELEVEN + reading_of("x", "0"), 'the scene has "front", "0", "1", "2", "3", "4", "5", "6", "7", "8" and 2 more'),
    (polygon("[[0, 0], [1, 0]]"), 'object "o": shape.vertices: must have 3 to 500 vertices, not 2'),
    (polygon("[[0, 0], [1, 0], [1, 1], [1, 0]]"), 'object "o": shape.vertices: vertex 3 repeats vertex 1'),
    (polygon("[[0, 0], [1, 1], [2, 2]]"), 'object "o": shape.vertices: the vertices lie on a line, and enclose no area'),
    (polygon("[[0, 0], [1, 1], [1, 0], [0, 1]]"), f'object "o": shape.vertices: edge 0 {MEETS.format(2)}'),
    (polygon("[[0, 0], [2, 0], [2, 1], [1, 0], [0, 1]]"), f'object "o": shape.vertices: edge 0 {MEETS.format(2)}'),
    (polygon("[[0, 0], [2, 0], [1, 0], [0, 1]]"), f'object "o": shape.vertices: edge 0 {MEETS.format(1)}'),
]  # fmt: skip


@pytest.mark.parametrize(("objects", "message"), REFUSED)
def test_both_refuse_with_the_same_words(folder: Path, objects: str, message: str) -> None:
    path = folder / "scene.toml"
    path.write_text(SENSOR + objects)
    for load in (reader.load, lambda path: model_module().Scene.load(str(path))):
        with pytest.raises(ValueError) as refused:
            load(path)
        assert str(refused.value).endswith(f" {message}")


@pytest.mark.parametrize(
    "objects",
    [
        object_of("a", FLOATING + "to_ground = 1e-10\ntarget = true") + object_of("b", ELECTRODE),
        object_of("a", GLASS) + object_of("b", ELECTRODE),
        object_of("a", ELECTRODE + 'conductor = "b"') + reading_of("b", "front", "b") + "noise = 3.3e-16\n",
        object_of("a", 'conductor = "c"\ntarget = true') + object_of("b", 'conductor = "c"'),
        reading_of("front", "front") + "noise = 1e-15\nthreshold = 1e-13\n",
        "".join(object_of(name, ELECTRODE + 'conductor = "arm"') for name in ("a", "arm"))
        + object_of("b", ELECTRODE),
        "cover = { thickness = 2, relative_permittivity = 3 }\n" + object_of("hand", ""),
    ],
)
def test_roles_of_objects_readings_and_covers_are_read_by_both(folder: Path, objects: str) -> None:
    (folder / "scene.toml").write_text('units = "mm"\n' + SENSOR + objects)
    (folder / "canonical.toml").write_text(canonical(reader.load(folder / "scene.toml")))
    assert reader.load(folder / "canonical.toml") == reader.load(folder / "scene.toml")
    for name in ("scene.toml", "canonical.toml"):
        assert_same_roles(folder / name)
        # To the model dielectric bodies are conductors, too.
        if "permittivity" not in objects:
            assert_same_conductors(folder / name)


def test_the_example_with_readings_is_read_by_both() -> None:
    example = Path(reader.__file__).parents[1] / "scenes" / "guarded_sensor.toml"
    assert_same_conductors(example)
    assert_same_roles(example)
    assert [
        name for name, role in scene_roles(reader.load(example))["objects"].items() if role["target"]
    ] == ["hand"]
