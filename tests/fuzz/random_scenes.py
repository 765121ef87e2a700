"""Random scenes and motions: of every kind of body, through contact and back, for every method; and of few names and many roles, right and wrong, for both readers."""

import math
import random
from dataclasses import dataclass

_POTENTIALS = ("grounded", "grounded", "floating", "electrode")
_PERMITTIVITIES = (1.0, 1.0000000001, 1.5, 3.0, 80.0, 1e6)
_SHEETS = ("plate", "disc", "polygon")
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class RandomScene:
    """The text of a scene file, its movable links, and poses of these that follow each other: translations and degrees about an axis."""

    text: str
    links: tuple[str, ...]
    frames: tuple[tuple[tuple[Vector, Vector, float], ...], ...]


def scene(chance: random.Random) -> RandomScene:
    """Returns a scene of a few bodies about as large as each other, some of them on links that move."""
    size = 10.0 ** chance.choice((-1, -1, -1, -1, -6, -12, 3, 9))
    links = ("hand", "arm")[: chance.choice((0, 1, 1, 1, 2))]
    parts = ["".join(f'[[link]]\nname = "{link}"\n' for link in links)]
    if chance.random() < 0.2:
        parts.append(f"[medium]\nrelative_permittivity = {chance.choice((2.0, 3.0, 80.0))}\n")
    sensors = [f"sensor {k}" for k in range(chance.choice((0, 1, 1, 1, 2)))]
    parts += [_sensor(name, size, links, chance) for name in sensors]
    objects, electrodes = [], []
    for k in range(chance.choice((1, 1, 2, 2, 3, 4) if sensors else (1, 2, 2, 3))):
        text, is_electrode = _object(f"object {k}", size, links, chance)
        objects.append(text)
        electrodes += [f"object {k}"] if is_electrode else []
    parts += objects
    if (sensors or electrodes) and chance.random() < 0.4:
        driven = sensors + electrodes
        for k in range(chance.choice((1, 2))):
            parts.append(
                f'[[reading]]\nname = "reading {k}"\nsense = "{chance.choice(driven)}"\ndrive = ["{chance.choice(driven)}"]\n'
            )
    frames = tuple(
        tuple(_pose(size, chance) for _ in links) for _ in range(chance.choice((1, 2, 4, 8)) if links else 1)
    )
    return RandomScene("".join(parts), links, frames)


def _pose(size: float, chance: random.Random) -> tuple[Vector, Vector, float]:
    # Through others, just clear of them, and far away; now and then as far as numbers reach.
    reach = size * chance.choice((0.0, 0.3, 0.6, 1.0, 1.0, 1.5, 3.0, 100.0))
    if chance.random() < 0.02:
        reach = 10.0 ** chance.uniform(3, 30)
    return (
        _direction(chance, reach),
        _direction(chance, 1),
        chance.choice((0.0, 0.0, 90.0, chance.uniform(0, 360))),
    )


def _direction(chance: random.Random, length: float) -> Vector:
    while True:
        x, y, z = (chance.uniform(-1, 1) for _ in range(3))
        norm = math.sqrt(x * x + y * y + z * z)
        if 0.1 < norm:
            return length * x / norm, length * y / norm, length * z / norm


def _on_link(links: tuple[str, ...], chance: random.Random, share: float) -> str:
    return f'link = "{chance.choice(links)}"\n' if links and chance.random() < share else ""


def _sensor(name: str, size: float, links: tuple[str, ...], chance: random.Random) -> str:
    place = 0.0 if name == "sensor 0" else 1.5 * size
    a, b = size * chance.choice((0.2, 0.6)), size * chance.choice((0.01, 0.4))
    text = (
        f'[[sensor]]\nname = "{name}"\n{_on_link(links, chance, 0.2)}'
        f"plates = [ {{ corner = [{place}, 0, 0], edge_u = [{a}, 0, 0], edge_v = [0, {b}, 0] }} ]\n"
    )
    if chance.random() < 0.15:
        text += f"cover = {{ thickness = {size * chance.choice((1e-3, 0.02))}, relative_permittivity = {chance.choice((1.0, 3.0))} }}\n"
    return text


def _object(name: str, size: float, links: tuple[str, ...], chance: random.Random) -> tuple[str, bool]:
    kind, shape = _shape(size * chance.choice((0.1, 0.5, 1.0, 1.0)), chance)
    x, y, z = _direction(chance, size * chance.choice((0.0, 0.5, 0.8, 1.2, 1.2, 2.0, 3.0)))
    text = f'[[object]]\nname = "{name}"\nshape = {shape}\ntranslation = [{x}, {y}, {z}]\n'
    if chance.random() < 0.3:
        axis = _direction(chance, 1)
        text += f"rotation = {{ axis = {list(axis)}, degrees = {chance.uniform(0, 360)} }}\n"
    potential = chance.choice(_POTENTIALS)
    is_dielectric = kind not in _SHEETS and chance.random() < 0.25
    if is_dielectric:
        text += f"material = {{ relative_permittivity = {chance.choice(_PERMITTIVITIES)} }}\n"
    else:
        text += f'potential = "{potential}"\n'
        if potential == "floating" and chance.random() < 0.5:
            text += f"to_ground = {chance.choice((1e-14, 1e-10))}\n"
    on_link = _on_link(links, chance, 0.6)
    is_electrode = not is_dielectric and potential == "electrode"
    if not is_electrode and chance.random() < 0.4:
        text += "target = true\n"
    return text + on_link, is_electrode


