"""What the notes say holds today: the worked example of README.md, what the guides show, the files and functions that CONTRIBUTING.md names.
Every command in a note is known to its program, with its options; those that no other test runs are run here, by night."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from analysis.commands import MEASURES
from analysis.pipeline.model_stage import model_module
from analysis.topics.corrections import set_ups as corrections_set_ups
from tests.bad_input import corpus
from tests.end_to_end.test_options import COMMANDS, options_of
from tests.programs import ROOT, fringe_command
from tests.waiting import DEADLINE

README = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (ROOT / "model" / "GUIDE.md").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
VALUE_AND_ERROR = re.compile(r"(-?[\d.]+) ± ([\d.]+)")


def listed(*patterns: str) -> list[Path]:
    """The files of the repository, of these patterns."""
    done = subprocess.run(
        ["git", "ls-files", *patterns], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return [Path(file) for file in done.stdout.splitlines()]


NOTES = {note: (ROOT / note).read_text(encoding="utf-8") for note in listed("*.md")}


def example(tmp_path: Path) -> Path:
    """The first TOML block of the README, as a file."""
    block = re.search(r"```toml\n(.*?)```", README, re.DOTALL)
    assert block is not None
    path = tmp_path / "hand.toml"
    path.write_text(block[1])
    return path


def printed_after(command: str, text: str = README) -> list[str]:
    """The lines of a page that follow a command, up to the end of its block."""
    lines = text.split(f"    $ {command}\n", 1)[1].split("\n\n", 1)[0].splitlines()
    return [line.strip() for line in lines]


def test_the_model_prints_what_the_readme_shows(tmp_path: Path) -> None:
    done = fringe_command("capacitance", example(tmp_path))
    printed = [line.strip() for line in done.stdout.splitlines()]
    for line in printed_after("build/bin/fringe capacitance hand.toml"):
        assert line in printed


@pytest.mark.night
def test_the_reference_agrees_with_what_the_readme_shows(tmp_path: Path) -> None:
    """Same table, and every value within the error beside it: another machine's libraries may make another mesh."""
    command = [sys.executable, "-m", "fem_reference", example(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    shown = "\n".join(printed_after("python3 -m fem_reference hand.toml"))
    expected, found = VALUE_AND_ERROR.findall(shown), VALUE_AND_ERROR.findall(done.stdout)
    assert len(expected) == len(found) == 8
    for (value, error), (new, _) in zip(expected, found):
        assert abs(float(new) - float(value)) <= float(error)


def test_boundary_elements_print_what_the_guide_shows(tmp_path: Path) -> None:
    """Every value within the error beside it, as for the reference: the last digits belong to the machine."""
    done = fringe_command("capacitance", example(tmp_path), "--method", "boundary-elements")
    shown = "\n".join(
        printed_after("build/bin/fringe capacitance hand.toml --method boundary-elements", GUIDE)
    )
    expected, found = VALUE_AND_ERROR.findall(shown), VALUE_AND_ERROR.findall(done.stdout)
    assert len(expected) == 4 and len(found) >= 4
    for (value, error), (new, new_error) in zip(expected, found):
        assert abs(float(new) - float(value)) <= 0.1 * float(error)
        assert float(new_error) == pytest.approx(float(error), rel=0.1)


def test_the_python_example_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    block = re.search(r"```python\n(.*?)```", GUIDE, re.DOTALL)
    assert block is not None
    example(tmp_path)
    monkeypatch.chdir(tmp_path)
    model_module()
    found: dict[str, Any] = {}
    exec(block[1], found)
    scene = found["scene"]
    assert scene.conductors()["hand"].shape == (2, 3, 3)
    exact, split = (
        scene.capacitance(method=method)["sensors"][0]["total"] for method in ("exact", "split:4")
    )
    assert exact != split and exact == pytest.approx(split, rel=1e-2)


def test_the_guide_tells_every_option_of_the_command_and_its_keyword() -> None:
    table = GUIDE.split("| option |")[1].split("\n\n")[0]
    rows = re.findall(r"^\| (`--[^|]+) \|([^|]*)\|", table, re.MULTILINE)
    told = {option: keywords for options, keywords in rows for option in re.findall(r"--[\w-]+", options)}
    helped = fringe_command("capacitance", "--help").stdout
    known = set(re.findall(r"^ +(?:-\w,)?(--[\w-]+)", helped, re.MULTILINE))
    assert set(told) == known - {"--help", "--version", "--json"}
    signature = model_module().Scene.capacitance.__doc__.split("->")[0]
    for option, keywords in told.items():
        name = option.removeprefix("--").replace("-", "_")
        assert (f"`{name}`" in keywords) == (f" {name}:" in signature), option


@pytest.mark.parametrize("file", ["analysis/GUIDE.md", "analysis/documentation/algorithms/capacitances.md"])
def test_there_are_as_many_set_ups_corrected_as_is_told(file: str) -> None:
    text = (ROOT / file).read_text(encoding="utf-8")
    chosen = list(corrections_set_ups.set_ups(model_module()))
    assert f"{len(chosen)} set-ups, {sum(set_up.sealed for set_up in chosen)} of them" in text


def test_the_corpus_of_bad_input_is_of_more_than_a_thousand() -> None:
    assert "a corpus of more than a thousand" in CONTRIBUTING
    assert 1000 < len(corpus.cases()) < 2000


def test_the_differences_that_the_readme_states_follow_from_its_numbers() -> None:
    model = float(re.search(r"total +([\d.]+) pF", README)[1])  # type: ignore[index]
    values = VALUE_AND_ERROR.findall("\n".join(printed_after("python3 -m fem_reference hand.toml")))
    mutual, delta_self = -float(values[1][0]), float(values[4][0])
    assert f"= {mutual:.3f} pF: it is {100 * (1 - model / mutual):.0f} % low" in README
    assert (
        f"{delta_self:.3f} pF, of which the model is {100 * (model / delta_self - 1):.0f} % too high"
        in README
    )


def test_the_errors_in_the_table_of_methods_are_those_of_the_notes() -> None:
    notes = (ROOT / "model" / "CORRECTIONS.md").read_text(encoding="utf-8")
    for method in ("exact", "formula"):
        rms = re.search(rf"^\| `{method}` \| ([\d.]+) \|", notes, re.MULTILINE)
        assert rms is not None
        (row,) = re.findall(rf"^\| `{method}`.*", README, re.MULTILINE)
        assert f"| {rms[1]} % rms" in row


def _anchor(heading: str) -> str:
    """The anchor that a heading has on a page."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def test_the_links_of_all_notes_lead_somewhere() -> None:
    for note, text in NOTES.items():
        prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        for target in re.findall(r"\]\(([^)\s]+)\)", prose):
            if target.startswith(("http://", "https://")):
                continue
            file, _, anchor = target.partition("#")
            path = (ROOT / note.parent / file) if file else ROOT / note
            assert path.exists(), f"{note}: {target}"
            if anchor:
                headings = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
                assert anchor in map(_anchor, headings), f"{note}: {target}"


FOLLOWED = re.findall(r"^\| \d+ \| `([\w:]+)` \| `([\w./]+)` \|", CONTRIBUTING, re.MULTILINE)


def test_a_triangle_and_a_row_are_followed() -> None:
    chapters = [
        re.findall(r"^\| (\d+) \|", chapter, re.MULTILINE)
        for chapter in CONTRIBUTING.split("## Follow one")[1:]
    ]
    assert [len(numbers) <= most for numbers, most in zip(chapters, (12, 20), strict=True)] == [True, True]
    assert sum(map(len, chapters)) == len(FOLLOWED)


@pytest.mark.parametrize(("function", "file"), FOLLOWED)
def test_a_function_on_the_way_is_where_it_is_said_to_be(function: str, file: str) -> None:
    text = (ROOT / file).read_text(encoding="utf-8")
    defined = rf"^ *def {function}\(" if file.endswith(".py") else rf"^[\w].*\b{function}\("
    assert re.search(defined, text, re.MULTILINE)


@pytest.mark.parametrize("parent", ["analysis", "geometries", "model/src"])
def test_the_map_has_every_folder(parent: str) -> None:
    below = [file.relative_to(parent).parts for file in listed(parent)]
    drawing = CONTRIBUTING.split("```")[1]
    assert not {parts[0] for parts in below if len(parts) > 1 and f"{parts[0]}/" not in drawing}


def test_the_source_files_that_the_notes_name_exist() -> None:
    files = listed()
    for note, text in NOTES.items():
        for name in re.findall(r"`([\w./*]+\.(?:cpp|hpp|py|js|css))`", text):
            assert any(file.match(name) for file in files), f"{note}: {name}"


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
    "python3 -m analysis honesty": "python3 -m analysis honesty --only 0 --methods reduced:1e-2 --results {out}/honesty",
    "python3 -m analysis golden FILE": "python3 -m analysis golden {out}/golden.json --only 'corrections/parallel-000/reduced*'",
    "python3 -m tests.bad_input.corpus FOLDER": "python3 -m tests.bad_input.corpus {out}/corpus",
    "python3 -m tests.fuzz.random_answers SECONDS": "python3 -m tests.fuzz.random_answers --only 3",
    "python3 -m tests.model.random_soups": "python3 -m tests.model.random_soups --count 2",
    "sha256sum reference_table.csv": "sha256sum analysis/topics/published/reference_table.csv",
}  # fmt: skip
# These commands take minutes, also when they are asked for little.
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


def given() -> dict[str, set[Path]]:
    """Every command in the repository's notes, and where it is; the tutorial's have a test that runs them all. The changelog may also tell of
    commands that are no more."""
    found: dict[str, set[Path]] = {}
    for note, text in NOTES.items():
        prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        blocks = [
            re.split(r" {2,}#", line.strip().removeprefix("$ "))[0].strip()
            for line in prose.splitlines()
            if line.startswith("    ")
        ]
        for command in [*blocks, *re.findall(r"`([^`\n]+)`", prose)]:
            if _STARTS.match(command):
                found.setdefault(command, set()).add(note)
    return {command: notes for command, notes in found.items() if notes != {Path("CHANGELOG.md")}}


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


def test_every_measure_is_known_and_each_is_in_a_note() -> None:
    named = {
        match[1]
        for command in given()
        if (match := re.match(r"python3 -m analysis measure ([a-z-]+)", command))
    }
    assert named == set(MEASURES)


@pytest.mark.night
@pytest.mark.parametrize("command", SMALL)
def test_a_command_works(tmp_path: Path, command: str) -> None:
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
