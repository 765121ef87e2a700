"""`python3 -m analysis measure planning`: how long planning 100,000 cases takes, and a night on 500 cases without work.

The first is everything up to Snakemake's first job: reading the study, its keys, looking for stored answers, the jobs' files, and
Snakemake's own plan; once with nothing stored and once, up to the finding that nothing is to do, with everything stored.
The second is the whole command, report and history included. The answers are made up; nothing is solved.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from analysis.nightly import night
from analysis.nightly.chunks import Chunk
from analysis.results import study_results as results
from analysis.results.store import write_json, write_text
from analysis.results.units import PICOFARAD
from analysis.study import plan
from geometries.common.children import ending_with_this, temporary_folder
from geometries.common.installation import ROOT
from geometries.studies import study

_STUDY = """
name = "planned"
title = "Made-up cases for planning"
[reference]
rtol = 1e-3
max_seconds = 60
[model]
methods = ["exact"]
[[sweep]]
family = "inclined"
sensor_size = [0.1, 0.1]
target_size = [0.1, 0.1]
hinge_gap = {{ linspace = [0.01, 0.1, {gaps}] }}
tilt_degrees = {{ linspace = [5, 85, {tilts}] }}
"""
_JOB_SECONDS, _WORKERS = 600.0, 200


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds how many cases."""
    parser.add_argument("--planned", type=int, default=100_000, help="cases to plan (default 100000)")
    parser.add_argument("--idle", type=int, default=500, help="cases of the night without work (default 500)")


def measure(options: argparse.Namespace) -> int:
    """Prints the times."""
    with temporary_folder() as folder:
        for what, seconds in _planning(folder, options.planned):
            print(f"planning {options.planned} cases, {what} stored: {seconds}", flush=True)
        print(f"a night on {options.idle} cases without work: {_idle(folder, options.idle)}")
    return 0


def _planning(folder: Path, count: int) -> Iterator[tuple[str, str]]:
    text, place = _text(count), folder / "planned"

    def fresh() -> None:
        chosen = study.loads(text)
        works = plan.missing(chosen, chosen.cases(), place)
        jobs = night.prepare(works, chosen, place, _JOB_SECONDS, _WORKERS)
        _plan_of_snakemake(place, jobs)

    def stored() -> None:
        chosen = study.loads(text)
        assert not plan.missing(chosen, chosen.cases(), place)

    yield "nothing", _timed(fresh)
    _answer(text, place)
    yield "everything", _timed(stored)


def _plan_of_snakemake(place: Path, jobs: list[Chunk]) -> None:
    """Lets Snakemake go through its whole plan without starting a job."""
    command = [*night.command(place, None, _WORKERS), "--dry-run", "--quiet"]
    done = subprocess.run(ending_with_this(command), cwd=ROOT, capture_output=True, text=True, check=True)
    assert any(line.split()[:2] == ["solve", str(len(jobs))] for line in done.stdout.splitlines())


def _idle(folder: Path, count: int) -> str:
    text, place = _text(count), folder / "idle"
    (folder / "study.toml").write_text(text, encoding="utf-8")
    _answer(text, place)
    command = [
        sys.executable,
        "-m",
        "analysis",
        "nightly",
        str(folder / "study.toml"),
        "--results",
        str(place),
    ]

    def run() -> None:
        subprocess.run(ending_with_this(command), cwd=ROOT, check=True, capture_output=True)

    # The first run makes the report.
    run()
    return _timed(run)


def _text(count: int) -> str:
    tilts = max(2, min(100, count // 2))
    return _STUDY.format(gaps=count // tilts, tilts=tilts)


def _answer(text: str, place: Path) -> None:
    """Stores a made-up answer for everything that is missing."""
    chosen = study.loads(text)
    for work in plan.missing(chosen, chosen.cases(), place):
        case = results.case_folder(place, work.case)
        write_text(case / results.SCENE, work.scene)
        bodies = 2 if results.MODEL in work.keys else 1
        made_up: dict[str, dict[str, object]] = {
            results.REFERENCE: _reference(bodies),
            results.MODEL: _model(),
            results.SLICE: _slice(),
            results.BOUNDARY: {"refused": "made up"},
        }
        for file, key in work.keys.items():
            write_json(case / file, {"key": key, **made_up[file]})


def _reference(bodies: int) -> dict[str, object]:
    matrix = [
        [(4.0 if row == column else -2.0) * PICOFARAD for column in range(bodies)] for row in range(bodies)
    ]
    error = [[0.01 * PICOFARAD] * bodies] * bodies
    return {
        "conductors": ["sensor", "target"][:bodies],
        "maxwell": matrix,
        "error": error,
        "delta_self": {"sensor": {"value": PICOFARAD, "error": 0.01 * PICOFARAD}} if bodies == 2 else {},
        "levels": [{"unknowns": 1000, "seconds": 1.0, "maxwell": matrix}] * 3,
        "unknowns": 1000,
        "seconds": 1.0,
        "reached": True,
        "method": "made up",
        "error_kind": "estimate",
        "versions": {},
    }


def _model() -> dict[str, object]:
    sensor = {
        "name": "sensor",
        "total": 2 * PICOFARAD,
        "objects": [{"name": "target", "capacitance": 2 * PICOFARAD}],
    }
    return {"version": "made up", "methods": {"exact": {"seconds": 1e-6, "sensors": [sensor]}}}


def _slice() -> dict[str, object]:
    plane = {"origin": [0.0, 0.0], "direction": [1.0, 0.0]}
    return plane | {"along": [-0.1, 0.1], "z": [-0.1, 0.1], "potential": [[0.0, 1.0], [1.0, 0.0]]}


def _timed(work: Callable[[], None]) -> str:
    """Returns the elapsed seconds and the processor seconds, here and in processes that were started."""
    start, before = time.monotonic(), os.times()
    work()
    seconds, after = time.monotonic() - start, os.times()
    busy = sum(after[:4]) - sum(before[:4])
    return f"{seconds:.1f} s, of which a processor worked {busy:.1f} s"
