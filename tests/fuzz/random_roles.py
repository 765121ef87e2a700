"""Scenes of few names and many roles, right and wrong: what spoiling a file at random hardly ever makes of it."""

from __future__ import annotations

import random

_LINKS = '[[link]]\nname = "arm"\n[[link]]\nname = "leg"\n'
_PLATE = "{ corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }"
_SENSORS, _OBJECTS = ("front", "back"), ("bar", "rod", "hand")
# The conductors are named so, and now and then like a sensor or an object.
_CONDUCTORS = ("guard", "body")
_POTENTIALS = ("grounded", "floating", "floating", "electrode")


def scene(chance: random.Random) -> bytes:
    """A scene, as the contents of its file, that both readers have to refuse or to read alike."""
    parts = [_LINKS]
    parts += [_sensor(name, chance) for name in _SENSORS[: chance.randrange(3)]]
    parts += [_object(name, chance) for name in _OBJECTS[: chance.randrange(4)]]
    parts += [_reading(chance.choice("pqrs"), chance) for _ in range(chance.randrange(3))]
    return "".join(parts).encode()


def _sensor(name: str, chance: random.Random) -> str:
    link = chance.choice(("", 'link = "arm"\n'))
    return f'[[sensor]]\nname = "{name}"\nplates = [{_PLATE}]\n{link}'


def _object(name: str, chance: random.Random) -> str:
    text = f'[[object]]\nname = "{name}"\nshape = {{ type = "cube", size = 1 }}\n'
    potential = chance.choice(_POTENTIALS)
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
