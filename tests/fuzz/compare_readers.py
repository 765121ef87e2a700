"""`python3 -m tests.fuzz.compare_readers SECONDS [SEED]`: spoils scenes and meshes at random, until the time is up, and gives each to
both readers. They must refuse the same, in their own way, and read the same triangles, roles of objects and readings from the rest.

What they disagree about is printed, and kept in build/disagreements. Seeds are the scenes and meshes of the fuzzers; a fifth of the
files are scenes with random roles of their objects and random readings instead.
"""

import argparse
import random
import re
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.pipeline.model_stage import model_module
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.readings import readings, targets
from geometries.scene.scene import Scene
from tests.bad_input.case import SENSOR, mesh_body
from tests.fuzz import random_scenes, seeds

KEPT = Path(__file__).resolve().parents[2] / "build" / "disagreements"
# Share of the files that are scenes of random roles instead of spoilt ones.
_MADE = 0.2
WORDS = [
    b"0", b"-1", b"+1", b"00", b"--1", b".5", b"1.", b"1e5", b"1e+5", b"1e999", b"1e-400", b"1d5", b"0x1", b"1_0", b"0.125f", b"nan",
    b"inf", b"Infinity", b"4294967296", b"18446744073709551616", b"true", b'"', b"'", b'""', b'"body"', b"=", b",", b".", b"#", b"[",
    b"]", b"[[", b"]]", b"{", b"}", b" ", b"\t", b"\n", b"\r", b"\r\n", b"\\", b"\\\n", b"\0", b"\x0b", b"\x0c", b"\x1c", b"\x85", b"\xa0",
    b"\xff", b"\xc3\xa9", b"\xe2\x80\xa8", b"/", b"//", b"solid", b"endsolid", b"vertex", b"comment x\n", b"element face 1\n",
    b"property list uchar int vertex_index\n", b"v 1 2 3\n", b"v 1 2\n", b"v 1 2 3 4\n", b"f 1 2 3\n", b"f 1 2\n", b"p 1\n", b"l 1 2\n",
    b"name", b"link", b"size", b"radius", b"translation", b"rotation", b"shape", b"type", b"2020-01-01",
    b"potential", b'"floating"', b'"electrode"', b"conductor", b'conductor = "body"\n', b'potential = "electrode"\n',
    b"joint", b"mimic", b'"revolute"', b'"prismatic"', b"axis", b"position", b"multiplier", b"upper",
    b'mimic = { joint = "elbow" }', b"position = 1e30,",
    b"units", b'units = "mm"\n', b'"m"', b'"mm"', b"collides_with_parent = true\n", b"edge_v = [1e-6, 0.1, 0]",
    b"to_ground", b"to_ground = 1e-10\n", b"target", b"target = true\n", b"target = false\n", b"sense", b"drive", b"noise", b"threshold",
    b'"front"', b'"guard"', b'["front", "guard"]', b'[[reading]]\nname = "r"\nsense = "front"\ndrive = ["front"]\n',
]  # fmt: skip


@dataclass(frozen=True)
class Seed:
    """A file to be spoiled: a scene, or a mesh that a scene names."""

    suffix: str
    content: bytes


def sound_seeds(folder: Path) -> list[Seed]:
    """Those of the fuzzers' that are read: little is learned from what is wrong already."""
    meshes = [Seed(seeds.READERS[content[0]], content[1:]) for content in seeds.mesh_files()]
    found = meshes + [Seed(".toml", content) for content in seeds.scenes()]
    return [seed for seed in found if _is_read(seed, folder)]


def _is_read(seed: Seed, folder: Path) -> bool:
    try:
        return bool(reader.load(_written(seed.suffix, seed.content, folder)).conductors())
    except InputError:
        return False


def _written(suffix: str, content: bytes, folder: Path) -> Path:
    scene = folder / "scene.toml"
    if suffix == ".toml":
        scene.write_bytes(content)
    else:
        (folder / f"mesh{suffix}").write_bytes(content)
        scene.write_text(SENSOR + mesh_body(f"mesh{suffix}"))
    return scene


