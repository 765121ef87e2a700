"""The kinds of faults: each function makes one fault, and checks what must hold of the run and of the next one."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import subprocess
import time
from pathlib import Path

from tests.faults.harness import (
    Study,
    Tally,
    answers,
    check_afterwards,
    complete,
    expect_told,
    sentences,
    small_file_system,
    wait_until_at_work,
)
from tests.waiting import DEADLINE

FAILED, INTERRUPTED = 1, 130


def killed(study: Study, chance: random.Random, tally: Tally) -> None:
    """SIGKILL at any moment, to the process or to all of its session."""
    before, process = answers(study.toy), study.start()
    time.sleep(chance.uniform(0, study.seconds))
    tally.during_the_run += process.poll() is None
    if chance.random() < 0.5:
        process.kill()
    else:
        _signal_group(process, signal.SIGKILL)
    process.communicate(timeout=DEADLINE)
    check_afterwards(study, before, tally)


def terminated(study: Study, chance: random.Random, tally: Tally) -> None:
    """SIGTERM as from a system that shuts down."""
    _stopped(study, chance, tally, signal.SIGTERM)


def interrupted(study: Study, chance: random.Random, tally: Tally) -> None:
    """Ctrl-C, now and then twice."""
    _stopped(study, chance, tally, signal.SIGINT)


def _stopped(study: Study, chance: random.Random, tally: Tally, number: signal.Signals) -> None:
    before, process = answers(study.toy), study.start()
    # What ends before then has done nothing.
    wait_until_at_work(process)
    time.sleep(chance.uniform(0, study.seconds))
    running = process.poll() is None
    process.send_signal(number)
    if chance.random() < 0.3:
        time.sleep(chance.uniform(0, 0.05))
        process.send_signal(number)
    done = study.finish(process)
    tally.during_the_run += running
    if done.returncode == 0:
        tally.told += 1  # it was at its end
    else:
        # The interpreter's own end, after the command's, is no affair of ours.
        assert done.returncode in (INTERRUPTED, -number), (done.returncode, done.stderr)
        if done.returncode == INTERRUPTED:
            expect_told(done, tally, INTERRUPTED)
        else:
            assert "Traceback" not in done.stderr, done.stderr
            tally.told += 1
    check_afterwards(study, before, tally)


def two_at_once(study: Study, chance: random.Random, tally: Tally) -> None:
    """A second run of the same study beside the first: it is refused, the first one does not notice."""
    # Without work the first one would be at its end before the second comes.
    for answer in sorted(study.toy.results.glob("cases/*/fem.json"))[:4]:
        answer.unlink()
    first = study.start(TOY_SECONDS="1")
    wait_until_at_work(first)
    time.sleep(chance.uniform(0, 0.5))
    second = study.finish(study.start())
    tally.during_the_run += first.poll() is None
    if second.returncode != 0:
        expect_told(second, tally, FAILED)
        assert "in use" in second.stderr
    else:
        tally.told += 1  # the first one was at its end
    done = study.finish(first)
    assert done.returncode == 0, done.stderr
    complete(study, tally)


def folder_removed(study: Study, chance: random.Random, tally: Tally) -> None:
    """The folder of the results vanishes while the study runs."""
    process = study.start()
    wait_until_at_work(process)
    time.sleep(chance.uniform(0, study.seconds))
    tally.during_the_run += process.poll() is None
    shutil.rmtree(study.toy.results, ignore_errors=True)
    done = study.finish(process)
    assert "Traceback" not in done.stderr, done.stderr
    if done.returncode == 0:
        tally.told += 1  # all that was missing was written again, or it was at its end
    else:
        expect_told(done, tally, FAILED)
    complete(study, tally)


def no_space(study: Study, chance: random.Random, tally: Tally) -> None:
    """A file system that is full before the study is done; then it has space again."""
    results = study.toy.results.parent
    with small_file_system(results, chance.randrange(4, 200)) as mounted:
        if mounted is None:
            tally.skipped = "mounting is not allowed here"
            return
        holder, prefix = mounted
        inside = Study(study.toy, study.table, study.seconds, prefix)
        root = Path(f"/proc/{holder}/root")
        done = inside.finish(inside.start())
        assert "Traceback" not in done.stderr, done.stderr
        expect_told(done, tally, FAILED)
        assert "No space left" in done.stderr, done.stderr
        tally.during_the_run += 1
        before = answers(study.toy, root)
        subprocess.run([*prefix, "mount", "-o", "remount,size=200m", str(results)], check=True)
        check_afterwards(inside, before, tally, root)


def read_only(study: Study, chance: random.Random, tally: Tally) -> None:
    """A folder in which nothing can be written, half of the time with answers in it."""
    results = study.toy.results.parent
    with small_file_system(results, 200_000) as mounted:
        if mounted is None:
            tally.skipped = "mounting is not allowed here"
            return
        holder, prefix = mounted
        inside = Study(study.toy, study.table, study.seconds, prefix)
        root = Path(f"/proc/{holder}/root")
        if chance.random() < 0.5:
            assert inside.finish(inside.start()).returncode == 0
        before = answers(study.toy, root)
        subprocess.run([*prefix, "mount", "-o", "remount,ro", str(results)], check=True)
        expect_told(inside.finish(inside.start()), tally, FAILED)
        tally.during_the_run += 1
        subprocess.run([*prefix, "mount", "-o", "remount,rw", str(results)], check=True)
        check_afterwards(inside, before, tally, root)


def write_fails(study: Study, chance: random.Random, tally: Tally) -> None:
    """Files cannot grow beyond a size; needs no mount."""
    most = chance.randrange(100, 20_000)
    before = answers(study.toy)
    done = study.finish(study.start(lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))))
    if done.returncode == 0:
        tally.told += 1  # nothing was left to write
    else:
        expect_told(done, tally, FAILED)
        tally.during_the_run += 1
    check_afterwards(study, before, tally)


def no_memory(study: Study, chance: random.Random, tally: Tally) -> None:
    """The process, and all that it starts, gets less memory than it asks for."""
    most = chance.randrange(40, 400) * 2**20
    before = answers(study.toy)
    done = study.finish(study.start(lambda: resource.setrlimit(resource.RLIMIT_AS, (most, most))))
    tally.during_the_run += done.returncode != 0
    # With very little the interpreter does not come as far as the command.
    if sentences(done.stderr):
        assert done.returncode in (0, FAILED), (done.returncode, done.stderr)
        tally.told += 1
        tally.sentences.add(sentences(done.stderr)[-1])
    check_afterwards(study, before, tally)


def clock_jumps(study: Study, chance: random.Random, tally: Tally) -> None:
    """The machine's clock is set years back or ahead while the study runs."""
    library = next(iter(Path("/usr/lib").glob("*/faketime/libfaketime.so.1")), None)
    if library is None:
        tally.skipped = "faketime is not installed"
        return
    clock = study.toy.folder / "clock"
    clock.write_text("+0")
    before = answers(study.toy)
    process = study.start(
        LD_PRELOAD=str(library),
        FAKETIME_TIMESTAMP_FILE=str(clock),
        FAKETIME_NO_CACHE="1",
        FAKETIME_DONT_FAKE_MONOTONIC="1",
    )
    wait_until_at_work(process)
    while process.poll() is None:
        following = clock.with_suffix(".following")
        following.write_text(f"{chance.choice('+-')}{chance.randrange(1, 3000)}d")
        following.replace(clock)
        time.sleep(chance.uniform(0, 0.2))
    done = study.finish(process)
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr
    tally.during_the_run += 1
    tally.told += 1
    check_afterwards(study, before, tally)


KINDS = (
    killed,
    terminated,
    interrupted,
    two_at_once,
    folder_removed,
    no_space,
    read_only,
    write_fails,
    no_memory,
    clock_jumps,
)


def _signal_group(process: subprocess.Popen[str], number: signal.Signals) -> None:
    try:
        os.killpg(process.pid, number)
    except ProcessLookupError:
        pass
