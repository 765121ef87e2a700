"""A study through `sbatch`, on a SLURM of this machine alone, has the table of a local run, and no job outlives its night."""

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from analysis.nightly import night
from tests.analysis.nightly.toy_repository import ROOT, ToyRepository
from tests.waiting import DEADLINE

pytestmark = pytest.mark.night

SCRIPT = ROOT / "tests" / "end_to_end" / "one_machine_slurm"
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")
INTERRUPTED = 130


@pytest.fixture(scope="module")
def configuration(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The SLURM_CONF of a SLURM of this machine."""
    path = f"{os.environ['PATH']}:/usr/sbin"
    if missing := [name for name in PROGRAMS if shutil.which(name, path=path) is None]:
        pytest.skip(f"not installed: {', '.join(missing)}")
    folder = tmp_path_factory.mktemp("slurm")
    subprocess.run([SCRIPT, "start", folder], check=True, timeout=DEADLINE)
    try:
        yield str(folder / "slurm.conf")
    finally:
        subprocess.run([SCRIPT, "stop", folder], check=True, timeout=DEADLINE)


def jobs(toy: ToyRepository, configuration: str, state: str = "all") -> list[str]:
    """The numbers of the study's jobs on the cluster that have not ended, or of those in a state."""
    asked = ["squeue", "--noheader", "--format=%i", f"--name={night.name_of_jobs(toy.results)}"]
    asked += [] if state == "all" else [f"--states={state}"]
    environment = os.environ | {"SLURM_CONF": configuration}
    told = subprocess.run(asked, env=environment, capture_output=True, text=True, check=True)
    return told.stdout.split()


def check_nothing_again(toy: ToyRepository, before: set[str], solved: dict[str, int]) -> None:
    """What had an answer was not solved again, and nothing twice at once."""
    after = toy.solved()
    again = [case for case in before if after[case] != solved[case]]
    assert not again, f"solved again: {again}"
    assert not toy.solved_twice_at_once()


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> ToyRepository:
    """After a night on this machine's cores."""
    made = ToyRepository(tmp_path_factory.mktemp("here"), count=4)
    assert made.run("nightly").returncode == 0
    return made


def test_a_study_solved_through_sbatch_has_the_table_of_a_local_run(
    tmp_path: Path, configuration: str, here: ToyRepository
) -> None:
    there = ToyRepository(tmp_path / "on a cluster", count=4)
    done = there.run("nightly", "--profile", "slurm", "--job-seconds", "40", SLURM_CONF=configuration)
    assert done.returncode == 0, done.stderr
    log = (there.results / "snakemake.log").read_text()
    assert log.count("with external jobid") == 2
    assert there.table() == here.table()


def test_jobs_end_with_a_night_that_is_asked_to_end_and_before_what_follows_one_that_is_killed(
    tmp_path: Path, configuration: str, here: ToyRepository
) -> None:
    toy = ToyRepository(tmp_path / "killed", count=4)
    for number in (signal.SIGTERM, signal.SIGKILL):
        before, solved = toy.answers(), toy.solved()
        # Solves that are long beside what starting a job takes, so that signals meet jobs at work.
        more = {"SLURM_CONF": configuration, "TOY_SECONDS": "1"}
        night = toy.start("nightly", "--profile", "slurm", "--job-seconds", "40", **more)
        while not jobs(toy, configuration, "running"):
            assert night.poll() is None
            time.sleep(0.1)
        night.send_signal(number)
        night.communicate(timeout=DEADLINE)
        check_nothing_again(toy, before, solved)
        if number == signal.SIGTERM:
            assert night.returncode == INTERRUPTED and not jobs(toy, configuration)
    assert jobs(toy, configuration)
    before, solved = toy.answers(), toy.solved()
    next_ = toy.run("nightly", SLURM_CONF=configuration)
    assert next_.returncode == 0, next_.stderr
    assert not jobs(toy, configuration)
    check_nothing_again(toy, before, solved)
    assert toy.table() == here.table()
