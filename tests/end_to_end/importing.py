"""Runs `fringe import` for the tests of its formats."""

import math
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline import model_stage
from geometries.scene import reader
from geometries.scene.scene import Scene
from tests.programs import FRINGE
from tests.waiting import DEADLINE

SINGLE_PRECISION = 2e-7

# A corner of a cube; two of its faces are enough to see order, scale and reflection.
OBJ = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\n"
TRIANGLES = np.array([[[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 0, 0], [0, 2, 0], [0, 0, 3]]], dtype=float)
MESH = "package://arm_description/meshes/hand.obj"
# Joints that turn and slide, one that follows another, and one that follows that one.
ROBOT = f"""<?xml version="1.0"?>
<robot name="arm">
  <link name="base">
    <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision>
    <visual><geometry><sphere radius="1"/></geometry></visual>
  </link>
  <link name="upper arm">
    <collision>
      <origin xyz="0 0 0.25" rpy="0 1.5707963267948966 0"/>
      <geometry><cylinder radius="0.05" length="0.5"/></geometry>
    </collision>
    <collision><geometry><sphere radius="0.07"/></geometry></collision>
  </link>
  <link name="hand">
    <collision><geometry><mesh filename="{MESH}" scale="0.001 0.001 -0.002"/></geometry></collision>
  </link>
  <link name="thumb"><collision><geometry><box size="0.01 0.02 0.03"/></geometry></collision></link>
  <link name="nail"><collision><geometry><box size="0.01 0.01 0.01"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper arm"/>
    <origin xyz="0 0 0.1" rpy="0.1 -0.2 0.3"/><axis xyz="0 2 0"/><limit lower="-1" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="lift" type="prismatic"><parent link="upper arm"/><child link="hand"/>
    <origin xyz="0 0 0.6" rpy="0 0 1"/><axis xyz="1 0 0"/><limit lower="0" upper="0.2" effort="1" velocity="1"/></joint>
  <joint name="grip" type="continuous"><parent link="hand"/><child link="thumb"/>
    <origin xyz="0.1 0 0"/><axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="-2" offset="0.1"/></joint>
  <joint name="tip" type="revolute"><parent link="thumb"/><child link="nail"/>
    <axis xyz="1 0 0"/><limit effort="1" velocity="1"/><mimic joint="grip" multiplier="0.5"/></joint>
</robot>
"""


def written(path: Path, text: str, encoding: str = "utf-8") -> Path:
    """The file, with this text."""
    path.write_text(text, encoding=encoding)
    return path


def robot_in(folder: Path, text: str = ROBOT) -> Path:
    """The file of a robot, in a package that has the mesh of the one above."""
    path = folder / "arm_description" / "urdf" / "arm.urdf"
    mesh = path.parents[1] / "meshes" / "hand.obj"
    for file, content in ((path, text), (mesh, OBJ)):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content)
    return path


def fringe_import(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the command with these arguments."""
    # tests/clean/run lets valgrind watch.
    command = [*os.environ.get("FRINGE_WATCHED_BY", "").split(), FRINGE, "import", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE)


def imported(source: Path, *options: str | Path, warnings: str = "") -> Scene:
    """The scene made of a file; both readers have to see the same triangles in it. `warnings` is in what is told, if anything is."""
    target = source.with_name("scene.toml")
    done = fringe_import(source, target, *options)
    assert done.returncode == 0, done.stderr
    assert warnings in done.stderr if warnings else not done.stderr, done.stderr
    assert all(line.startswith(f"fringe: warning: {source}:") for line in done.stderr.splitlines())
    scene = reader.load(target)
    here, there = scene.conductors(), model_stage.model_module().Scene.load(str(target)).conductors()
    assert list(here) == list(there)
    for name, triangles in here.items():
        assert triangles == pytest.approx(there[name], abs=SINGLE_PRECISION)
    return scene


def assert_refused(source: Path, told: str, *options: str | Path) -> str:
    """A source is refused with one line, which is returned, that names it and the reason, and nothing is left behind."""
    before = set(source.parent.rglob("*"))
    done = fringe_import(source, source.parent / "new" / "wrong.toml", *options)
    assert (done.returncode, done.stdout) == (2, ""), done
    assert told in done.stderr and source.name in done.stderr, done.stderr
    assert len(done.stderr.splitlines()) == 1 and "unfinished" not in done.stderr
    assert set(source.parent.rglob("*")) == before
    return done.stderr


def about(axis: int, angle: float) -> np.ndarray:
    """The matrix of a rotation about a coordinate axis."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = math.cos(angle)
    matrix[second, first] = math.sin(angle)
    matrix[first, second] = -math.sin(angle)
    return matrix


def affine(translation: list[float], linear: np.ndarray) -> np.ndarray:
    """The matrix (4, 4) of a linear map that a translation follows."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, translation
    return matrix


def volume(triangles: np.ndarray) -> float:
    """Of a closed surface; positive where its triangles are anticlockwise seen from outside."""
    return float(np.linalg.det(triangles).sum() / 6)


def area(triangles: np.ndarray) -> float:
    sides = triangles[:, 1:] - triangles[:, :1]
    return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2)
