"""One fault of a few kinds; the others, and again and again: python3 -m tests.faults.run."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from analysis.report import faults_section
from tests.faults.harness import Study, wait_until_at_work
from tests.faults.run import disturb, prepare
from tests.waiting import DEADLINE


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return prepare(tmp_path_factory.mktemp("disturbed studies"))


@pytest.mark.night
@pytest.mark.parametrize("kind", ["interrupted"])
def test_nothing_is_lost_it_is_told_and_the_next_run_completes(study: Study, kind: str) -> None:
    tally = disturb(study, kind, rounds=1, seed=1)
    assert (tally.rounds, tally.told, tally.completed_afterwards) == (1, 1, 1)


@pytest.mark.night
def test_a_lock_that_is_left_behind_is_not_one_that_is_held(study: Study) -> None:
    """The run that came first goes on, the second is refused, although the file of the lock was there before both."""
    study.toy.results.mkdir(parents=True, exist_ok=True)
    (study.toy.results / ".lock").touch()
    # Without work the first one would be at its end before the second comes.
    for answer in study.toy.results.glob("cases/*/fem.json"):
        answer.unlink()
    first = study.start(TOY_SECONDS=str(2 * DEADLINE))
    wait_until_at_work(first)
    assert first.poll() is None
    second = study.finish(study.start())
    assert (second.returncode, first.poll()) == (1, None) and "in use" in second.stderr
    os.killpg(first.pid, signal.SIGKILL)
    first.communicate(timeout=DEADLINE)


def test_the_report_says_what_was_counted(tmp_path: Path) -> None:
    counts = {
        "rounds": 3,
        "during_the_run": 2,
        "told": 3,
        "unfinished_files": 1,
        "completed_afterwards": 3,
        "skipped": "",
        "sentences": ["analysis: stopped"],
    }
    text = faults_section.section(
        {"seed": 1, "kinds": {"killed": counts, "no_space": counts | {"rounds": 0}}}
    )
    assert "Of 3 faults, 2 while the study ran" in text and "SIGKILL" in text and "stopped" in text
    assert faults_section.beside(tmp_path / "study") is None
