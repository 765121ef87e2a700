"""`run` from the command line, with a stand-in for the reference: what is solved, kept, reported, and stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import __main__ as command_line
from analysis.pipeline import model_stage, processes, scheduler
from analysis.pipeline.stage import Stage
from analysis.results import store, study_results as results
from analysis.study import report
from tests import scenes
from tests.analysis.synthetic import EDGE, HEAD, PARALLEL, model_document
from tests.waiting import DEADLINE, has_ended, wait_until

# Answers at once, and writes down that it was asked; some heights of the target make it fail.
STAND_IN = """
import json, sys, time, tomllib
from pathlib import Path
sys.path.insert(0, {repository!r})
from tests.analysis.synthetic import empty_document, reference_document
scene = tomllib.loads(Path(sys.argv[1]).read_text())
with open({log!r}, "a") as log:
    log.write(Path(sys.argv[1]).parent.name + "\\n")
height = scene["object"][0]["translation"][2] if "object" in scene else None
if "--slice" in sys.argv:
    sys.exit(1)
if height == 0.04:
    print("cannot mesh this", file=sys.stderr)
    sys.exit(1)
document = empty_document() if height is None else reference_document(2, 1, reached=height != 0.03)
print(json.dumps(document))
sys.exit(0 if document["reached"] else 3)
"""


class Model:
    """Stands in for the model's module."""

    __version__ = "0.1.0"
    InterruptionScope = nullcontext

    @staticmethod
    def plate_integral(triangles: Any, *plate: Any) -> Any:
        return np.ones(len(triangles))

    class Scene:
        @staticmethod
        def load(path: str) -> Any:
            return Model.Scene()

        def capacitance(self, method: str) -> dict[str, Any]:
            answer: dict[str, Any] = model_document(1.8)["methods"][method]
            return {**answer, "readings": []}

        def maxwell(self, rtol: float) -> dict[str, Any]:
            raise ValueError("a stand-in knows no boundary elements")


class Workplace:
    """A study file, a results folder, and the stand-in's log."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.log = folder / "asked.txt"

    def run(self, sweeps: str) -> int:
        study = self.folder / "study.toml"
        study.write_text(HEAD + sweeps)
        return command_line.main(
            ["run", str(study), "--results", str(self.folder / "results"), "--jobs", "2"]
        )

    def solved(self) -> int:
        """How often the reference was asked for an answer or a slice since the last time this was called."""
        count = len(self.log.read_text().splitlines()) if self.log.is_file() else 0
        self.log.unlink(missing_ok=True)
        return count


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workplace:
    workplace = Workplace(tmp_path / "with space")
    module = workplace.folder / "repository" / "fem_reference.py"
    module.parent.mkdir(parents=True)
    repository = str(processes.ROOT)
    module.write_text(STAND_IN.format(repository=repository, log=str(workplace.log)))
    monkeypatch.setattr(processes, "ROOT", module.parent)
    monkeypatch.setattr(model_stage, "model_module", lambda: Model)
    return workplace


TWO = PARALLEL.replace("[0.01, 0.02, 0.04]", "[0.01, 0.02]")
SLICES = 2  # one for each case


def test_a_study_is_solved_reported_and_told(place: Workplace, capsys: pytest.CaptureFixture[str]) -> None:
    assert place.run(TWO) == 0
    printed = capsys.readouterr().out
    assert "mutual      model error over 2 cases: rms 10.0%" in printed
    assert f"report: {place.folder / 'results' / 'report.html'}" in printed
    assert (place.folder / "results" / "table.csv").read_text().count("\n") == 5


def test_the_report_is_there_before_pictures_are_solved_for(
    place: Workplace, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[int] = []

    def make(folder: Path) -> report.Report:
        asked.append(place.solved())
        return report.Report(folder / "report.html", [], 0, 0, 0, [])

    monkeypatch.setattr(report, "make", make)
    place.run(TWO)
    assert asked == [3, SLICES]
    printed = capsys.readouterr().out
    assert printed.index("can be read now") < printed.index("report: ")


def test_a_second_run_solves_nothing_that_is_answered(place: Workplace) -> None:
    place.run(TWO)
    assert place.solved() == 3 + SLICES
    place.run(TWO)
    assert place.solved() == SLICES  # what failed is tried again


def test_a_changed_family_solves_only_its_new_cases(place: Workplace) -> None:
    place.run(TWO + EDGE)
    place.solved()
    place.run(TWO.replace("0.02", "0.025") + EDGE)
    assert place.solved() == 1 + 2 * SLICES


def test_a_failing_case_is_told_and_the_others_go_on(
    place: Workplace, capsys: pytest.CaptureFixture[str]
) -> None:
    assert place.run(PARALLEL) == 1
    assert "reference: exit code 1: cannot mesh this" in capsys.readouterr().err
    found = results.load(place.folder / "results")
    assert ("reference", "exit code 1: cannot mesh this") in {(f.stage, f.reason) for f in found.failures}
    assert [case.reference is not None for case in found.compared()] == [True, True, False]


def test_an_accuracy_not_reached_is_an_answer_and_told(
    place: Workplace, capsys: pytest.CaptureFixture[str]
) -> None:
    place.run(TWO.replace("0.02", "0.03"))
    assert "1 cases are short of the asked accuracy" in capsys.readouterr().out
    assert command_line.main(["report", str(place.folder / "results")]) == 3


def test_a_missing_picture_is_told_but_is_no_failed_run(
    place: Workplace, capsys: pytest.CaptureFixture[str]
) -> None:
    assert place.run(TWO) == 0
    assert "slice of the potential: exit code 1" in capsys.readouterr().err


def test_every_case_folder_holds_whole_files_only(place: Workplace) -> None:
    place.run(TWO)
    names = {path.name for path in (place.folder / "results" / "cases").glob("*/*")}
    assert names == {"scene.toml", "fem.json", "model.json", "boundary.json", "case.html"}


def test_wrong_input_ends_with_code_2_and_a_message(
    place: Workplace, capsys: pytest.CaptureFixture[str]
) -> None:
    assert place.run(TWO + "colour = 3") == 2
    printed = capsys.readouterr()
    assert "sweep[0].colour: unknown key" in printed.err and not printed.out
    assert not (place.folder / "results").exists()


def test_stopping_kills_the_running_processes_and_their_children(tmp_path: Path) -> None:
    """A job's process starts a child; neither ends by itself before the test gives up, and both must be gone."""
    pids = tmp_path / "pids"
    script = textwrap.dedent(
        f"""
        import os, subprocess, time
        child = subprocess.Popen(["sleep", "{2 * DEADLINE}"])
        open({str(pids)!r}, "w").write(f"{{os.getpid()}} {{child.pid}}")
        time.sleep({2 * DEADLINE})
        """
    )

    def sleep(of: processes.Processes) -> store.Document:
        of.run([sys.executable, "-c", script], tmp_path, dict(os.environ))
        return {}

    def interrupt(of: processes.Processes) -> store.Document:
        wait_until(lambda: pids.is_file() and len(pids.read_text().split()) == 2, "the start of the job")
        raise KeyboardInterrupt

    def job(name: str, seconds: float, answer: Callable[[processes.Processes], store.Document]) -> Stage:
        return Stage(name, "", tmp_path / name, "key", seconds, answer)

    with pytest.raises(KeyboardInterrupt):
        scheduler.run_all([job("first", 2, sleep), job("second", 1, interrupt)], workers=2)
    for pid in pids.read_text().split():
        wait_until(lambda: has_ended(pid), f"the end of process {pid}")