def _shape(size: float, chance: random.Random) -> tuple[str, str]:
    flat = size * chance.choice((1e-3, 0.05, 0.3, 1.0))
    segments = chance.choice((3, 8, 12, 24, 48, 128))
    kinds = {
        "plate": f"size = [{size}, {flat}]",
        "cuboid": f"size = [{size}, {size * 0.7}, {flat}]",
        "cube": f"size = {size}",
        "cylinder": f"radius = {size / 2}, height = {flat}, segments = {segments}",
        "cone": f"radius = {size / 2}, height = {flat}, segments = {segments}",
        "arc": f"inner_radius = {size / 4}, outer_radius = {size / 2}, height = {flat}, degrees = {chance.choice((90, 360))}, segments = {segments}",
        "sphere": f"radius = {size / 2}, segments = {segments}",
        "ellipsoid": f"semi_axes = [{size / 2}, {size / 3}, {flat / 2}], segments = {segments}",
        "capsule": f"radius = {size / 5}, length = {size}, segments = {segments}",
        "box": f"size = [{size}, {size * 0.7}, {size * 0.4}], rounding = {size * chance.choice((0.0, 0.05, 0.2))}, segments = {segments}",
        "disc": f"radius = {size / 2}, segments = {segments}",
        "polygon": f"vertices = [[0, 0], [{size}, 0], [{size / 3}, {size / 3}], [0, {size}]]",
        "person": f"height = {size}",
    }
    kind = chance.choice(sorted(kinds))
    return kind, f'{{ type = "{kind}", {kinds[kind]} }}'


_LINKS = '[[link]]\nname = "arm"\n[[link]]\nname = "leg"\n'
_PLATE = "{ corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }"
_SENSORS, _OBJECTS = ("front", "back"), ("bar", "rod", "hand")
# The conductors are named so, and now and then like a sensor or an object.
_CONDUCTORS = ("guard", "body")
_POTENTIALS_OF_ROLES = ("grounded", "floating", "floating", "electrode")


def scene_of_roles(chance: random.Random) -> bytes:
    """A scene, as the contents of its file, that both readers have to refuse or to read alike."""
    parts = [_LINKS]
    parts += [_plain_sensor(name, chance) for name in _SENSORS[: chance.randrange(3)]]
    parts += [_object_of_role(name, chance) for name in _OBJECTS[: chance.randrange(4)]]
    parts += [_reading(chance.choice("pqrs"), chance) for _ in range(chance.randrange(3))]
    return "".join(parts).encode()


def _plain_sensor(name: str, chance: random.Random) -> str:
    link = chance.choice(("", 'link = "arm"\n'))
    return f'[[sensor]]\nname = "{name}"\nplates = [{_PLATE}]\n{link}'


def _object_of_role(name: str, chance: random.Random) -> str:
    text = f'[[object]]\nname = "{name}"\nshape = {{ type = "cube", size = 1 }}\n'
    potential = chance.choice(_POTENTIALS_OF_ROLES)
    if chance.random() < 0.1:
        text += "material = { relative_permittivity = 2 }\n"
    elif chance.random() < 0.8:
        text += f'potential = "{potential}"\n'
    if chance.random() < 0.5:
        taken = chance.random() < 0.2
        text += f'conductor = "{chance.choice(_SENSORS + _OBJECTS if taken else _CONDUCTORS)}"\n'
    if chance.random() < (0.7 if potential == "floating" else 0.05):
        text += f"to_ground = {chance.choice(('1e-10', '1e-10', '1e-10', '2e-10', '0'))}\n"
    if chance.random() < 0.4:
        text += f"target = {chance.choice(('true', 'true', 'false'))}\n"
    return text + (f'link = "{chance.choice(("arm", "leg"))}"\n' if chance.random() < 0.3 else "")


def _reading(name: str, chance: random.Random) -> str:
    names = _SENSORS + _CONDUCTORS + (_OBJECTS if chance.random() < 0.2 else ())
    text = f'[[reading]]\nname = "{name}"\nsense = "{chance.choice(names)}"\n'
    text += f"drive = {[chance.choice(names) for _ in range(chance.choice((1, 1, 2, 2, 0)))]}\n"
    if chance.random() < 0.3:
        text += f"noise = {chance.choice(('3.3e-16', '1e-15', '0'))}\n"
    return text + ("threshold = 5e-14\n" if chance.random() < 0.3 else "")
