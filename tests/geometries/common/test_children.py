"""What a process started and made ends with it, in whatever way it ends."""

from __future__ import annotations

import ast
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from geometries.common.children import ending_with_this, temporary_folder
from tests.processes import marked
from tests.waiting import heed_signals, wait_until

REPOSITORY = Path(__file__).resolve().parents[3]
# A process that makes a folder, in which the program that it starts writes files without end, and a fork; it says so and sleeps.
PARENT = """
import os, subprocess, sys, time
from geometries.common.children import end_with, ending_with_this, temporary_folder
with temporary_folder() as folder:
    writer = f"while :; do date > {folder}/$$.$(date +%N); done"
    subprocess.Popen(ending_with_this(["sh", "-c", writer]))
    parent = os.getpid()
    if os.fork() == 0:
        end_with(parent)
        time.sleep(1000)
    print("begun", flush=True)
    time.sleep(1000)
"""
ENDINGS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)


def start(folder: Path) -> subprocess.Popen[str]:
    environment = os.environ | {"TMPDIR": str(folder)}
    return subprocess.Popen(
        [sys.executable, "-c", PARENT],
        cwd=REPOSITORY,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
        preexec_fn=heed_signals,
    )


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("whole_session", [False, True], ids=["process", "session"])
def test_nothing_is_left_of_a_process_at_work(
    tmp_path: Path, ending: signal.Signals, whole_session: bool
) -> None:
    with start(tmp_path) as parent:
        assert parent.stdout is not None and parent.stdout.readline() == "begun\n"
        assert len(marked(tmp_path)) >= 3 and list(tmp_path.iterdir())
        (os.killpg if whole_session else os.kill)(parent.pid, ending)
    wait_until(
        lambda: not marked(tmp_path) and not list(tmp_path.iterdir()), "the end of all processes and files"
    )


def test_nothing_is_left_of_processes_that_are_killed_at_any_moment(tmp_path: Path) -> None:
    moments = random.Random(1)
    for ending in ENDINGS * 3:
        with start(tmp_path) as parent:
            time.sleep(moments.uniform(0, 0.2))
            os.kill(parent.pid, ending)
    wait_until(
        lambda: not marked(tmp_path) and not list(tmp_path.iterdir()), "the end of all processes and files"
    )


def test_a_program_whose_starter_has_ended_before_it_began_does_not_run(tmp_path: Path) -> None:
    """The words name a process that is not the parent, as after the parent's end."""
    words = ending_with_this(["touch", tmp_path / "made"])
    another = [word if word != str(os.getpid()) else "1" for word in words]
    assert subprocess.run(another, check=False).returncode != 0 and not list(tmp_path.iterdir())
    assert subprocess.run(words, check=False).returncode == 0 and list(tmp_path.iterdir())


def test_a_program_keeps_its_words_its_status_and_its_input() -> None:
    words = ["sh", "-c", 'cat; echo "$1" >&2; exit 7', "sh", "two  words $HOME"]
    done = subprocess.run(ending_with_this(words), input="in", capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (7, "in", "two  words $HOME\n")


def test_a_missing_program_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no-such-program"):
        ending_with_this([tmp_path / "no-such-program"])


def test_a_folder_goes_at_the_end_and_after_an_error(tmp_path: Path) -> None:
    with temporary_folder(tmp_path) as folder:
        assert folder.parent == tmp_path
        (folder / "inside").mkdir()
        (folder / "inside" / "file").write_text("text")
    assert not list(tmp_path.iterdir())
    with pytest.raises(KeyboardInterrupt):
        with temporary_folder(tmp_path):
            raise KeyboardInterrupt
    assert not list(tmp_path.iterdir())
    with pytest.raises(OSError, match="no-such-folder"):
        with temporary_folder(tmp_path / "no-such-folder"):
            pass


# Programs that have to go on: what ends the jobs on a cluster, which runs by itself.
EXCEPTIONS = {
    "analysis/nightly/cluster.py",
    "analysis/nightly/profiles/slurm/cancel.py",
    "geometries/common/children.py",
}


def test_all_packages_start_programs_and_make_folders_so() -> None:
    found = []
    for package in ("geometries", "fem_reference", "analysis"):
        for path in sorted((REPOSITORY / package).rglob("*.py")):
            name = str(path.relative_to(REPOSITORY))
            text = path.read_text(encoding="utf-8")
            calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
            starts = [
                call for call in calls if ast.unparse(call.func) in ("subprocess.run", "subprocess.Popen")
            ]
            if starts and "ending_with_this(" not in text and name not in EXCEPTIONS:
                found.append(f"{name} starts a program that may outlive it")
            if "TemporaryDirectory" in text or "mkdtemp" in text:
                found.append(f"{name} makes a folder that may outlive it")
    assert not found
