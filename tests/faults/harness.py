"""A study that is disturbed, and what must hold afterwards: nothing finished is lost or damaged, no traceback but a sentence, and the
same command, left alone, makes the table of an undisturbed run."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from tests.analysis.nightly.toy_repository import ToyRepository
from tests.waiting import DEADLINE

CASES = 6
# A killed writer's file is seldom met by chance: each write takes this much longer between its end and its renaming.
_SLOWER = 0.02
TOLD = "analysis: "


@dataclass
class Tally:
    """Of one kind of fault: how often it was made, how often the run was still going, how often it was told by a sentence, how many
    unfinished files it left, how many runs afterwards came to the table of an undisturbed one."""

    rounds: int = 0
    during_the_run: int = 0
    told: int = 0
    unfinished_files: int = 0
    completed_afterwards: int = 0
    skipped: str = ""
    sentences: set[str] = field(default_factory=set)


@dataclass
class Study:
    """A toy study and the table that an undisturbed run of it has. `prefix` stands before every command."""

    toy: ToyRepository
    table: str
    seconds: float
    prefix: tuple[str, ...] = ()

    def start(self, before: Callable[[], None] | None = None, **variables: str) -> subprocess.Popen[str]:
        """`python3 -m analysis run` in a session of its own."""
        return subprocess.Popen(
            [*self.prefix, sys.executable, "-m", "analysis", "run", "study.toml"],
            cwd=self.toy.folder,
            env=os.environ | variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            preexec_fn=before,
        )

    def finish(self, process: subprocess.Popen[str]) -> subprocess.CompletedProcess[str]:
        try:
            output, errors = process.communicate(timeout=DEADLINE)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            raise
        return subprocess.CompletedProcess(process.args, process.returncode, output, errors)


def sentences(errors: str) -> list[str]:
    """What was told, without the progress bar."""
    return [line for line in errors.replace("\r", "\n").splitlines() if line.startswith(TOLD)]


def expect_told(done: subprocess.CompletedProcess[str], tally: Tally, status: int) -> None:
    """A sentence, no traceback, and the status."""
    assert "Traceback" not in done.stderr, done.stderr
    assert done.returncode == status, (done.returncode, done.stderr)
    told = sentences(done.stderr)
    assert told, done.stderr
    tally.told += 1
    tally.sentences.add(told[-1])


def answers(toy: ToyRepository, root: Path = Path("/")) -> dict[str, str]:
    """What is finished: every file under its own name, each of which must be whole."""
    results = root / toy.results.relative_to("/")
    found = {}
    for path in sorted(results.glob("cases/*/[!.]*")):
        text = path.read_text()
        if path.suffix == ".json":
            assert isinstance(json.loads(text), dict), path
        elif path.suffix == ".toml":
            tomllib.loads(text)
        elif path.suffix == ".html":
            assert text.rstrip().endswith("</html>"), path
        found[str(path.relative_to(results))] = text
    return found


def check_afterwards(study: Study, before: dict[str, str], tally: Tally, root: Path = Path("/")) -> None:
    """What was finished before the fault is still there, unless the pages of a report; one run more completes the study."""
    results = root / study.toy.results.relative_to("/")
    after = answers(study.toy, root)
    for name, text in before.items():
        if not name.endswith(".html"):
            assert after.get(name) == text, f"{name} is lost or changed"
    tally.unfinished_files += sum(path.is_file() for path in results.rglob(".*.*"))
    complete(study, tally, root)


def complete(study: Study, tally: Tally, root: Path = Path("/")) -> None:
    results = root / study.toy.results.relative_to("/")
    done = study.finish(study.start())
    assert done.returncode == 0, done.stderr
    assert (results / "table.csv").read_text() == study.table
    assert not list(results.glob("cases/*/.*")), "unfinished files stay"
    tally.completed_afterwards += 1


def make_slower(toy: ToyRepository) -> None:
    files = toy.folder / "geometries" / "common" / "files.py"
    written = files.read_text()
    slower = written.replace(
        "        os.replace(",
        # Not time.sleep, which libfaketime breaks.
        f'        __import__("select").select([], [], [], {_SLOWER})\n        os.replace(',
    )
    assert slower != written
    files.write_text(slower)


def at_work(process: subprocess.Popen[str]) -> bool:
    """Whether it has the lock of a folder: the file of that name stays when its owner ends."""
    locks = (line.split() for line in Path("/proc/locks").read_text().splitlines())
    return any(words[1] == "FLOCK" and words[4] == str(process.pid) for words in locks if "->" not in words)


def wait_until_at_work(process: subprocess.Popen[str]) -> None:
    """Or until it has ended."""
    while process.poll() is None and not at_work(process):
        time.sleep(0.01)


@contextmanager
def small_file_system(folder: Path, kilobytes: int) -> Iterator[tuple[int, tuple[str, ...]] | None]:
    """A file system of that size mounted on a folder for the processes that the prefix starts, and for no other; the process whose
    namespace it is, and the prefix. None where mounting is not allowed."""
    folder.mkdir(parents=True, exist_ok=True)
    user = () if os.geteuid() == 0 else ("--user", "--map-root-user")
    mount = f'mount -t tmpfs -o size={kilobytes}k none "$0" && echo mounted && exec sleep 1000'
    holder = subprocess.Popen(
        ["unshare", "--mount", *user, "sh", "-c", mount, str(folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert holder.stdout is not None
        if holder.stdout.readline().strip() != "mounted":
            yield None
            return
        into = ("--user", "--preserve-credentials") if user else ()
        yield holder.pid, ("nsenter", "--target", str(holder.pid), "--mount", *into, "--wd=.")
    finally:
        holder.kill()
        holder.wait()
