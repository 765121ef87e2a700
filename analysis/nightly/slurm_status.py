"""`python3 -m analysis.nightly.slurm_status JOB`: what Snakemake asks of a job of SLURM: success, failed or running.

SLURM's controller is asked; no accounting database is needed. A job that it knows nothing of has failed."""

from __future__ import annotations

import re
import subprocess
import sys

from geometries.common.children import ending_with_this

_ON_ITS_WAY = set(
    "PENDING CONFIGURING RUNNING COMPLETING SUSPENDED REQUEUED REQUEUE_HOLD RESIZING SIGNALING STAGE_OUT STOPPED".split()
)


def word(printed: str) -> str:
    """Translates what `scontrol --oneliner show job` prints into Snakemake's word for it."""
    state = re.search(r"\bJobState=(\w+)", printed)
    if state is None:
        return "failed"
    return "success" if state[1] == "COMPLETED" else "running" if state[1] in _ON_ITS_WAY else "failed"


if __name__ == "__main__":
    command = ["scontrol", "--oneliner", "show", "job", sys.argv[1]]
    print(word(subprocess.run(ending_with_this(command), capture_output=True, text=True, check=False).stdout))
