"""Faults in a running study: nothing finished is lost or damaged, the user reads a sentence and no traceback, and the same command, left
alone, makes the table of an undisturbed run. Reference and model answer at once; the commands and all that is written are the real ones.

Each kind of fault is made once, by night, at a moment of chance; FRINGE_FAULTS=20 makes each so many times.
"""

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.analysis.nightly.toy_repository import ToyRepository
from tests.waiting import DEADLINE

pytestmark = pytest.mark.night

CASES = 6
ROUNDS = int(os.environ.get("FRINGE_FAULTS", "1"))
FAILED, INTERRUPTED = 1, 130
Done = subprocess.CompletedProcess[str]


class Study:
    """A toy study with the table and the seconds of an undisturbed run. `prefix` stands before every command, `root` before the
    paths of its file system."""

    def __init__(self, folder: Path) -> None:
        self.toy = ToyRepository(folder / "disturbed", CASES)
        self.toy.make_writing_slower()
        self.prefix: tuple[str, ...] = ()
        self.root = Path("/")
        begun = time.monotonic()
        done = self.finish(self.start())
        assert done.returncode == 0, done.stderr
        self.seconds, self.table = time.monotonic() - begun, self.toy.table()

    @property
    def results(self) -> Path:
        return self.root / self.toy.results.relative_to("/")

    def start(self, before: Callable[[], None] | None = None, **variables: str) -> subprocess.Popen[str]:
        return self.toy.start("run", prefix=self.prefix, before=before, **variables)

    def finish(self, process: subprocess.Popen[str]) -> Done:
        try:
            output, errors = process.communicate(timeout=DEADLINE)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            raise
        assert "Traceback" not in errors, errors
        return subprocess.CompletedProcess(process.args, process.returncode, output, errors)

    def answers(self) -> dict[str, str]:
        """Every file under its own name, each of which must be whole."""
        found = {}
        for path in sorted(self.results.glob("cases/*/[!.]*")):
            text = path.read_text()
            if path.suffix == ".json":
                assert isinstance(json.loads(text), dict), path
            elif path.suffix == ".toml":
                tomllib.loads(text)
            elif path.suffix == ".html":
                assert text.rstrip().endswith("</html>"), path
            found[path.relative_to(self.results).as_posix()] = text
        return found

    def check(self, before: dict[str, str]) -> None:
        """What was finished before the fault is still there, unless the pages of a report; one run more completes the study."""
        after = self.answers()
        for name, text in before.items():
            if not name.endswith(".html"):
                assert after.get(name) == text, f"{name} is lost or changed"
        done = self.finish(self.start())
        assert done.returncode == 0, done.stderr
        assert (self.results / "table.csv").read_text() == self.table
        assert not list(self.results.glob("cases/*/.*")), "unfinished files stay"

    def wait_until_at_work(self, process: subprocess.Popen[str]) -> None:
        """Returns when a process has the lock of a folder, or has ended: the file of the lock stays when its owner ends."""
        while process.poll() is None:
            locks = (
                line.split() for line in Path("/proc/locks").read_text().splitlines() if "->" not in line
            )
            if any(words[1] == "FLOCK" and words[4] == str(process.pid) for words in locks):
                return
            time.sleep(0.01)


def is_told(done: Done, status: int = FAILED) -> bool:
    """Whether a run ended with this status and a sentence."""
    lines = done.stderr.replace("\r", "\n").splitlines()
    return done.returncode == status and any(line.startswith("analysis: ") for line in lines)


def killed(study: Study, chance: random.Random) -> None:
    """SIGKILL at any moment, to the process or to all of its session."""
    before, process = study.answers(), study.start()
    time.sleep(chance.uniform(0, study.seconds))
    with suppress(ProcessLookupError):
        (os.kill if chance.random() < 0.5 else os.killpg)(process.pid, signal.SIGKILL)
    process.communicate(timeout=DEADLINE)
    study.check(before)


def stopped(study: Study, chance: random.Random) -> None:
    """SIGTERM as from a system that shuts down, or Ctrl-C; now and then twice."""
    before, process = study.answers(), study.start()
    number = chance.choice((signal.SIGTERM, signal.SIGINT))
    # A signal before then would end a command that has written nothing yet.
    study.wait_until_at_work(process)
    time.sleep(chance.uniform(0, study.seconds))
    process.send_signal(number)
    if chance.random() < 0.3:
        time.sleep(chance.uniform(0, 0.05))
        process.send_signal(number)
    done = study.finish(process)
    # It was at its end, or the interpreter was, after the command's.
    assert done.returncode in (0, -number) or is_told(done, INTERRUPTED), done
    study.check(before)


def second_run(study: Study, chance: random.Random) -> None:
    """A second run of the same study is refused, although the lock's file was there before both; the first one goes on."""
    study.results.mkdir(parents=True, exist_ok=True)
    (study.results / ".lock").touch()
    # Without work the first one would be at its end before the second comes.
    for answer in sorted(study.results.glob("cases/*/fem.json"))[:4]:
        answer.unlink()
    first = study.start(TOY_SECONDS=str(2 * DEADLINE))
    study.wait_until_at_work(first)
    time.sleep(chance.uniform(0, 0.5))
    second = study.finish(study.start())
    assert is_told(second) and "in use" in second.stderr and first.poll() is None, second
    os.killpg(first.pid, signal.SIGKILL)
    first.communicate(timeout=DEADLINE)
    study.check({})


