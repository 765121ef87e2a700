"""`python3 -m tests.analysis.nightly.kill_nights`: kill nights at random times and see that nothing is lost and nothing is in the way.

Reference and model answer at once, and writing is slowed down, so that many kills fall into a write. Half of them hit the
process that the user has started, half of them all of its session. After each: no answer that was there is solved again, and
a night left alone ends well, with the table that an undisturbed one makes.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from tests.analysis.nightly.toy_repository import ToyRepository
from tests.waiting import DEADLINE

CASES = 8


@dataclass
class Tally:
    """How many kills there were, how many of them hit a night before its end, how many left an unfinished file, how many
    studies came to their end."""

    kills: int = 0
    before_the_end: int = 0
    during_a_write: int = 0
    studies: int = 0


def kill_nights(folder: Path, kills: int, seed: int) -> Tally:
    """Kill so many nights; AssertionError when something is wrong."""
    chance, tally = random.Random(seed), Tally()
    whole = _toy(folder / "undisturbed")
    start = time.monotonic()
    assert whole.run("nightly").returncode == 0
    duration = time.monotonic() - start
    toy = _toy(folder / "killed")
    while tally.kills < kills:
        before, solved = toy.answers(), toy.solved()
        _kill_one(toy, chance.uniform(0, duration), chance.random() < 0.5, tally)
        _check_nothing_again(toy, before, solved)
        if len(toy.answers()) == CASES + 1 or tally.kills == kills:
            _end(toy, whole, tally)
            shutil.rmtree(toy.results)
    return tally


def _toy(folder: Path) -> ToyRepository:
    toy = ToyRepository(folder, CASES)
    files = folder / "geometries" / "common" / "files.py"
    written = files.read_text()
    slow = written.replace(
        "        os.replace(", '        __import__("time").sleep(0.05)\n        os.replace('
    )
    assert slow != written
    files.write_text(slow)
    return toy


def _kill_one(toy: ToyRepository, seconds: float, all_of_it: bool, tally: Tally) -> None:
    process = toy.start("nightly", "--job-seconds", "20")
    time.sleep(seconds)
    tally.kills += 1
    tally.before_the_end += process.poll() is None
    if all_of_it:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    else:
        process.kill()
    # What it has started ends with it, and keeps these pipes open until then.
    process.communicate(timeout=DEADLINE)
    tally.during_a_write += any(path.name != ".lock" for path in toy.results.rglob(".*.*"))


def _check_nothing_again(toy: ToyRepository, before: set[str], solved: dict[str, int]) -> None:
    after = toy.solved()
    again = [case for case in before if after[case] != solved[case]]
    assert not again, f"solved again: {again}"


def _end(toy: ToyRepository, whole: ToyRepository, tally: Tally) -> None:
    """One night left alone."""
    before, solved = toy.answers(), toy.solved()
    done = toy.run("nightly")
    assert done.returncode == 0, done.stderr
    _check_nothing_again(toy, before, solved)
    assert toy.table() == whole.table()
    assert not list(toy.results.glob("cases/*/.*"))
    tally.studies += 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kill nights ") as folder:
        tally = kill_nights(Path(folder), options.kills, options.seed)
    print(
        f"{tally.kills} kills, {tally.before_the_end} before the night's end, {tally.during_a_write} left an unfinished file; "
        f"{tally.studies} studies came to their end with the table of an undisturbed night; nothing was solved again"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
