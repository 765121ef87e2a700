"""`python3 -m tests.faults.run`: disturb a study in every way, again and again, and write down how often, and what held.

Reference and model answer at once; the commands and all that is written are the real ones. The counts go to results/faults/faults.json.
"""

from __future__ import annotations

import argparse
import random
import shutil
import sys
import tempfile
import time
from dataclasses import asdict
from pathlib import Path

from analysis.results.store import write_json
from tests.analysis.nightly.toy_repository import ROOT, ToyRepository
from tests.faults.harness import CASES, Study, Tally, make_slower
from tests.faults.kinds import KINDS


def prepare(folder: Path) -> Study:
    """The study, and the table of an undisturbed run."""
    toy = ToyRepository(folder / "disturbed", CASES)
    make_slower(toy)
    study = Study(toy, "", 0)
    start = time.monotonic()
    done = study.finish(study.start())
    assert done.returncode == 0, done.stderr
    study.seconds = time.monotonic() - start
    study.table = toy.table()
    shutil.rmtree(toy.results)
    return study


def disturb(study: Study, kind: str, rounds: int, seed: int) -> Tally:
    """So many faults of one kind; AssertionError when something is wrong. The answers of one fault are what the next finds."""
    chance, tally = random.Random(seed), Tally()
    make = next(fault for fault in KINDS if fault.__name__ == kind)
    for _ in range(rounds):
        if chance.random() < 0.7:
            shutil.rmtree(study.toy.results, ignore_errors=True)
        tally.rounds += 1
        make(study, chance, tally)
        if tally.skipped:
            tally.rounds = 0
            break
    return tally


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=20, help="faults of each kind (default 20)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", default=[fault.__name__ for fault in KINDS])
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "faults" / "faults.json")
    options = parser.parse_args()
    counts = {}
    with tempfile.TemporaryDirectory(prefix="disturbed studies ") as folder:
        study = prepare(Path(folder))
        for kind in options.kinds:
            tally = disturb(study, kind, options.rounds, options.seed)
            told = sorted(sentence.replace(folder, "…") for sentence in tally.sentences)
            counts[kind] = asdict(tally) | {"sentences": told[:3]}
            print(
                f"{kind}: {tally.skipped or f'{tally.rounds} times, {tally.during_the_run} during the run, {tally.told} told, '}"
                f"{tally.unfinished_files} unfinished files, {tally.completed_afterwards} completed afterwards",
                flush=True,
            )
            write_json(options.output, {"seed": options.seed, "kinds": counts})
    return 0


if __name__ == "__main__":
    sys.exit(main())
