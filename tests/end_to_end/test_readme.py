"""The worked example of README.md and what the guides show is what the commands print today; CONTRIBUTING.md names what exists."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import meshio
import pytest

from analysis.pipeline.model_stage import model_module
from analysis.topics.corrections import set_ups as corrections_set_ups
from tests.bad_input import corpus

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (ROOT / "model" / "GUIDE.md").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
VALUE_AND_ERROR = re.compile(r"(-?[\d.]+) ± ([\d.]+)")


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
    command = [ROOT / "build/bin/fringe", "capacitance", example(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    printed = [line.strip() for line in done.stdout.splitlines()]
    for line in printed_after("build/bin/fringe capacitance hand.toml"):
        assert line in printed


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
    command = [ROOT / "build/bin/fringe", "capacitance", example(tmp_path), "--method", "boundary-elements"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    shown = "\n".join(
        printed_after("build/bin/fringe capacitance hand.toml --method boundary-elements", GUIDE)
    )
    expected, found = VALUE_AND_ERROR.findall(shown), VALUE_AND_ERROR.findall(done.stdout)
    assert len(expected) == 4 and len(found) >= 4
    for (value, error), (new, new_error) in zip(expected, found):
        assert abs(float(new) - float(value)) <= 0.1 * float(error)
        assert float(new_error) == pytest.approx(float(error), rel=0.1)


def test_the_file_for_paraview_is_written(tmp_path: Path) -> None:
    """`--output triangles.vtu`"""
    command = [ROOT / "build/bin/fringe", "capacitance", example(tmp_path), "--output", "triangles.vtu"]
    assert command[-2] + " " + command[-1] in GUIDE
    subprocess.run(command, cwd=tmp_path, capture_output=True, check=True)
    assert {"body", "capacitance front"} == set(meshio.read(tmp_path / "triangles.vtu").cell_data)


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
    command = [ROOT / "build/bin/fringe", "capacitance", "--help"]
    helped = subprocess.run(command, capture_output=True, text=True, check=True).stdout
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
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    for note in map(Path, listed.stdout.split()):
        text = re.sub(r"```.*?```", "", (ROOT / note).read_text(encoding="utf-8"), flags=re.DOTALL)
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
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
    listed = subprocess.run(["git", "ls-files", parent], cwd=ROOT, capture_output=True, text=True, check=True)
    below = [Path(file).relative_to(parent).parts for file in listed.stdout.splitlines()]
    drawing = CONTRIBUTING.split("```")[1]
    assert not {parts[0] for parts in below if len(parts) > 1 and f"{parts[0]}/" not in drawing}


def test_the_source_files_that_the_notes_name_exist() -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    files = [Path(file) for file in listed.stdout.splitlines()]
    for note in (file for file in files if file.suffix == ".md"):
        for name in re.findall(
            r"`([\w./*]+\.(?:cpp|hpp|py|js|css))`", (ROOT / note).read_text(encoding="utf-8")
        ):
            assert any(file.match(name) for file in files), f"{note}: {name}"
