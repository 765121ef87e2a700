"""The table of machines: the scenes it names, its intervals, boundary elements inside of them, and the page, which tells what is stored."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis import __main__ as command_line
from analysis.topics.verification import machines
from geometries.scene.writer import identity

ANSWERS = machines.stored()


def test_the_page_tells_what_is_stored_of_the_scenes_as_they_are() -> None:
    known = {machine.name: machine for machine in machines.machines()}
    assert ANSWERS and set(ANSWERS) <= set(known)
    assert machines.TABLE.read_text(encoding="utf-8") == machines.page(ANSWERS)
    for name, answer in ANSWERS.items():
        assert answer["scene"] == identity(known[name].scene), name


@pytest.mark.parametrize("name", ANSWERS)
def test_every_value_is_in_its_interval(name: str) -> None:
    for quantity in ANSWERS[name]["quantities"]:
        assert quantity["error"] >= 0
        if quantity["lower"] is not None:
            assert quantity["lower"] <= quantity["value"] <= quantity["upper"], quantity["name"]


@pytest.mark.parametrize("name", [name for name in ANSWERS if "boundary_elements" in ANSWERS[name]])
def test_boundary_elements_agree(name: str) -> None:
    """Both state an error: the intervals overlap, and so do the stated errors."""
    enclosed = {quantity["name"]: quantity for quantity in ANSWERS[name]["quantities"]}
    for known in ANSWERS[name]["boundary_elements"]:
        quantity, value, error = enclosed[known["name"]], known["value"], known["error"]
        assert quantity["lower"] <= value + error and value - error <= quantity["upper"], known["name"]
        assert abs(quantity["value"] - value) <= quantity["error"] + error, known["name"]


def test_a_machine_that_is_unknown_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert command_line.main(["measure", "machines", "no such machine"]) == 2
    assert "there are housing" in capsys.readouterr().err


def test_a_scene_can_be_printed(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert command_line.main(["measure", "machines", "--scene", "housing"]) == 0
    (tmp_path / "scene.toml").write_text(capsys.readouterr().out, encoding="utf-8")
    assert identity(machines.load(tmp_path / "scene.toml")) == identity(machines.machines()[0].scene)