def spoiled(content: bytes, chance: random.Random) -> bytes:
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 5))):
        at = chance.randrange(len(data) + 1)
        match chance.randrange(6):
            case 0:
                del data[at : at + chance.randrange(1, 4)]
            case 1:
                data[at:at] = chance.choice(WORDS)
            case 2:
                data[at : at + 1] = bytes([chance.randrange(256)])
            case 3:
                start = chance.randrange(len(data) + 1)
                data[at:at] = data[start : start + chance.randrange(60)]
            case 4:
                words = list(re.finditer(rb"[^\s=,\[\]{}]+", bytes(data)))
                if words:
                    word = chance.choice(words)
                    data[word.start() : word.end()] = chance.choice(WORDS)
            case 5 if chance.random() < 0.2:
                del data[at:]
    return bytes(data)


def disagreement(seed: Seed, content: bytes, folder: Path) -> str:
    """What the readers say of a file when they do not agree, else nothing."""
    scene = _written(seed.suffix, content, folder)
    told, here = "", None
    try:
        here = reader.load(scene)
        surfaces = here.conductors()
    except InputError as error:
        told = f"the analysis' reader: {error}"
    try:
        there = model_module().Scene.load(str(scene))
    except ValueError as error:
        return "" if told else f"only the model's reader: {error}"
    if here is None or told:
        return f"only {told}"
    others = there.conductors()
    if differing := [name for name, triangles in surfaces.items() if not _same(triangles, others.get(name))]:
        return f"different triangles: {', '.join(differing)}"
    roles, roles_there = scene_roles(here), there.roles()
    return "" if roles == roles_there else f"different roles: {roles} and {roles_there}"


def scene_roles(scene: Scene) -> dict[str, Any]:
    """What the objects are to the readings, and the readings, as the model's `Scene.roles` describes them."""
    objects = {
        body.name: {
            "potential": body.potential if body.relative_permittivity is None else "dielectric",
            "relative_permittivity": body.relative_permittivity,
            "conductor": body.conductor or body.name,
            "to_ground": body.to_ground or None,
            "target": target,
        }
        for body, target in zip(scene.objects, targets(scene), strict=True)
    }
    measured = {
        reading.name: {
            "sense": reading.sense,
            "drive": list(reading.drive),
            "noise": reading.noise,
            "threshold": reading.threshold,
        }
        for reading in readings(scene)
    }
    return {"objects": objects, "readings": measured}


def _same(here: np.ndarray, there: np.ndarray | None) -> bool:
    if there is None or here.shape != there.shape:
        return False
    return not here.size or bool(np.abs(here - there).max() <= 1e-12 * np.abs(here).max())


def compare(count: int | None, seconds: float, seed: int) -> tuple[int, int]:
    """How many files were tried, and how many of them the readers disagree about: `count` files, or for `seconds`."""
    chance, start = random.Random(seed), time.monotonic()
    tried, found = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        files = sound_seeds(Path(folder))
        while tried != count and time.monotonic() - start < seconds:
            chosen = chance.choice(files)
            content = spoiled(chosen.content, chance)
            if chance.random() < _MADE:
                chosen = Seed(".toml", random_scenes.scene_of_roles(chance))
                content = chosen.content
            tried += 1
            if said := disagreement(chosen, content, Path(folder)):
                found += 1
                KEPT.mkdir(parents=True, exist_ok=True)
                kept = KEPT / f"{seed}-{tried}{chosen.suffix}"
                kept.write_bytes(content)
                print(f"{kept}: {said}", flush=True)
    return tried, found


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python3 -m tests.fuzz.compare_readers", description=__doc__)
    parser.add_argument("seconds", type=float)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    options = parser.parse_args(arguments)
    tried, found = compare(None, options.seconds, options.seed)
    print(f"{tried} files, {found} of them read differently")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
