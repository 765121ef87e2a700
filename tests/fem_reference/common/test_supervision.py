"""A command in a process of its own: it can be ended inside a library, and what it has reported is kept."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.waiting import DEADLINE, has_ended, wait_until

REPOSITORY = Path(__file__).parents[3]
UNREACHED = 3
# A call that Python's own handler of Ctrl-C cannot interrupt, as it is in the mesher and the linear solver, and that does not end
# before the tests give up: a command that ends was ended.
BUSY = f"import ctypes; [ctypes.CDLL(None).usleep(1000) for _ in range({int(2000 * DEADLINE)})]"


INFINITE = 'float("inf")'
KILLED = "os.kill(os.getpid(), signal.SIGKILL)"
BY_KILL = "fem_reference: ended by SIGKILL, as the system does for want of memory"


def started(commands: str) -> subprocess.Popen[str]:
    """Starts a supervised command of these statements, which know `report` and `AnswerSoFar`."""
    body = "\n".join(f"    {line}" for line in commands.splitlines())
    program = (
        "import os, signal, sys\n"
        "from fem_reference.common.supervision import AnswerSoFar, supervised\n"
        f"def command(report):\n{body}\n"
        f"sys.exit(supervised(command, {UNREACHED}))\n"
    )
    return subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def finished(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    try:
        output, errors = process.communicate(timeout=DEADLINE)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    return process.returncode, output, errors


def report(left: str, text: str = "the first answer", message: str = "not accurate", more: str = "") -> str:
    """A statement that reports an answer, with the time (s) left for a better one."""
    return f"report(AnswerSoFar({text!r}, {message!r}, {left}{more}))\n"


def interrupted(commands: str, send: Callable[[int], None]) -> tuple[int, str, str]:
    """What is left of a command to which a signal is sent after these statements, while it is busy."""
    process = started(f'{commands}print("begun", flush=True)\n{BUSY}\nreturn 0')
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    send(process.pid)
    status, output, errors = finished(process)
    return status, output, errors.strip()


@pytest.mark.parametrize(
    "commands, expected",
    [
        pytest.param('print("answer")\nreturn 0', (0, "answer\n", ""), id="ends by itself"),
        pytest.param('print("answer")\nreturn 2', (2, "answer\n", ""), id="fails by itself"),
        pytest.param(
            report("0.2") + BUSY, (UNREACHED, "the first answer\n", "not accurate\n"), id="the time is over"
        ),
        pytest.param(
            report("0.2", "", "too little time", ", is_answer=False") + BUSY,
            (UNREACHED, "", "too little time\n"),
            id="the time is over before the first answer",
        ),
        # The system kills processes for want of memory.
        pytest.param(KILLED, (137, "", f"{BY_KILL}\n"), id="killed"),
        pytest.param(
            report(INFINITE) + KILLED,
            (UNREACHED, "the first answer\n", f"not accurate\n{BY_KILL}\n"),
            id="killed after an answer",
        ),
        # MPI ends the process with a status of its own where PETSc or hypre get no memory.
        pytest.param("os._exit(255)", (255, "", ""), id="aborted by a library"),
        pytest.param(
            report(INFINITE) + "os._exit(255)",
            (
                UNREACHED,
                "the first answer\n",
                "not accurate\nfem_reference: aborted by a library with status 255, as for want of memory\n",
            ),
            id="aborted after an answer",
        ),
    ],
)
def test_the_answer_so_far_is_kept(commands: str, expected: tuple[int, str, str]) -> None:
    assert finished(started(commands)) == expected


@pytest.mark.parametrize("send", [os.killpg, os.kill], ids=["terminal", "kill"])
def test_after_ctrl_c_the_answer_so_far_is_printed(send: Callable[[int, int], None]) -> None:
    """A terminal sends the signal to all processes of the command."""
    found = interrupted(report(INFINITE), lambda process: send(process, signal.SIGINT))
    assert found == (130, "the first answer\n", "not accurate")


def test_after_ctrl_c_before_the_first_answer_that_is_said() -> None:
    nothing = report(INFINITE, "", "too little time", ", is_answer=False")
    found = interrupted(nothing, lambda process: os.kill(process, signal.SIGINT))
    assert found == (130, "", "fem_reference: interrupted before the first answer")


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
    reported = report(INFINITE, answer, "not accurate" if answer else "")
    status, output, errors = interrupted(reported, lambda process: os.kill(process, signal.SIGTERM))
    assert (status, output.strip(), errors) == (130, answer, "not accurate" if answer else "")
