"""The field reference's answer for one case, from a process of its own."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from analysis.pipeline.keys import REPOSITORY
from analysis.pipeline.processes import Finished, Processes
from analysis.results.store import Document, write_json
from analysis.results.study_results import Failure
from geometries.common.installation import cache_folder
from geometries.studies.study import Study

SOLVE, SLICE = "reference", "slice of the potential"
# The reference's exit codes with an answer: within the asked accuracy, and short of it but with honest bounds.
_ANSWERED = (0, 3)
_CACHE = cache_folder()


def solve(scene: Path, target: Path, key: str, study: Study, processes: Processes) -> Failure | None:
    """Solve a scene file and store the answer with its key; returns why, when there is none."""
    asked = ["--rtol", repr(study.rtol), "--max-seconds", repr(study.max_seconds), "--error", study.error]
    finished = _run([str(scene.resolve()), *asked, "--json"], processes)
    if finished.exit_code not in _ANSWERED:
        return _failure(scene, SOLVE, finished)
    document = _parsed(finished.output)
    if document is None:
        return Failure(scene.parent.name, SOLVE, "printed no JSON document")
    write_json(target, {"key": key, **document})
    return None


def cut(scene: Path, target: Path, key: str, processes: Processes) -> Failure | None:
    """Store a slice of the potential around a scene with its key; returns why, when there is none."""
    unfinished = target.with_name(f".{target.name}.unfinished")
    try:
        finished = _run([str(scene.resolve()), "--slice", str(unfinished.resolve())], processes)
        if finished.exit_code not in _ANSWERED or not unfinished.is_file():
            return _failure(scene, SLICE, finished)
        document = _parsed(unfinished.read_text(encoding="utf-8"))
    finally:
        unfinished.unlink(missing_ok=True)
    if document is None:
        return Failure(scene.parent.name, SLICE, "wrote no JSON document")
    write_json(target, {"key": key, **document})
    return None


def forget_unfinished_forms(cache: Path = _CACHE) -> None:
    """Remove the marks of compilations that were killed: FFCx would wait for them in vain, in every later process."""
    for source in (cache / "fenics").glob("libffcx_*.c"):
        if not source.with_name(f"{source.name}.cached").exists():
            source.unlink(missing_ok=True)


def _run(arguments: list[str], processes: Processes) -> Finished:
    environment = os.environ | {
        # Each process has one core; the forms that it compiles are kept for the next.
        "OMP_NUM_THREADS": "1",
        "XDG_CACHE_HOME": str(_CACHE),
    }
    # In the repository's folder, because that is where `-m` looks first.
    return processes.run([sys.executable, "-m", "fem_reference", *arguments], REPOSITORY, environment)


def _parsed(text: str) -> Document | None:
    try:
        document = json.loads(text)
    except ValueError:
        return None
    return document if isinstance(document, dict) else None


def _failure(scene: Path, stage: str, finished: Finished) -> Failure:
    told = [line for line in finished.errors.splitlines() if line.strip()]
    reason = told[-1].strip() if told else "no message"
    return Failure(scene.parent.name, stage, f"exit code {finished.exit_code}: {reason}")
