"""Boundary elements answer soups as clean conductors; `tests.model.random_soups` tries a thousand. And it sees what is wrong."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.model import random_soups
from tests.model.soups import Relation, random_case
from tests.waiting import DEADLINE

RTOL = 0.03


@pytest.mark.parametrize("number", [0, 3, 5, 6, 10, 14, 15, 18, 19, 25, 28])
def test_a_soup_is_answered_as_its_clean_conductor(number: int, tmp_path: Path) -> None:
    found = random_soups.outcome(number, 1, RTOL, tmp_path)
    assert (found.failure, found.reached) == ("", True), found.kinds


def test_these_scenes_have_conductors_of_every_relation() -> None:
    relations = {random_case(np.random.default_rng([1, number])).relation for number in (0, 3, 6)}
    assert relations == set(Relation)


ANSWER = {
    "maxwell": [[2.0, -1.0], [-1.0, 3.0]],
    "error": [[0.01, 0.01], [0.01, 0.01]],
    "lower_bounds": [True, False],
    "conductors": ["sensor", "body"],
    "sensors": [{"delta_self": 0.5, "delta_self_error": 0.01}],
}


def with_(place: tuple[int, int], difference: float) -> dict[str, Any]:
    values = np.array(ANSWER["maxwell"])
    values[place] += difference
    return {**ANSWER, "maxwell": values.tolist()}


@pytest.mark.parametrize(
    ("relation", "soup", "failure"),
    [
        (Relation.SAME, ANSWER, ""),
        (Relation.SAME, with_((0, 1), 0.019), ""),
        (Relation.SAME, with_((0, 1), 0.021), "differs"),
        (Relation.SAME, with_((0, 0), float("nan")), "an entry or error is not finite"),
        (Relation.SAME, {**ANSWER, "sensors": [{"delta_self": 0.53, "delta_self_error": 0.01}]}, "differs"),
        (Relation.LESS, with_((1, 1), -0.5), ""),
        (Relation.LESS, with_((1, 1), 0.021), "not less than the clean conductor"),
        (Relation.MORE, with_((1, 1), 0.5), ""),
        (Relation.MORE, with_((1, 1), -0.021), "not more than the clean conductor"),
        (Relation.MORE, {**ANSWER, "maxwell": [[2.0]]}, "1 conductors, not 2: ['sensor', 'body']"),
    ],
)
def test_a_wrong_answer_is_seen(relation: Relation, soup: dict[str, Any], failure: str) -> None:
    assert random_soups.compared(relation, ANSWER, soup)[1] == failure


@pytest.mark.parametrize(
    ("program", "failure"),
    [
        ("kill -SEGV $$", "soup ends with -11: "),
        (f"exec sleep {DEADLINE}", "soup hangs"),
        ("echo 'no such body' >&2; exit 2", "soup is refused: no such body"),
    ],
)
def test_crashes_hangs_and_refusals_are_failures(
    program: str, failure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command = tmp_path / "fringe"
    command.write_text(f"#!/bin/bash\n{program}\n")
    command.chmod(0o755)
    monkeypatch.setattr(random_soups, "COMMAND", command)
    monkeypatch.setattr(random_soups, "LONGEST", 0.5 if failure == "soup hangs" else DEADLINE)
    found = random_soups.outcome(1, 1, RTOL, tmp_path)
    assert found.failure == failure
    text = random_soups.summary([found, dataclasses.replace(found, failure="", ratio=0.5)])
    assert text.startswith("2 scenes, 1 answered, 1 failures")
