"""`run` from the command line, with a stand-in for the reference: what is solved, kept, reported, and stopped."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from analysis.pipeline import model_stage, scheduler, stage
from analysis.pipeline.stage import Stage
from analysis.results import store, study_results as results
from analysis.study import report
from tests import scenes
from tests.analysis.nightly.toy_repository import MODEL, REFERENCE, ROOT
from tests.analysis.synthetic import EDGE, HEAD, PARALLEL
from tests.programs import analysis
from tests.waiting import DEADLINE, has_ended, wait_until


class Workplace:
    """A study file, a results folder, and what stands in for the reference."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.repository = folder / "repository"
        self.results = folder / "results"

    def run(self, sweeps: str, status: int = 0) -> subprocess.CompletedProcess[str]:
        study = self.folder / "study.toml"
        study.write_text(HEAD + sweeps)
        return analysis("run", study, "--results", self.results, "--jobs", 2, status=status)

    def solved(self) -> int:
        """How often the reference has answered since the last time this was called."""
        log = self.repository / "solved.txt"
        count = len(log.read_text().splitlines()) if log.is_file() else 0
        log.unlink(missing_ok=True)
        return count


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workplace:
    """The reference fails at a height of 4 cm and falls short at 3 cm."""
    workplace, model = Workplace(tmp_path / "with space"), ModuleType("fringe")
    store.write_text(workplace.repository / "fem_reference.py", REFERENCE)
    exec(MODEL, vars(model))
    for name, value in (("PYTHONPATH", str(ROOT)), ("TOY_FAILS_AT", "0.04"), ("TOY_SHORT_AT", "0.03")):
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(stage, "ROOT", workplace.repository)
    monkeypatch.setattr(model_stage, "model_module", lambda: model)
    return workplace


Answer = Callable[[stage.Processes], store.Document]
TWO = PARALLEL.replace("[0.01, 0.02, 0.04]", "[0.01, 0.02]")
BESIDE = EDGE.replace("height = 0", "height = 0.02")


def test_a_study_is_solved_reported_and_told(place: Workplace) -> None:
    printed = place.run(TWO).stdout
    assert "mutual      model error over 2 cases: rms 192.4%" in printed
    assert f"report: {place.results / 'report.html'}" in printed
    assert (place.results / "table.csv").read_text().count("\n") == 5


def test_the_report_is_there_before_pictures_are_solved_for(
    place: Workplace, monkeypatch: pytest.MonkeyPatch
) -> None:
    there: list[tuple[int, int]] = []

    def make(folder: Path) -> report.Report:
        there.append((place.solved(), len(list(folder.rglob("slice.json")))))
        return report.Report(folder / "report.html", [], 0, 0, 0, [])

    monkeypatch.setattr(report, "make", make)
    printed = place.run(TWO).stdout
    assert there == [(3, 0), (0, 2)]
    assert printed.index("can be read now") < printed.index("report: ")


def test_only_what_has_no_answer_is_solved(place: Workplace) -> None:
    solved = []
    for sweeps in (TWO + BESIDE, TWO + BESIDE, TWO.replace("0.02", "0.025") + BESIDE):
        place.run(sweeps)
        solved.append(place.solved())
    assert solved == [5, 0, 1]


def test_a_failing_case_is_told_and_the_others_go_on(place: Workplace) -> None:
    assert "reference: exit code 1: cannot mesh this" in place.run(PARALLEL, status=1).stderr
    found = results.load(place.results)
    assert ("reference", "exit code 1: cannot mesh this") in {(f.stage, f.reason) for f in found.failures}
    assert [case.reference is not None for case in found.compared()] == [True, True, False]


def test_an_accuracy_not_reached_is_an_answer_and_told(place: Workplace) -> None:
    told = place.run(TWO.replace("0.02", "0.03"), status=3).stdout
    assert "1 cases are short of the asked accuracy" in told
    analysis("report", place.results, status=3)


def test_a_missing_picture_is_told_but_is_no_failed_run_and_case_folders_hold_whole_files_only(
    place: Workplace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TOY_SLICES_FAIL", "yes")
    assert "slice of the potential: exit code 1" in place.run(TWO).stderr
    names = {path.name for path in (place.results / "cases").glob("*/*")}
    assert names == {"scene.toml", "fem.json", "model.json", "boundary.json", "case.html"}


def test_wrong_input_ends_with_code_2_and_a_message(place: Workplace) -> None:
    done = place.run(TWO + "colour = 3", status=2)
    assert "sweep[0].colour: unknown key" in done.stderr and not done.stdout
    assert not place.results.exists()


def run_two(first: Answer, second: Answer) -> None:
    """Runs two jobs at a time, which are interrupted and store nothing."""
    jobs = [
        Stage("job", "", Path("nowhere"), "key", seconds, answer)
        for seconds, answer in ((2, first), (1, second))
    ]
    with pytest.raises(KeyboardInterrupt):
        scheduler.run_all(jobs, workers=2)


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

    def sleep(of: stage.Processes) -> store.Document:
        of.run([sys.executable, "-c", script], tmp_path, dict(os.environ))
        return {}

    def interrupt(of: stage.Processes) -> store.Document:
        wait_until(lambda: pids.is_file() and len(pids.read_text().split()) == 2, "the start of the job")
        raise KeyboardInterrupt

    run_two(sleep, interrupt)
    for pid in pids.read_text().split():
        wait_until(lambda: has_ended(pid), f"the end of process {pid}")


def test_stopping_ends_what_the_jobs_compute_themselves() -> None:
    """Boundary elements to 1e-5 of many triangles would take minutes."""
    module = model_stage.model_module()
    text = scenes.body("ball", "sphere", radius=1, segments=40, potential="electrode")
    begun, ended = threading.Event(), threading.Event()

    def compute(_: stage.Processes) -> store.Document:
        begun.set()
        try:
            module.Scene.loads(text).maxwell(rtol=1e-5)
        except stage.Stopped:
            ended.set()
            raise
        return {}

    def interrupt(_: stage.Processes) -> store.Document:
        begun.wait()
        raise KeyboardInterrupt

    run_two(compute, interrupt)
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
        cwd=stage.ROOT,
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
    stage.forget_unfinished_forms(tmp_path)
    assert {path.name for path in (tmp_path / "fenics").iterdir()} == {
        "libffcx_forms_a.c",
        "libffcx_forms_a.c.cached",
    }


def test_the_remaining_time_follows_the_pace_so_far_and_before_that_the_expected_seconds() -> None:
    assert scheduler.remaining_seconds(total=100, done=25, elapsed=10, workers=2) == pytest.approx(30)
    assert scheduler.remaining_seconds(total=100, done=0, elapsed=10, workers=2) == pytest.approx(40)
    assert scheduler.remaining_seconds(total=100, done=0, elapsed=60, workers=2) == 0
