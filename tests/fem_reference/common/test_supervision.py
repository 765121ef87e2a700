"""A command in a process of its own: it can be ended inside a library, and what it has reported is kept."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.waiting import DEADLINE, has_ended, wait_until

REPOSITORY = Path(__file__).parents[3]
UNREACHED = 3
# A call that Python's own handler of Ctrl-C cannot interrupt, as it is in the mesher and the linear solver, and that does not end
# before the tests give up: a command that ends was ended.
BUSY = f"import ctypes; [ctypes.CDLL(None).usleep(1000) for _ in range({int(2000 * DEADLINE)})]"


def started(commands: str) -> subprocess.Popen[str]:
    """Starts a supervised command of these statements, which know `report` and `AnswerSoFar`, and waits for its first words."""
    body = "\n".join(f"    {line}" for line in commands.splitlines())
    program = (
        "import os, signal, sys\n"
        "from fem_reference.common.supervision import AnswerSoFar, supervised\n"
        f"def command(report):\n{body}\n"
        f"sys.exit(supervised(command, {UNREACHED}))\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    return process


def finished(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    try:
        output, errors = process.communicate(timeout=DEADLINE)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    return process.returncode, output, errors


def reported(seconds_left: str) -> str:
    """Statements that report an answer, say so, and are busy then."""
    return (
        f'report(AnswerSoFar("the first answer", "not accurate", {seconds_left}))\n'
        f'print("begun", flush=True)\n{BUSY}\nreturn 0'
    )


@pytest.mark.parametrize("status", [0, 2])
def test_a_command_that_ends_prints_and_returns_by_itself(status: int) -> None:
    assert finished(started(f'print("answer")\nreturn {status}')) == (status, "answer\n", "")


@pytest.mark.parametrize("to_all", [True, False], ids=["terminal", "kill"])
def test_after_ctrl_c_the_answer_so_far_is_printed(to_all: bool) -> None:
    process = started(reported('float("inf")'))
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    # A terminal sends the signal to all processes of the command.
    (os.killpg if to_all else os.kill)(process.pid, signal.SIGINT)
    status, output, errors = finished(process)
    assert (status, output, errors.strip()) == (130, "the first answer\n", "not accurate")


def test_when_the_time_is_over_the_answer_so_far_is_printed() -> None:
    status, output, errors = finished(started(reported("0.2")))
    assert (status, output, errors) == (UNREACHED, "begun\nthe first answer\n", "not accurate\n")


def test_when_the_time_is_over_before_the_first_answer_that_is_said() -> None:
    waiting = f'report(AnswerSoFar("", "too little time", 0.2, is_answer=False))\nprint("begun", flush=True)\n{BUSY}'
    assert finished(started(waiting)) == (UNREACHED, "begun\n", "too little time\n")
    process = started(waiting.replace("0.2", 'float("inf")'))
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    os.kill(process.pid, signal.SIGINT)
    status, output, errors = finished(process)
    assert (status, output, errors.strip()) == (130, "", "fem_reference: interrupted before the first answer")


def test_a_command_that_is_killed_says_by_what_and_keeps_its_answer() -> None:
    """The system kills processes for want of memory."""
    killed, words = (
        "os.kill(os.getpid(), signal.SIGKILL)",
        "fem_reference: ended by SIGKILL, as the system does for want of memory\n",
    )
    assert finished(started(killed)) == (137, "", words)
    answered = 'report(AnswerSoFar("the first answer", "not accurate", float("inf")))\n'
    assert finished(started(answered + killed)) == (UNREACHED, "the first answer\n", f"not accurate\n{words}")


def test_a_command_that_a_library_aborts_keeps_its_answer() -> None:
    """MPI ends the process with a status of its own where PETSc or hypre get no memory."""
    assert finished(started("os._exit(255)")) == (255, "", "")
    answered = 'report(AnswerSoFar("the first answer", "not accurate", float("inf")))\n'
    status, output, errors = finished(started(f"{answered}os._exit(255)"))
    assert (status, output) == (UNREACHED, "the first answer\n") and "status 255" in errors


def test_the_command_ends_with_the_process_that_watches_it() -> None:
    process = started(f"print(os.getpid(), flush=True)\n{BUSY}")
    assert process.stdout is not None
    child = int(process.stdout.readline())
    process.kill()
    process.wait()
    wait_until(lambda: has_ended(child), "the end of the command")


@pytest.mark.parametrize("number, answer", [("0", "the first answer"), ("1", "")])
def test_when_mpirun_ends_its_processes_the_first_one_prints_the_answer(
    monkeypatch: pytest.MonkeyPatch, number: str, answer: str
) -> None:
    """Other processes only report that there is one."""
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", number)
    message = "not accurate" if answer else ""
    process = started(
        f'report(AnswerSoFar("{answer}", "{message}", float("inf")))\nprint("begun", flush=True)\n{BUSY}'
    )
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    os.kill(process.pid, signal.SIGTERM)
    status, output, errors = finished(process)
    assert (status, output.strip(), errors.strip()) == (130, answer, message)