def test_stopping_ends_what_the_jobs_compute_themselves(tmp_path: Path) -> None:
    """Boundary elements to 1e-5 of many triangles would take minutes."""
    module = model_stage.model_module()
    text = scenes.body("ball", "sphere", radius=1, segments=40, potential="electrode")
    begun, ended = threading.Event(), threading.Event()

    def compute(_: processes.Processes) -> store.Document:
        begun.set()
        try:
            module.Scene.loads(text).maxwell(rtol=1e-5)
        except processes.Stopped:
            ended.set()
            raise
        return {}

    def interrupt(_: processes.Processes) -> store.Document:
        begun.wait()
        raise KeyboardInterrupt

    jobs = [
        Stage("first", "", tmp_path / "first", "key", 2, compute),
        Stage("second", "", tmp_path / "second", "key", 1, interrupt),
    ]
    with pytest.raises(KeyboardInterrupt):
        scheduler.run_all(jobs, workers=2)
    assert ended.is_set()


def test_a_terminated_run_says_so_and_keeps_what_is_finished(tmp_path: Path) -> None:
    """SIGTERM to the command line itself, in a process of its own."""
    program = textwrap.dedent(
        f"""
        import sys, time
        from analysis import __main__ as command_line
        from analysis.study import workflow
        def run(*options):
            print("running", flush=True)
            time.sleep({2 * DEADLINE})
        workflow.run = run
        sys.exit(command_line.main(["run", "smoke", "--results", {str(tmp_path)!r}]))
        """
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=processes.ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None and process.stdout.readline() == "running\n"
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=DEADLINE)
    assert process.returncode == 130
    assert errors.strip() == "analysis: stopped; finished cases are kept, the same command goes on from there"


def test_a_compilation_that_was_killed_is_forgotten_and_a_finished_one_kept(tmp_path: Path) -> None:
    for name in ("libffcx_forms_a.c", "libffcx_forms_a.c.cached", "libffcx_forms_b.c"):
        store.write_text(tmp_path / "fenics" / name, "")
    processes.forget_unfinished_forms(tmp_path)
    assert {path.name for path in (tmp_path / "fenics").iterdir()} == {
        "libffcx_forms_a.c",
        "libffcx_forms_a.c.cached",
    }


def test_the_remaining_time_follows_the_pace_so_far_and_before_that_the_expected_seconds() -> None:
    assert scheduler.remaining_seconds(total=100, done=25, elapsed=10, workers=2) == pytest.approx(30)
    assert scheduler.remaining_seconds(total=100, done=0, elapsed=10, workers=2) == pytest.approx(40)
    assert scheduler.remaining_seconds(total=100, done=0, elapsed=60, workers=2) == 0
