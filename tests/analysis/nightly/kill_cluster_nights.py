"""`python3 -m tests.analysis.nightly.kill_cluster_nights`: kill nights on a cluster, a SLURM of this machine alone, and see that no job
outlives its night for long: none is left when a night was asked to end, none solves what the next night solves.

Half of the signals ask (SIGTERM, SIGINT), half kill (SIGKILL, the night's process or all of its session). Nothing that is finished is
solved again, and a night left alone ends with the table that an undisturbed one makes.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from analysis.nightly import cluster
from tests.analysis.nightly.toy_repository import ROOT, ToyRepository
from tests.waiting import DEADLINE

SCRIPT = ROOT / "tests" / "end_to_end" / "one_machine_slurm"
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")
CASES = 8
_SIGNALS_OF_A_STUDY = 10
# Long beside what starting a job takes, so that signals meet jobs at work.
_SOLVE_SECONDS = "1"
_INTERRUPTED = 130


@dataclass
class Tally:
    """How many signals there were, how many came while jobs were on the cluster, how many left jobs behind, how many studies came to
    their end."""

    signals: int = 0
    during_jobs: int = 0
    left_jobs: int = 0
    studies: int = 0


@contextmanager
def one_machine() -> Iterator[str]:
    """A SLURM of this machine; its SLURM_CONF."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([SCRIPT, "start", folder], check=True, timeout=DEADLINE)
        try:
            yield str(Path(folder, "slurm.conf"))
        finally:
            subprocess.run([SCRIPT, "stop", folder], check=True, timeout=DEADLINE)


def start(toy: ToyRepository, configuration: str) -> subprocess.Popen[str]:
    """A night on the cluster whose solves take a while, in jobs of a few cases."""
    return toy.start(
        *("nightly", "--profile", "slurm", "--job-seconds", "40"),
        SLURM_CONF=configuration,
        TOY_SECONDS=_SOLVE_SECONDS,
    )


def jobs(toy: ToyRepository, configuration: str, state: str = "all") -> list[str]:
    """The numbers of the study's jobs on the cluster that have not ended, or of those in a state."""
    asked = ["squeue", "--noheader", "--format=%i", f"--name={cluster.name(toy.results)}"]
    asked += [] if state == "all" else [f"--states={state}"]
    told = subprocess.run(
        asked, env=os.environ | {"SLURM_CONF": configuration}, capture_output=True, text=True, check=True
    )
    return told.stdout.split()


def end(toy: ToyRepository, process: subprocess.Popen[str], number: signal.Signals, session: bool) -> None:
    """Send a night a signal, or all of its session, and wait for its end."""
    if process.poll() is None:
        if session:
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)
    process.communicate(timeout=DEADLINE)


def kill_nights(folder: Path, configuration: str, signals: int, seed: int) -> Tally:
    """Send nights so many signals; AssertionError when something is wrong."""
    chance, tally = random.Random(seed), Tally()
    whole, toy = (ToyRepository(folder / name, CASES) for name in ("undisturbed", "killed"))
    assert whole.run("nightly").returncode == 0
    begun = time.monotonic()
    while tally.signals < signals:
        before, solved = toy.answers(), toy.solved()
        earlier = set(jobs(toy, configuration))
        process = start(toy, configuration)
        _wait_for_jobs(toy, configuration, process)
        time.sleep(chance.uniform(0, 6))
        ask = chance.random() < 0.5
        number = chance.choice([signal.SIGTERM, signal.SIGINT]) if ask else signal.SIGKILL
        tally.signals += 1
        tally.during_jobs += bool(jobs(toy, configuration)) and process.poll() is None
        end(toy, process, number, session=not ask and chance.random() < 0.5)
        left = jobs(toy, configuration)
        if ask:
            # A signal before the night has begun ends nothing but the night.
            assert set(left) <= earlier, f"left after {number.name}: {left}, earlier {earlier}"
            assert process.returncode in (0, _INTERRUPTED, -number), process.returncode
        tally.left_jobs += bool(left)
        check_nothing_again(toy, before, solved)
        if (
            len(toy.answers()) == CASES + 1
            or tally.signals % _SIGNALS_OF_A_STUDY == 0
            or tally.signals == signals
        ):
            _finish(toy, whole, configuration)
            shutil.rmtree(toy.results)
            tally.studies += 1
        print(f"{tally}, {time.monotonic() - begun:.0f} s", file=sys.stderr)
    return tally


def check_nothing_again(toy: ToyRepository, before: set[str], solved: dict[str, int]) -> None:
    """What had an answer was not solved again, and nothing twice at once."""
    after = toy.solved()
    again = [case for case in before if after[case] != solved[case]]
    assert not again, f"solved again: {again}"
    assert not toy.solved_twice_at_once()


def _wait_for_jobs(toy: ToyRepository, configuration: str, process: subprocess.Popen[str]) -> None:
    """Return when a job of the night runs, or the night has ended."""
    while process.poll() is None and not jobs(toy, configuration, "running"):
        time.sleep(0.1)


def _finish(toy: ToyRepository, whole: ToyRepository, configuration: str) -> None:
    """One night left alone."""
    before, solved = toy.answers(), toy.solved()
    done = toy.run("nightly", "--profile", "slurm", SLURM_CONF=configuration)
    assert done.returncode == 0, done.stderr
    check_nothing_again(toy, before, solved)
    assert not jobs(toy, configuration)
    assert toy.table() == whole.table()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--signals", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kill nights ") as folder, one_machine() as configuration:
        tally = kill_nights(Path(folder), configuration, options.signals, options.seed)
    print(
        f"{tally.signals} signals, {tally.during_jobs} while jobs were on the cluster, {tally.left_jobs} left jobs behind; "
        f"{tally.studies} studies came to their end with the table of an undisturbed night; nothing was solved again or twice at once"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
