"""Enclosures of a study's cases without a machine against boundary elements: python3 -m tests.fem_reference.study_enclosures [STUDY] [--cases N].

`mpirun -n K` before it solves each case by K processes. Prints one line for each case, then the widths of the intervals and the errors of the best values in them. Fails when an enclosure
excludes every matrix within the error of boundary elements.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from analysis.pipeline.model_stage import model_module
from fem_reference.answer import reference
from geometries.studies import study
from geometries.studies.machines import NONE
from geometries.studies.study import Case

Array = NDArray[np.float64]

TRUTH_RTOL = 5e-6
"""Relative tolerance of the boundary elements, whose answer states the error reached."""


@dataclass(frozen=True)
class Outcome:
    """The comparison of one case: matrices (n, n) of the intervals' relative widths and of the best values' relative errors.

    An error is at least that of the boundary elements with which the value is compared.
    """

    inside: bool
    width: Array
    error: Array
    seconds: float
    """Processor time of the first process."""
    wall: float
    """Seconds by the clock."""


def outcome(case: Case) -> Outcome | None:
    """Solve and compare a case; the first of several processes compares, the others return None."""
    MPI.COMM_WORLD.barrier()
    clock, start = time.monotonic(), time.process_time()
    found = reference.maxwell(case.scene, source=case.id)
    seconds, wall = time.process_time() - start, time.monotonic() - clock
    if MPI.COMM_WORLD.rank > 0:
        return None
    with TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        scene.write_text(case.text, encoding="utf-8")
        known = model_module().Scene.load(scene).maxwell(rtol=TRUTH_RTOL)
    truth, slack = known["maxwell"], known["error"]
    inside = np.all(found.lower <= truth + slack) and np.all(truth - slack <= found.upper)
    off = np.maximum(np.abs(found.maxwell.value - truth), slack)
    width = (found.upper - found.lower) / np.abs(truth)
    return Outcome(bool(inside), width, off / np.abs(truth), seconds, wall)


def summary(outcomes: list[Outcome]) -> str:
    own = np.concatenate([np.diag(each.width) for each in outcomes])
    mutual = np.concatenate([each.width[np.triu_indices(len(each.width), 1)] for each in outcomes])
    times = np.concatenate([(each.width / each.error)[np.triu_indices(len(each.width))] for each in outcomes])
    lines = [
        f"{sum(each.inside for each in outcomes)} of {len(outcomes)} enclosed",
        f"own entries: median width {np.median(own):.1e}, widest {own.max():.1e}",
        f"best values: their errors are 1/{np.median(times):.0f} of the widths (median), 1/{times.min():.0f} at worst",
        f"processor time: median {np.median([each.seconds for each in outcomes]):.1f} s, "
        f"longest {max(each.seconds for each in outcomes):.0f} s",
        f"by the clock: median {np.median([each.wall for each in outcomes]):.1f} s, "
        f"longest {max(each.wall for each in outcomes):.1f} s",
    ]
    if len(mutual):
        lines.insert(2, f"mutuals: median width {np.median(mutual):.1e}, widest {mutual.max():.1e}")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", nargs="?", default="default")
    parser.add_argument("--cases", type=int, help="only so many of the first")
    options = parser.parse_args()
    outcomes = []
    cases = study.load(study.find(options.study)).cases()
    alone = (case for case in cases if case.parameters.get("machine", NONE) == NONE)
    for case in islice(alone, options.cases):
        found = outcome(case)
        if found is None:
            continue
        outcomes.append(found)
        word = "inside" if found.inside else "OUTSIDE"
        print(
            f"{case.id} {case.family}: {word}, widest {found.width.max():.1e}, {found.seconds:.1f} s, {found.wall:.1f} s by the clock",
            flush=True,
        )
    if outcomes:
        print(summary(outcomes))
    return 0 if all(each.inside for each in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
