"""A study through `sbatch`, on a SLURM of this machine alone, has the table of a local run."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.analysis.nightly.toy_repository import ToyRepository

SCRIPT = Path(__file__).parent / "one_machine_slurm"
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")


@pytest.fixture
def configuration() -> Iterator[Path]:
    path = f"{os.environ['PATH']}:/usr/sbin"
    if missing := [name for name in PROGRAMS if shutil.which(name, path=path) is None]:
        pytest.skip(f"not installed: {', '.join(missing)}")
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([SCRIPT, "start", folder], check=True, timeout=60)
        try:
            yield Path(folder, "slurm.conf")
        finally:
            subprocess.run([SCRIPT, "stop", folder], check=True, timeout=60)


def test_a_study_solved_through_sbatch_has_the_table_of_a_local_run(
    tmp_path: Path, configuration: Path
) -> None:
    here, cluster = (ToyRepository(tmp_path / name, count=4) for name in ("here", "on a cluster"))
    assert here.run("nightly").returncode == 0
    done = cluster.run("nightly", "--profile", "slurm", "--job-seconds", "40", SLURM_CONF=str(configuration))
    assert done.returncode == 0, done.stderr
    log = (cluster.results / "snakemake.log").read_text()
    assert log.count("with external jobid") == 2
    assert cluster.table() == here.table()
