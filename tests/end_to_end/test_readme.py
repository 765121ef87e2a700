"""The README's worked example is what the commands print today."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
VALUE_AND_ERROR = re.compile(r"(-?[\d.]+) ± ([\d.]+)")


def example(tmp_path: Path) -> Path:
    """The first TOML block of the README, as a file."""
    block = re.search(r"```toml\n(.*?)```", README, re.DOTALL)
    assert block is not None
    path = tmp_path / "hand.toml"
    path.write_text(block[1])
    return path


def printed_after(command: str) -> list[str]:
    """The lines of the README that follow a command, up to the end of its block."""
    lines = README.split(f"    $ {command}\n", 1)[1].split("\n\n", 1)[0].splitlines()
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
    assert len(expected) == len(found) == 5
    for (value, error), (new, _) in zip(expected, found):
        assert abs(float(new) - float(value)) <= float(error)


def test_the_differences_that_the_readme_states_follow_from_its_numbers() -> None:
    model = float(re.search(r"total +([\d.]+) pF", README)[1])  # type: ignore[index]
    values = VALUE_AND_ERROR.findall("\n".join(printed_after("python3 -m fem_reference hand.toml")))
    mutual, delta_self = -float(values[1][0]), float(values[4][0])
    assert f"= {mutual:.3f} pF: it is {100 * (1 - model / mutual):.0f} % low" in README
    assert (
        f"{delta_self:.3f} pF, of which the model is {100 * (model / delta_self - 1):.0f} % too high"
        in README
    )


def test_the_files_that_the_readme_links_exist() -> None:
    for target in re.findall(r"\]\(([^)]+)\)", README):
        assert (ROOT / target).exists(), target
