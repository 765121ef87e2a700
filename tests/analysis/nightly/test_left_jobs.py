"""The end of jobs that a night has on a cluster, with a profile whose cancel.py writes down what it is called with."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.nightly import chunks, cluster

CANCEL = """
import pathlib, sys
here = pathlib.Path(__file__).parent
with (here / "called.txt").open("a") as log:
    log.write(sys.argv[1] + "\\n")
sys.exit("the controller does not answer" if (here / "silent").exists() else 0)
"""


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """With a job's file."""
    (tmp_path / "results" / chunks.FOLDER).mkdir(parents=True)
    (tmp_path / "results" / chunks.FOLDER / "1-0.json").write_text("{}")
    return tmp_path / "results"


@pytest.fixture
def profile(tmp_path: Path) -> Path:
    (tmp_path / "profile").mkdir()
    (tmp_path / "profile" / cluster.CANCEL).write_text(CANCEL)
    return tmp_path / "profile"


def called(profile: Path) -> list[str]:
    log = profile / "called.txt"
    return log.read_text().split() if log.is_file() else []


def test_a_nights_jobs_are_ended_by_name_once_their_files_are_gone(results: Path, profile: Path) -> None:
    cluster.begin(results, profile)
    assert (results / chunks.FOLDER).is_dir()
    cluster.end(results)
    assert called(profile) == 2 * [cluster.name(results)]
    assert not (results / chunks.FOLDER).exists()
    cluster.end_left_over(results)
    assert len(called(profile)) == 2


def test_what_a_killed_night_left_is_ended_by_its_own_profile_whatever_follows(
    results: Path, profile: Path
) -> None:
    cluster.begin(results, profile)
    cluster.begin(results, None)
    assert len(called(profile)) == 2 and not (results / chunks.FOLDER).exists()


def test_every_folder_of_results_has_jobs_of_its_own(tmp_path: Path) -> None:
    assert cluster.name(tmp_path) == cluster.name(tmp_path / "." / "x" / "..")
    assert cluster.name(tmp_path) != cluster.name(tmp_path / "x")


def test_jobs_that_cannot_be_ended_are_told_and_tried_again(results: Path, profile: Path) -> None:
    cluster.begin(results, profile)
    (profile / "silent").touch()
    with pytest.raises(
        OSError, match="may be left on the cluster: exit code 1: the controller does not answer"
    ):
        cluster.end(results)
    (profile / "silent").unlink()
    cluster.end_left_over(results)
    cluster.end_left_over(results)
    assert len(called(profile)) == 3


def test_a_profile_that_cannot_end_jobs_is_one_for_which_files_are_enough(
    results: Path, profile: Path
) -> None:
    (profile / cluster.CANCEL).unlink()
    cluster.begin(results, profile)
    cluster.end(results)
    assert not (results / chunks.FOLDER).exists()
