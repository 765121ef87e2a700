"""Random poses: are the errors that boundary elements state errors? `python3 -m tests.model.random_boundary_elements`.

A sensor of 10 cm, and plates and boxes of 1 to 30 cm; a third of the poses parallel, a third at right angles; centres 1 to 150 mm
above or below the sensor's plane. The answer at rtol = 1e-3 is held against that at 5e-5, as far as that was reached. With
`--meshes` the same bodies are also given as triangles, whose answer at rtol = 1e-2 is held against that of their faces at 1e-4. With
`--sizes` the bodies have sides of 5 mm to 2 m and start at 0.5 mm, and the answer at rtol = 1e-2 is held against that at 2e-3.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "build" / "python"))

import fringe  # noqa: E402

ASKED, STRICT = 1e-3, 5e-5
ASKED_OF_MESHES, STRICT_BESIDE_MESHES = 1e-2, 1e-4
ASKED_OF_SIZES, STRICT_OF_SIZES = 1e-2, 2e-3

SCENE = """
[[sensor]]
name = "sensor"
plates = [ {{ corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] }} ]

[[object]]
name = "object"
shape = {{ type = "{type}", size = {size} }}
translation = {centre}
rotation = {{ axis = {axis}, degrees = {degrees} }}
"""

MESH = """
[[object]]
name = "object"
shape = {{ type = "mesh", file = "{file}" }}
"""


def random_scene(random: np.random.Generator, any_size: bool) -> str:
    smallest, largest, nearest = (5e-3, 2, 5e-4) if any_size else (0.01, 0.3, 0.001)
    size = np.exp(random.uniform(np.log(smallest), np.log(largest), 3))
    box = random.random() < 0.35
    axis = random.normal(size=3) if random.random() < 0.6 else np.eye(3)[random.integers(1, 3)]
    centre = random.uniform(-0.12, 0.12, 3)
    centre[2] = np.exp(random.uniform(np.log(nearest), np.log(0.15))) * random.choice([1, -1])
    degrees = random.choice([0.0, 90.0, random.uniform(0, 180)])
    if box and degrees == 0:
        centre[2] += np.copysign(size[2] / 2, centre[2])
    return SCENE.format(
        type="cuboid" if box else "plate",
        size=size[: 3 if box else 2].tolist(),
        centre=centre.tolist(),
        axis=axis.tolist(),
        degrees=float(degrees),
    )


def as_mesh(scene: Path) -> Path:
    """The scene with its object's triangles in a file."""
    triangles = fringe.Scene.load(scene).conductors()["object"]
    text = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in triangles.reshape(-1, 3).tolist())
    text += "".join(f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}\n" for k in range(len(triangles)))
    scene.with_name("object.obj").write_text(text)
    path = scene.with_name("mesh.toml")
    path.write_text(scene.read_text().split("[[object]]")[0] + MESH.format(file="object.obj"))
    return path


def covered(asked: dict[str, Any], strict: dict[str, Any]) -> bool:
    matrix = np.abs(asked["maxwell"] - strict["maxwell"]) <= asked["error"] + strict["error"]
    one, other = asked["delta_self"]["sensor"], strict["delta_self"]["sensor"]
    return bool(np.all(matrix)) and abs(one["value"] - other["value"]) <= one["error"] + other["error"]


def true_per_stated(asked: dict[str, Any], strict: dict[str, Any]) -> float:
    """The largest error of an entry, by the stricter answer alone, per stated error."""
    return float(np.max(np.abs(asked["maxwell"] - strict["maxwell"]) / asked["error"]))


def above(asked: dict[str, Any], strict: dict[str, Any]) -> bool:
    """Whether an entry that is called a lower bound is above the truth."""
    excess = np.diag(asked["maxwell"]) - np.diag(strict["maxwell"]) - np.diag(strict["error"])
    return bool(np.any(excess[np.array(asked["lower_bounds"])] > 0))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--meshes", action="store_true")
    kind.add_argument("--sizes", action="store_true")
    arguments = parser.parse_args()
    asked_rtol, strict_rtol = ASKED, STRICT
    if arguments.meshes:
        asked_rtol, strict_rtol = ASKED_OF_MESHES, STRICT_BESIDE_MESHES
    elif arguments.sizes:
        asked_rtol, strict_rtol = ASKED_OF_SIZES, STRICT_OF_SIZES
    random = np.random.default_rng(arguments.seed)
    touching = uncovered = unbounded = 0
    times, errors, ratios, reached = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        for _ in range(arguments.count):
            path.write_text(random_scene(random, arguments.sizes))
            scene = fringe.Scene.load(path)
            try:
                asked_of = fringe.Scene.load(as_mesh(path)) if arguments.meshes else scene
                asked = asked_of.maxwell(rtol=asked_rtol)
            except fringe.InputError:
                touching += 1
                continue
            strict = scene.maxwell(rtol=strict_rtol)
            times.append(1e3 * asked["seconds"])
            reached.append(asked["reached"])
            errors.append(np.max(np.abs(asked["maxwell"] / strict["maxwell"] - 1)))
            ratios.append(true_per_stated(asked, strict))
            if not covered(asked, strict) or above(asked, strict):
                uncovered += not covered(asked, strict)
                unbounded += above(asked, strict)
                print(path.read_text())
    print(f"{len(times)} poses and {touching} that touch; {reached.count(False)} said not to be reached")
    print(
        f"outside their stated error: {uncovered}; above the truth though called a lower bound: {unbounded}"
    )
    print(
        f"true per stated error: at most 1 in {100 * np.mean(np.array(ratios) <= 1):.1f} %, "
        f"worst {max(ratios):.2f}"
    )
    print(f"difference where said to be reached: worst {max(np.array(errors)[reached]):.1e}")
    print("ms: median {:.2f}, nine of ten {:.1f}, longest {:.0f}".format(*np.quantile(times, [0.5, 0.9, 1])))


if __name__ == "__main__":
    main()
