"""Numbers, files and processes: options that make sense, values as the command writes them, files that are there whole or not at all,
children that end with their parent."""

import argparse
import ast
import math
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from geometries.common.arguments import positive_integer, positive_number
from geometries.common.children import ending_with_this, run_with_all_it_starts, temporary_folder
from geometries.common.files import whole_file
from geometries.common.measured import measured, picofarad_interval, picofarads
from tests.waiting import heed_signals, marked, wait_until

REPOSITORY = Path(__file__).resolve().parents[3]


def test_positive_numbers_are_read() -> None:
    assert positive_number("2.5e-3") == 2.5e-3
    assert positive_integer("12") == 12


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "much", ""])
def test_other_numbers_are_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=f"'{text}' is not a finite number greater than 0"):
        positive_number(text)


@pytest.mark.parametrize("text", ["0", "-1", "1.5", "many"])
def test_other_counts_are_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=f"'{text}' is not a whole number greater than 0"):
        positive_integer(text)


IN_CPP = (REPOSITORY / "tests" / "model" / "cli" / "measured_test.cpp").read_text(encoding="utf-8")
CASES = re.findall(r'Case\{(-?[\d.e+-]+), (-?[\d.e+-]+), "(.*?)"\}', IN_CPP)


@pytest.mark.parametrize(("value", "error", "text"), CASES)
def test_a_value_with_its_error_is_written_as_the_command_writes_it(
    value: str, error: str, text: str
) -> None:
    assert measured(float(value), float(error)) == text


def test_these_are_all_cases_of_the_command_with_finite_numbers() -> None:
    assert len(CASES) == IN_CPP.count("Case{") - 3


@pytest.mark.parametrize("error", [math.nan, math.inf])
def test_without_a_finite_error_a_value_is_unknown(error: float) -> None:
    assert measured(20.0, error) == "unknown"


def test_capacitances_are_given_in_farads() -> None:
    assert picofarads(2.4914e-12, 1.1e-15) == "2.4914 ± 0.0011"


@pytest.mark.parametrize(
    ("lower", "upper", "text"),
    [
        (2.49035e-12, 2.49245e-12, "[2.4903, 2.4925]"),
        (-2.49245e-12, -2.49035e-12, "[-2.4925, -2.4903]"),
        (4.882291e-16, 4.883898e-16, "[0.000488229, 0.000488390]"),
        (1234.5e-12, 4321.5e-12, "[1234, 4322]"),
        (math.nan, 1e-12, "unknown"),
    ],
)
def test_an_interval_is_rounded_outwards_to_two_digits_of_its_half_width(
    lower: float, upper: float, text: str
) -> None:
    assert picofarad_interval(lower, upper) == text


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


def wait_until_nothing_is_left(folder: Path) -> None:
    left: list[object] = []

    def is_empty() -> bool:
        left[:] = [*marked(folder).items(), *folder.iterdir()]
        return not left

    try:
        wait_until(is_empty, "the end of all processes and files")
    except AssertionError as error:
        raise AssertionError(f"{error}: {left[:20]}") from None


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("whole_session", [False, True], ids=["process", "session"])
def test_nothing_is_left_of_a_process_at_work(
    tmp_path: Path, ending: signal.Signals, whole_session: bool
) -> None:
    with start(tmp_path) as parent:
        assert parent.stdout is not None and parent.stdout.readline() == "begun\n"
        assert len(marked(tmp_path)) >= 3 and list(tmp_path.iterdir())
        (os.killpg if whole_session else os.kill)(parent.pid, ending)
    wait_until_nothing_is_left(tmp_path)


def test_nothing_is_left_of_processes_that_are_killed_at_any_moment(tmp_path: Path) -> None:
    moments = random.Random(1)
    for ending in ENDINGS * 3:
        with start(tmp_path) as parent:
            time.sleep(moments.uniform(0, 0.2))
            os.kill(parent.pid, ending)
    wait_until_nothing_is_left(tmp_path)


def test_a_temporary_folder_is_made_without_trying_the_place_by_a_file(tmp_path: Path) -> None:
    """Such a file stayed where the process was killed before it removed it."""
    script = """
import tempfile
from geometries.common.children import temporary_folder
with temporary_folder() as folder:
    print(folder.parent, tempfile.tempdir)
"""
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    made = subprocess.run(
        [sys.executable, "-c", script],
        cwd=REPOSITORY,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert made.stdout == f"{tmp_path} None\n"


@pytest.mark.parametrize("ending", (signal.SIGKILL, signal.SIGTERM))
def test_nothing_is_left_of_what_a_command_has_started(tmp_path: Path, ending: signal.Signals) -> None:
    """As the compilers of a build, the sleeping programs are children of a child."""
    parent = f"""
from pathlib import Path
from geometries.common.children import run_with_all_it_starts
run_with_all_it_starts("sh -c 'sleep 1000 & touch begun; sleep 1000'; true", Path({str(tmp_path)!r}))
"""
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    with subprocess.Popen([sys.executable, "-c", parent], cwd=REPOSITORY, env=environment) as started:
        wait_until(lambda: (tmp_path / "begun").exists(), "the beginning")
        assert len(marked(tmp_path)) >= 4
        os.kill(started.pid, ending)
    wait_until(lambda: not marked(tmp_path), "the end of all processes")


def test_a_command_keeps_its_status_and_what_it_prints(tmp_path: Path) -> None:
    done = run_with_all_it_starts("pwd; echo wrong >&2; exit 7", tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (7, f"{tmp_path}\n", "wrong\n")
    assert not marked(tmp_path)


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
    "analysis/nightly/night.py",
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


def test_a_file_appears_when_it_is_finished(tmp_path: Path) -> None:
    target = tmp_path / "answer.json"
    with whole_file(target) as unfinished:
        unfinished.write_text("half")
        assert not target.exists() and unfinished.suffix == ".json"
    assert target.read_text() == "half" and list(tmp_path.iterdir()) == [target]


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "answer.json"
    target.write_text("old")
    with pytest.raises(KeyboardInterrupt):
        with whole_file(target) as unfinished:
            unfinished.write_text("ne")
            raise KeyboardInterrupt
    assert target.read_text() == "old" and list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("target", ["missing/answer.json", "folder"])
def test_an_error_names_the_file_and_not_its_temporary_form(target: str, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError) as caught:
        with whole_file(tmp_path / target) as unfinished:
            unfinished.write_text("whole")
    assert str(caught.value).endswith(f": '{tmp_path / target}'")


WRITER = """
import sys
from pathlib import Path
from geometries.common.files import whole_file
from geometries.common.measured import measured, picofarad_interval, picofarads
with whole_file(Path(sys.argv[1])) as unfinished:
    unfinished.write_text("half")
    print(flush=True)
    sys.stdin.read()
"""


def test_what_a_killed_writer_left_goes_with_the_next_one(tmp_path: Path) -> None:
    target = tmp_path / "answer.json"
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(target)],
        cwd=REPOSITORY,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as writer:
        assert writer.stdout is not None
        writer.stdout.readline()
        with whole_file(target) as unfinished:
            unfinished.write_text("meanwhile")
        assert len(list(tmp_path.glob(".answer.*.json"))) == 1, "the other is still at it"
        writer.kill()
    with whole_file(tmp_path / "another.json") as unfinished:
        unfinished.write_text("whole")
    assert len(list(tmp_path.glob(".answer.*.json"))) == 1, "not of the same file"
    with whole_file(target) as unfinished:
        unfinished.write_text("whole")
    assert target.read_text() == "whole" and not list(tmp_path.glob(".*"))