def folder_removed(study: Study, chance: random.Random) -> None:
    """The folder of the results vanishes while the study runs."""
    process = study.start()
    study.wait_until_at_work(process)
    time.sleep(chance.uniform(0, study.seconds))
    shutil.rmtree(study.results, ignore_errors=True)
    done = study.finish(process)
    # All that was missing may have been written again.
    assert done.returncode == 0 or is_told(done), done
    study.check({})


def no_space(study: Study, chance: random.Random) -> None:
    """A file system that is full before the study is done; then it has space again."""
    with small_file_system(study, chance.randrange(4, 200)):
        done = study.finish(study.start())
        assert is_told(done) and "No space left" in done.stderr, done
        before = study.answers()
        remount(study, "size=200m")
        study.check(before)


def read_only(study: Study, chance: random.Random) -> None:
    """A folder in which nothing can be written, half of the time with answers in it."""
    with small_file_system(study, 200_000):
        if chance.random() < 0.5:
            assert study.finish(study.start()).returncode == 0
        before = study.answers()
        remount(study, "ro")
        assert is_told(study.finish(study.start()))
        remount(study, "rw")
        study.check(before)


def write_fails(study: Study, chance: random.Random) -> None:
    """Files cannot grow beyond a size."""
    most, before = chance.randrange(100, 20_000), study.answers()
    done = study.finish(study.start(lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))))
    # Nothing may have been left to write.
    assert done.returncode == 0 or is_told(done), done
    study.check(before)


def no_memory(study: Study, chance: random.Random) -> None:
    """The process, and all that it starts, gets less memory than it asks for; with very little the interpreter does not begin."""
    most, before = chance.randrange(40, 400) * 2**20, study.answers()
    process = study.start(lambda: resource.setrlimit(resource.RLIMIT_AS, (most, most)))
    process.communicate(timeout=DEADLINE)
    study.check(before)


def clock_jumps(study: Study, chance: random.Random) -> None:
    """The machine's clock is set years back or ahead while the study runs."""
    library = next(iter(Path("/usr/lib").glob("*/faketime/libfaketime.so.1")), None)
    if library is None:
        pytest.skip("faketime is not installed")
    clock, before = study.toy.folder / "clock", study.answers()
    clock.write_text("+0")
    file = {"LD_PRELOAD": str(library), "FAKETIME_TIMESTAMP_FILE": str(clock)}
    process = study.start(FAKETIME_NO_CACHE="1", FAKETIME_DONT_FAKE_MONOTONIC="1", **file)
    study.wait_until_at_work(process)
    while process.poll() is None:
        following = clock.with_suffix(".following")
        following.write_text(f"{chance.choice('+-')}{chance.randrange(1, 3000)}d")
        following.replace(clock)
        time.sleep(chance.uniform(0, 0.2))
    assert study.finish(process).returncode == 0
    study.check(before)


@contextmanager
def small_file_system(study: Study, kilobytes: int) -> Iterator[None]:
    """Mounts a file system of that size where the results are, for the study's processes alone."""
    folder = study.toy.results.parent
    folder.mkdir(parents=True, exist_ok=True)
    user = () if os.geteuid() == 0 else ("--user", "--map-root-user")
    mount = f'mount -t tmpfs -o size={kilobytes}k none "$0" && echo mounted && exec sleep 1000'
    command = ["unshare", "--mount", *user, "sh", "-c", mount, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as holder:
        try:
            assert holder.stdout is not None
            if holder.stdout.readline().strip() != "mounted":
                pytest.skip("mounting is not allowed here")
            into = ("--user", "--preserve-credentials") if user else ()
            study.prefix = ("nsenter", "--target", str(holder.pid), "--mount", *into, "--wd=.")
            study.root = Path(f"/proc/{holder.pid}/root")
            yield
        finally:
            study.prefix, study.root = (), Path("/")
            holder.kill()


def remount(study: Study, option: str) -> None:
    results = str(study.toy.results.parent)
    subprocess.run([*study.prefix, "mount", "-o", f"remount,{option}", results], check=True)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return Study(tmp_path_factory.mktemp("disturbed studies"))


KINDS = (
    *(killed, stopped, second_run, folder_removed, no_space),
    *(read_only, write_fails, no_memory, clock_jumps),
)


@pytest.mark.parametrize("fault", KINDS, ids=lambda fault: fault.__name__)
def test_nothing_is_lost_it_is_told_and_the_next_run_completes(
    study: Study, fault: Callable[[Study, random.Random], None]
) -> None:
    chance = random.Random(1)
    for _ in range(ROUNDS):
        if chance.random() < 0.7:
            shutil.rmtree(study.toy.results, ignore_errors=True)
        fault(study, chance)
