"""`cmake --install`: what others build on the library with, commands and modules that work without the build, and the tutorial."""

import gzip
import json
import math
import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests import scenes
from tests.end_to_end.test_options import COMMANDS
from tests.waiting import DEADLINE

pytestmark = pytest.mark.night

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"

SCENE = scenes.SENSOR + scenes.body("hand", "plate", size=[0.073, 0.119], translation=[0.01, 0, 0.03])
CONSUMER_PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES CXX)
find_package(fringe 0.1 REQUIRED)
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE fringe::fringe)
"""
CONSUMER = r"""
#include <cstdio>

#include "fringe/evaluation.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/version.hpp"

int main(int, char** arguments) {
  const fringe::Scene scene = fringe::load_scene(arguments[1]);
  std::printf("%s %.17g\n", fringe::version(), fringe::capacitance(scene).sensors.at(0).total);
}
"""
"""Prints the version and what the first sensor of a scene feels, in farad."""
# Only what is installed, wherever the user stands: nothing of the repository is on a path.
ENVIRONMENT = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}


def files_of(prefix: Path) -> set[Path]:
    """The files of the Python packages of an installation, except what Python compiles."""
    return {path for path in (prefix / "share/fringe").rglob("*") if "__pycache__" not in path.parts}


@pytest.fixture(scope="module")
def installation(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, set[Path]]:
    """Where everything is installed, a folder with a space, and the files before any test has used them."""
    folder = tmp_path_factory.mktemp("an installation") / "prefix"
    subprocess.run(["cmake", "--install", BUILD, "--prefix", folder], check=True, capture_output=True)
    return folder, files_of(folder)


@pytest.fixture(scope="module")
def prefix(installation: tuple[Path, set[Path]]) -> Path:
    return installation[0]


def output_of(command: list[str | Path], folder: Path, **variables: str) -> str:
    done = subprocess.run(
        command,
        cwd=folder,
        env=ENVIRONMENT | variables,
        capture_output=True,
        text=True,
        check=False,
        timeout=DEADLINE,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def total(prefix: Path, scene: Path) -> float:
    document = json.loads(output_of([prefix / "bin/fringe", "capacitance", scene, "--json"], scene.parent))
    return float(document["sensors"][0]["total"])


def test_a_project_finds_the_library_with_cmake(prefix: Path, scene: Path) -> None:
    build = scene.parent / "build"
    # Every public header has to come with all that it includes.
    headers = sorted((ROOT / "model/include/fringe").glob("*.hpp"))
    source = "".join(f'#include "fringe/{header.name}"\n' for header in headers)
    project = scene.parent / "consumer"
    project.mkdir()
    (project / "CMakeLists.txt").write_text(CONSUMER_PROJECT)
    (project / "main.cpp").write_text(source + CONSUMER)
    configure = ["cmake", "-S", project, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}"]
    output_of([*configure, "-DCMAKE_BUILD_TYPE="], scene.parent)
    output_of(["cmake", "--build", build], scene.parent)
    version, answer = output_of([build / "consumer", scene], scene.parent).split()
    assert version == output_of([prefix / "bin/fringe", "--version"], scene.parent).strip()
    assert float(answer) == total(prefix, scene)


def test_the_installed_command_imports_a_model(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "face.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    printed = output_of([prefix / "bin/fringe", "import", "face.obj", "scene.toml"], tmp_path)
    assert printed.startswith("scene.toml: ") and (tmp_path / "scene_meshes").is_dir()


def test_the_installed_examples_build_against_the_installed_library(prefix: Path, scene: Path) -> None:
    """One of them: all are compiled with the library itself."""
    examples, build = prefix / "share/doc/fringe/examples", scene.parent / "build"
    output_of(
        ["cmake", "-S", examples, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}"], scene.parent
    )
    output_of(["cmake", "--build", build, "--target", "example_moving_scene"], scene.parent)
    printed = output_of([build / "examples/moving_scene", examples / "hand.toml"], scene.parent)
    assert printed.startswith("raised by")


def test_a_project_finds_the_library_with_pkg_config(prefix: Path, scene: Path) -> None:
    flags = output_of(
        ["pkg-config", "--cflags", "--libs", "fringe"],
        scene.parent,
        PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig"),
    )
    program, source = scene.parent / "consumer", scene.parent / "main.cpp"
    source.write_text(CONSUMER)
    # Through a shell, as a makefile would do it: the flags are quoted for one.
    command = f'g++ -std=c++20 "{source}" -o "{program}" {flags}'
    output_of(["sh", "-c", command], scene.parent)
    assert float(output_of([program, scene], scene.parent).split()[1]) == total(prefix, scene)


def test_meshes_are_converted_from_another_folder(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "face.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    output_of([prefix / "bin/fringe-geometries", "convert", "face.obj", "face.stl"], tmp_path)
    assert (tmp_path / "face.stl").is_file()


def options_of(program: Path, *command: str) -> set[str]:
    """The long options that a help names at the beginning of a line."""
    lines = output_of([program, *command, "--help"], program.parent).splitlines()
    words = [word for line in lines if line.startswith("  -") for word in line.replace(",", " ").split()]
    return {word for word in words if word.startswith("--")} - {"--help"}


# The packages of the commands.
INSTALLED = {
    "fringe": "fringe",
    "fringe-analysis": "analysis",
    "fringe-geometries": "geometries",
    "fringe-reference": "fem_reference",
}


@pytest.mark.parametrize("program", INSTALLED)
def test_manual_pages_and_completions_know_every_command_and_option(prefix: Path, program: str) -> None:
    wanted = options_of(prefix / "bin" / program)
    commands = COMMANDS[INSTALLED[program]]
    for command in commands:
        wanted |= options_of(prefix / "bin" / program, command)
    assert wanted or program == "fringe-geometries"
    page = (
        gzip.decompress((prefix / f"share/man/man1/{program}.1.gz").read_bytes()).decode().replace(r"\-", "-")
    )
    bash = (prefix / "share/bash-completion/completions" / program).read_text()
    zsh = (prefix / "share/zsh/vendor-completions" / f"_{program}").read_text()
    for text in (page, bash, zsh):
        for word in (*wanted, *commands):
            assert word in text


def test_bash_completes_commands_and_options(prefix: Path) -> None:
    script = prefix / "share/bash-completion/completions/fringe"
    code = (
        f'source "{script}"; COMP_WORDS=(fringe capacitance --me); COMP_CWORD=2; _shtab_fringe; '
        'echo "${COMPREPLY[@]}"'
    )
    assert output_of(["bash", "-c", code], prefix).split() == ["--method"]


TUTORIAL = (ROOT / "analysis/documentation/tutorial.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"```sh\n(.*?)```(?:\n\n```text\n(.*?)```)?", re.DOTALL)
# Times depend on the machine.
SECONDS = re.compile(r"[\d.e-]+ s\b")
# Digits of answers whose errors are estimated may differ by some of these errors between machines.
TOLERANCE = 0.02


def steps() -> Iterator[tuple[str, str]]:
    """Commands, and what the page shows that they print."""
    for found in BLOCK.finditer(TUTORIAL):
        yield found[1], found[2] or ""


def words(printed: str, folder: Path) -> list[str]:
    return SECONDS.sub("", printed.replace(f"{folder.resolve()}/", "…/")).split()


def agrees(printed: str, shown: str) -> bool:
    try:
        return math.isclose(float(printed), float(shown), rel_tol=TOLERANCE, abs_tol=1e-3)
    except ValueError:
        return printed == shown


def test_the_commands_print_what_the_tutorial_shows(
    installation: tuple[Path, set[Path]], tmp_path: Path
) -> None:
    """With the model, the field solver, a study and the Python module; nothing is written into the installation, which also the tests above
    have used."""
    prefix, installed = installation
    # The cache of the build holds the forms that the field solver would otherwise compile first.
    environment = os.environ | {
        "PATH": f"{prefix / 'bin'}:{os.environ['PATH']}",
        "PYTHONPATH": str(next(prefix.glob("lib/python3*/dist-packages"))),
        "XDG_CACHE_HOME": str(BUILD / "cache"),
    }
    for commands, shown in steps():
        done = subprocess.run(
            ["bash", "-ec", commands], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, commands + done.stderr
        printed, expected = words(done.stdout, tmp_path), words(shown, tmp_path)
        assert len(printed) == len(expected), done.stdout
        assert all(map(agrees, printed, expected)), done.stdout
    assert (tmp_path / "scene.html").is_file() and (tmp_path / "results/my_sensor/report.html").is_file()
    assert files_of(prefix) == installed


def test_every_output_of_the_tutorial_is_compared() -> None:
    assert TUTORIAL.count("```text\n") == sum(bool(shown) for _, shown in steps()) == 8
