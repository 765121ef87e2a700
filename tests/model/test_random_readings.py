"""The reduced method's errors of changes are errors; `tests.model.random_readings` tries 171 machines."""

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.model import random_readings
from tests.model.random_readings import Compared


@pytest.mark.parametrize("number", [12, 18, 35, 39, 60, 79, 92])
def test_changes_are_within_their_errors(number: int, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(random_readings.random_scene(number, 1))
    found = random_readings.outcomes(path)
    assert found and all(one.ratio <= 1 for one in found), found


def reading(value: float, change: float, error: float) -> SimpleNamespace:
    errors = {"value": 0.1, "background": 0.1, "change": error}
    return SimpleNamespace(value=value, background=value - change, change=change, error=errors)


def test_a_change_beyond_its_error_is_seen() -> None:
    truth = reading(10, 0.5, 0.001)
    right = random_readings.compared("self", "reduced, 0.01", reading(10, 0.505, 0.01), truth)
    assert right.ratio < 1 and right.stated == pytest.approx(0.02) and right.difference == pytest.approx(0.01)
    wrong = random_readings.compared("self", "reduced, 0.01", reading(10, 0.52, 0.01), truth)
    assert wrong.ratio > 1


def test_the_summary_counts_what_is_wrong() -> None:
    right = Compared("self", "reduced, 0.01", change=1e-13, stated=0.02, difference=0.01, ratio=0.5)
    wrong = dataclasses.replace(right, ratio=1.5)
    text = random_readings.summary([right, right, wrong], "reduced, 0.01")
    assert "3 readings, 1 wrong, largest ratio 1.50; stated % median 2" in text


def test_machines_of_every_kind_are_drawn() -> None:
    scenes = [random_readings.random_scene(number, 1) for number in range(40)]
    for part in ("guard", "housing", "table", "side", "foil", "sphere", "to_ground"):
        share = np.mean([part in scene for scene in scenes])
        assert 0.1 < share < 0.9, part
