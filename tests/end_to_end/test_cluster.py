"""A study through `sbatch`, on a SLURM of this machine alone, has the table of a local run, and no job outlives its night."""

from __future__ import annotations

import os
import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.analysis.nightly.kill_cluster_nights import (
    PROGRAMS,
    check_nothing_again,
    end,
    jobs,
    one_machine,
    start,
)
from tests.analysis.nightly.toy_repository import ToyRepository

pytestmark = pytest.mark.night

INTERRUPTED = 130


@pytest.fixture(scope="module")
def configuration() -> Iterator[str]:
    path = f"{os.environ['PATH']}:/usr/sbin"
    if missing := [name for name in PROGRAMS if shutil.which(name, path=path) is None]:
        pytest.skip(f"not installed: {', '.join(missing)}")
    with one_machine() as made:
        yield made


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> ToyRepository:
    """After a night on this machine's cores."""
    made = ToyRepository(tmp_path_factory.mktemp("here"), count=4)
    assert made.run("nightly").returncode == 0
    return made


def test_a_study_solved_through_sbatch_has_the_table_of_a_local_run(
    tmp_path: Path, configuration: str, here: ToyRepository
) -> None:
    cluster = ToyRepository(tmp_path / "on a cluster", count=4)
    done = cluster.run("nightly", "--profile", "slurm", "--job-seconds", "40", SLURM_CONF=configuration)
    assert done.returncode == 0, done.stderr
    log = (cluster.results / "snakemake.log").read_text()
    assert log.count("with external jobid") == 2
    assert cluster.table() == here.table()


def test_jobs_end_with_a_night_that_is_asked_to_end_and_before_what_follows_one_that_is_killed(
    tmp_path: Path, configuration: str, here: ToyRepository
) -> None:
    toy = ToyRepository(tmp_path / "killed", count=4)
    for number in (signal.SIGTERM, signal.SIGKILL):
        before, solved = toy.answers(), toy.solved()
        night = start(toy, configuration)
        while not jobs(toy, configuration, "running"):
            assert night.poll() is None
            time.sleep(0.1)
        end(toy, night, number, session=False)
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
