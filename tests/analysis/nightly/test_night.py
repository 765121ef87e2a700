"""A night: what is solved, kept and told when Snakemake carries a study, what happens when it is killed, and the end of jobs on a cluster."""

import os
import signal
import time
from pathlib import Path

import pytest

from analysis.nightly import night, slurm_status
from analysis.results import study_results as results
from analysis.study.workflow import Work
from analysis.topics.trends import changes, page as trends_page
from analysis.topics.trends.changes import Record
from geometries.common.errors import InputError
from tests.analysis.nightly.toy_repository import ToyRepository
from tests.waiting import DEADLINE


@pytest.fixture(scope="module")
def toy(tmp_path_factory: pytest.TempPathFactory) -> ToyRepository:
    """After a first night, with one case failing, in a folder with a space."""
    made = ToyRepository(tmp_path_factory.mktemp("a night") / "toy", count=3)
    first = made.run("nightly", TOY_FAILS_AT="0.08")
    assert first.returncode == 1
    assert "reference: exit code 1: cannot mesh this" in first.stderr
    return made


def by_night(toy: ToyRepository) -> list[list[Record]]:
    """The values that each night has appended."""
    found = changes.load(toy.results)
    return [[each for each in found if each.time == time] for time in sorted({each.time for each in found})]


def test_a_failed_case_fails_the_night_and_the_others_go_on(toy: ToyRepository) -> None:
    assert len(toy.answers()) == 3
    (first,) = by_night(toy)
    assert len({each.case for each in first}) == 2


def test_the_next_night_solves_only_what_is_missing_and_tells_what_is_new(toy: ToyRepository) -> None:
    before = toy.solved()
    second = toy.run("nightly")
    assert second.returncode == 0, second.stderr
    assert sum((toy.solved() - before).values()) == 1 and max(toy.solved().values()) == 1
    assert "0 values moved by more than their errors" in second.stdout
    first, last = by_night(toy)
    assert not {each.case for each in first} & {each.case for each in last}
    assert {path.name for path in toy.results.iterdir()} >= {"report.html", trends_page.PAGE, "snakemake.log"}


def test_a_study_run_by_snakemake_has_the_table_of_one_run_without(
    toy: ToyRepository, tmp_path: Path
) -> None:
    plain = ToyRepository(tmp_path / "plain", count=3)
    assert plain.run("run").returncode == 0
    assert plain.table() == toy.table()


@pytest.mark.night
def test_values_that_moved_and_methods_that_disagree_fail_the_night_and_are_told(toy: ToyRepository) -> None:
    # All three cases are known before, whichever tests ran.
    assert toy.run("nightly").returncode == 0
    with (toy.folder / "fem_reference" / "__main__.py").open("a") as source:
        source.write("# another version\n")
    (toy.folder / "model").mkdir()
    (toy.folder / "model" / "another_version.cpp").write_text("")
    third = toy.run("nightly", TOY_SHIFT="0.5", TOY_BOUNDARY="9")
    assert third.returncode == 1
    assert "6 values moved by more than their errors" in third.stdout
    found = changes.load(toy.results)
    assert "6 of them have changed" in trends_page.finding(found, changes.marks(found))
    disagreeing = "values of boundary elements and the field solver disagree by more than their errors"
    assert disagreeing in third.stdout
    head = (toy.results / "report.html").read_text().partition("<header>")[0]
    assert "values of the two references disagree" in head and 'href="report/cross_check.html"' in head


@pytest.mark.night
@pytest.mark.parametrize("all_of_it", [False, True], ids=["process", "session"])
def test_nights_that_are_killed_lose_nothing_and_leave_nothing_in_the_way(
    tmp_path: Path, all_of_it: bool
) -> None:
    """At three moments each, many of them in a write; what a killed process has started ends with it."""
    whole, killed = (ToyRepository(tmp_path / name, count=8) for name in ("undisturbed", "killed"))
    killed.make_writing_slower()
    begun = time.monotonic()
    assert whole.run("nightly").returncode == 0
    duration = time.monotonic() - begun
    for share in (0.4, 0.6, 0.8):
        before, solved = killed.answers(), killed.solved()
        process = killed.start("nightly", "--job-seconds", "20")
        time.sleep(share * duration)
        # On a busy machine it may have ended before.
        if process.poll() is None:
            (os.killpg if all_of_it else os.kill)(process.pid, signal.SIGKILL)
        process.communicate(timeout=DEADLINE)
        assert all(killed.solved()[case] == solved[case] for case in before), "solved again"
    before, solved = killed.answers(), killed.solved()
    done = killed.run("nightly")
    assert done.returncode == 0, done.stderr
    assert all(killed.solved()[case] == solved[case] for case in before), "solved again"
    assert killed.table() == whole.table() and not list(killed.results.glob("cases/*/.*"))


