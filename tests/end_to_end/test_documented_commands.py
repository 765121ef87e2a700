"""Every command that README and notes give is known to its program, with its options; those that no other test runs are run here, by night."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from analysis.measure import MEASURES
from tests.end_to_end.test_options import COMMANDS, options_of
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]
HAND = "model/examples/hand.toml"
GOOGLE = "--benchmark_min_time=0 --benchmark_filter="
# Command → how it is run here, in the place of what takes longer; {out} is an empty folder.
SMALL = {
    "build/bin/collision_benchmark": "build/bin/collision_benchmark 1",
    "build/bin/collision_stress": "build/bin/collision_stress --count 300",
    "build/bin/correction_benchmark": f"build/bin/correction_benchmark {GOOGLE}plate",
    "build/bin/distance_sensor_benchmark": f"build/bin/distance_sensor_benchmark {GOOGLE}one_triangle",
    "build/bin/plate_integral_benchmark": f"build/bin/plate_integral_benchmark {GOOGLE}exact",
    "build/bin/plate_integral_stress": "build/bin/plate_integral_stress --count 300",
    "build/bin/scene_collision_benchmark": "build/bin/scene_collision_benchmark 1",
    "build/bin/scene_evaluator_benchmark": f"build/bin/scene_evaluator_benchmark {GOOGLE}bodies:25/tolerance:0.01",
    "build/bin/surface_tree_benchmark": f"build/bin/surface_tree_benchmark {GOOGLE}build/100$",
    "fringe capacitance --method METHOD": f"build/bin/fringe capacitance --method formula {HAND}",
    "fringe capacitance SCENE --derivatives": f"build/bin/fringe capacitance {HAND} --derivatives",
    "fringe collide SCENE": f"build/bin/fringe collide {HAND}",
    "python3 -m analysis show x_ray_arm": "python3 -m analysis show x_ray_arm --output {out}/show.html",
    "python3 -m analysis sweep guarded_sensor": "python3 -m analysis sweep guarded_sensor --rtol 0.1 --output {out}/sweep.html",
    "python3 -m analysis coverage guarded_sensor": "python3 -m analysis coverage guarded_sensor --probe sphere:0.02 --grid 0.06 --method none --output {out}/coverage.html",
    "python3 -m analysis honesty": "python3 -m analysis honesty --only 0 --methods reduced:1e-2 --results {out}/honesty",
    "python3 -m analysis golden FILE": "python3 -m analysis golden {out}/golden.json --only 'corrections/parallel-000/reduced*'",
    "python3 -m geometries person OUT": "python3 -m geometries person {out}/person.obj",
    "python3 -m geometries convert IN OUT": "python3 -m geometries convert {out}/in.vtu {out}/out.stl",
    "python3 -m tests.bad_input.corpus FOLDER": "python3 -m tests.bad_input.corpus {out}/corpus",
    "python3 -m tests.fuzz.random_answers SECONDS": "python3 -m tests.fuzz.random_answers --only 3",
    "python3 -m tests.model.random_soups": "python3 -m tests.model.random_soups --count 2",
    "sha256sum reference_table.csv": "sha256sum analysis/topics/published/reference_table.csv",
}  # fmt: skip
# Of minutes, also when they are asked for little.
MINUTES = {
    "python3 -m tests.fem_reference.invariances": "python3 -m tests.fem_reference.invariances --first 31 --count 1",
    "build/bin/boundary_elements_benchmark": "build/bin/boundary_elements_benchmark",
    "build/bin/boundary_element_scenes_benchmark": "build/bin/boundary_element_scenes_benchmark",
    "build/bin/reduced_benchmark --moving SCENE POSES": "build/bin/reduced_benchmark --moving geometries/scenes/guarded_sensor.toml 2",
    "build/bin/reduced_benchmark --covers 12": "build/bin/reduced_benchmark --covers 1",
    "build/bin/reduced_benchmark --machine 3": "build/bin/reduced_benchmark --machine 0",
    "build/bin/reduced_benchmark --meshes 40": "build/bin/reduced_benchmark --meshes 1",
    "build/bin/reduced_benchmark SCENE…": f"build/bin/reduced_benchmark {HAND}",
    "tests/fuzz/run SECONDS": "tests/fuzz/run 20",
}
_STARTS = re.compile(
    r"\./run|\./check|build/bin/|python3 -m [a-z]|tests/[\w/]+(?=[ `]|$)|fringe [a-z…]|cmake |\(cd build|pkg-config |sha256sum |[a-z_]+_benchmark"
)


def given() -> dict[str, set[str]]:
    """Every command in the repository's notes, and where it is; the tutorial's have a test that runs them all. The changelog may also tell of
    commands that are no more."""
    found: dict[str, set[str]] = {}
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    for file in listed.stdout.split():
        text = re.sub(r"```.*?```", "", (ROOT / file).read_text(encoding="utf-8"), flags=re.DOTALL)
        blocks = [
            re.split(r" {2,}#", line.strip().removeprefix("$ "))[0].strip()
            for line in text.splitlines()
            if line.startswith("    ")
        ]
        for command in [*blocks, *re.findall(r"`([^`\n]+)`", text)]:
            if _STARTS.match(command):
                found.setdefault(command, set()).add(file)
    return {command: files for command, files in found.items() if files != {"CHANGELOG.md"}}


def is_known(step: str) -> bool:
    """Whether the program, module, preset or test of a command is there, and the program knows the subcommand and the options."""
    program, *words = step.strip("()").replace("build/bin/", "").split()
    options = {word for word in words if re.match(r"--[a-z]", word)}
    if program == "python3":
        _, module, *words = words
        if module == "pytest":
            return all((ROOT / word.removesuffix("/FOLDER")).exists() for word in words if "tests/" in word)
        file = ROOT / module.replace(".", "/")
        if module not in COMMANDS:
            return file.with_suffix(".py").is_file() or (file / "__main__.py").is_file()
        program = module
    if program in COMMANDS:
        command = words[:1] if COMMANDS[program] and words and words[0] != "…" else []
        return set(command) <= set(COMMANDS[program]) and (
            not command or options <= options_of(program, *command) or command == ["measure"]
        )
    if program == "cmake" and "--preset" in words:
        return f'"name": "{words[words.index("--preset") + 1]}"' in (ROOT / "CMakePresets.json").read_text()
    tools = ("cmake", "cpack", "ctest", "cd", "pkg-config", "sha256sum", "ROOM_tests")
    run_here = {name.split()[0].removeprefix("build/bin/") for name in (*SMALL, *MINUTES)}
    return program in tools or program in run_here or (ROOT / program).exists()


def test_every_command_of_the_notes_is_known() -> None:
    commands = given()
    assert not {
        command: files
        for command, files in commands.items()
        if command not in {*SMALL, *MINUTES} and not all(map(is_known, command.split(" && ")))
    }
    assert not {*SMALL, *MINUTES} - set(commands)


def test_every_measure_is_known_and_loads_and_each_is_in_a_note() -> None:
    named = {
        match[1]
        for command in given()
        if (match := re.match(r"python3 -m analysis measure ([a-z-]+)", command))
    }
    assert named == set(MEASURES)
    for each in MEASURES.values():
        assert callable(import_module(each.module).measure)


@pytest.mark.night
@pytest.mark.parametrize("command", SMALL)
def test_a_command_works(tmp_path: Path, command: str) -> None:
    if "convert" in command:
        import meshio

        meshio.write(
            tmp_path / "in.vtu", meshio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [("triangle", [[0, 1, 2]])])
        )
    run(SMALL[command].replace("{out}", shlex.quote(str(tmp_path))))


@pytest.mark.night
@pytest.mark.parametrize("command", MINUTES)
def test_a_command_of_minutes_works(command: str) -> None:
    run(MINUTES[command])


def run(command: str) -> None:
    words = shlex.split(command)
    if words[0] == "python3":
        words[0] = sys.executable
    assert shutil.which(words[0], path=f"{ROOT}:{os.environ['PATH']}") or (ROOT / words[0]).is_file(), words[
        0
    ]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=6 * DEADLINE)
    assert done.returncode == 0 and (done.stdout or done.stderr), done.stderr
