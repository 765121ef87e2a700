"""`python3 -m tests.fuzz.seeds FOLDER`: what the fuzzers begin with, from the scenes of the repository and the corpus of bad input."""

import random
import sys
import tempfile
from pathlib import Path

from geometries.studies import study
from tests.bad_input import keys, meshes, texts

ROOT = Path(__file__).resolve().parents[2]
_LARGEST = 8000
_OF_NUMBERS = ("plate_integral", "gjk_intersects", "cone_closest")
READERS = (".stl", ".obj", ".ply")


def main(target: Path) -> None:
    chance = random.Random(1)
    for name, contents in {
        "scene_reader": scenes(),
        "mesh_reader": mesh_files(),
        # Any bytes are an input; the first says how the others become numbers.
        **{name: [bytes([kind]) + chance.randbytes(160) for kind in range(24)] for name in _OF_NUMBERS},
    }.items():
        (target / name).mkdir(parents=True, exist_ok=True)
        for number, content in enumerate(contents):
            (target / name / f"{number:03}").write_bytes(content)


def scenes() -> list[bytes]:
    shipped = [path.read_bytes() for path in sorted((ROOT / "geometries" / "scenes").glob("*.toml"))]
    smoke = [case.text.encode() for case in study.load(study.find("smoke")).cases()]
    return (
        shipped + smoke + [content for content in _made(texts) + _made(keys)[:40] if len(content) < _LARGEST]
    )


def mesh_files() -> list[bytes]:
    """With the byte before each that chooses its reader."""
    return [content for content in _made(meshes) if len(content) < _LARGEST]


def _made(part: object) -> list[bytes]:
    contents = []
    for case in part.cases():  # type: ignore[attr-defined]
        if case.long:
            continue
        with tempfile.TemporaryDirectory() as folder:
            scene = case.make(Path(folder))
            found = [path for path in Path(folder).iterdir() if path.suffix in READERS]
            contents += [bytes([READERS.index(path.suffix)]) + path.read_bytes() for path in found]
            if not found and scene.is_file():
                contents.append(scene.read_bytes())
    return contents


if __name__ == "__main__":
    main(Path(sys.argv[1]))