def works(count: int) -> list[Work]:
    return [
        Work(f"case{n}", "", None, {results.REFERENCE: "key"}, {results.REFERENCE: 10.0 + n})
        for n in range(count)
    ]


@pytest.mark.parametrize(
    ("count", "seconds", "jobs"), [(0, 60, 0), (1, 60, 1), (2, 600, 2), (100, 60, 99), (5000, 1, 1000)]
)
def test_jobs_last_as_long_as_asked_and_each_worker_has_one(count: int, seconds: float, jobs: int) -> None:
    grouped = night.group(works(count), seconds, workers=4)
    assert len(grouped) == jobs
    assert sorted(work.case for job in grouped for work in job.works) == sorted(w.case for w in works(count))
    costs = [sum(work.cost for work in job.works) for job in grouped]
    assert not costs or max(costs) - min(costs) <= 10.0 + count


def test_a_job_whose_file_is_gone_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not the file of a job"):
        night.solve(tmp_path / "1-0.json")


@pytest.mark.parametrize(
    ("told", "word"),
    [
        ("JobId=1 JobState=COMPLETED Reason=None", "success"),
        ("JobId=1 JobState=PENDING Reason=None", "running"),
        ("JobId=1 JobState=OUT_OF_MEMORY Reason=None", "failed"),
        ("", "failed"),
    ],
)
def test_a_job_of_slurm_is_in_one_of_three_states(told: str, word: str) -> None:
    assert slurm_status.word(told) == word


CANCEL = """
import pathlib, sys
here = pathlib.Path(__file__).parent
with (here / "called.txt").open("a") as log:
    log.write(sys.argv[1] + "\\n")
sys.exit("the controller does not answer" if (here / "silent").exists() else 0)
"""


@pytest.fixture
def left(tmp_path: Path) -> Path:
    """With a job's file."""
    (tmp_path / "results" / night.FOLDER).mkdir(parents=True)
    (tmp_path / "results" / night.FOLDER / "1-0.json").write_text("{}")
    return tmp_path / "results"


@pytest.fixture
def profile(tmp_path: Path) -> Path:
    (tmp_path / "profile").mkdir()
    (tmp_path / "profile" / night.CANCEL).write_text(CANCEL)
    return tmp_path / "profile"


def called(profile: Path) -> list[str]:
    log = profile / "called.txt"
    return log.read_text().split() if log.is_file() else []


def test_a_nights_jobs_are_ended_by_name_once_their_files_are_gone(left: Path, profile: Path) -> None:
    night.begin(left, profile)
    assert (left / night.FOLDER).is_dir()
    night.end(left)
    assert called(profile) == 2 * [night.name_of_jobs(left)]
    assert not (left / night.FOLDER).exists()
    night.end_left_over(left)
    assert len(called(profile)) == 2


def test_what_a_killed_night_left_is_ended_by_its_own_profile_whatever_follows(
    left: Path, profile: Path
) -> None:
    night.begin(left, profile)
    night.begin(left, None)
    assert len(called(profile)) == 2 and not (left / night.FOLDER).exists()


def test_every_folder_of_results_has_jobs_of_its_own(tmp_path: Path) -> None:
    assert night.name_of_jobs(tmp_path) == night.name_of_jobs(tmp_path / "." / "x" / "..")
    assert night.name_of_jobs(tmp_path) != night.name_of_jobs(tmp_path / "x")


def test_jobs_that_cannot_be_ended_are_told_and_tried_again(left: Path, profile: Path) -> None:
    night.begin(left, profile)
    (profile / "silent").touch()
    with pytest.raises(
        OSError, match="may be left on the cluster: exit code 1: the controller does not answer"
    ):
        night.end(left)
    (profile / "silent").unlink()
    night.end_left_over(left)
    night.end_left_over(left)
    assert len(called(profile)) == 3


def test_a_profile_that_cannot_end_jobs_is_one_for_which_files_are_enough(left: Path, profile: Path) -> None:
    (profile / night.CANCEL).unlink()
    night.begin(left, profile)
    night.end(left)
    assert not (left / night.FOLDER).exists()
