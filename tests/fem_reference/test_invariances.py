"""Changes that must not matter to an answer do not: a dozen of the random scenes of `invariances`, each of which takes seconds."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.by_night import all_but
from tests.fem_reference.invariances import compared, random_scene, written_prism

# Scenes in free space and in rooms, with zero to two planes of symmetry and one to three conductors; every change, bounds and estimates.
NUMBERS = (8, 16, 9, 10, 51, 93, 21, 30, 22, 31, 15, 68)
SEED = 1


@pytest.mark.parametrize("number", all_but(NUMBERS[:2], NUMBERS))
def test_answers_that_have_to_agree_do(number: int, tmp_path: Path) -> None:
    scene = random_scene(number, SEED, written_prism(tmp_path / "prism.obj"))
    found = compared(scene, number, tmp_path)
    assert found is not None and found.pairs >= 1
    assert not found.disagree
