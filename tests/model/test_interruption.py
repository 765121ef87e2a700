"""Ctrl-C, limits of time and threads: what takes long ends with what is known so far, and several threads may ask at once.

What is asked for would take minutes: the outcome shows that it was ended, however busy the machine is."""

import json
import math
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

import fringe
import numpy as np
import pytest

from tests import scenes
from tests.programs import FRINGE, ROOT, fringe_command, shown_on_a_terminal
from tests.waiting import DEADLINE

Done = subprocess.CompletedProcess[str]

SENSOR = scenes.sensor("front", [[-0.03, -0.02, 0], [0.06, 0, 0], [0, 0.04, 0]])
# Minutes by every method at its finest.
LONG = SENSOR + (
    scenes.body(
        "arm",
        "cylinder",
        radius=0.06,
        height=0.5,
        segments=48,
        rotation={"axis": [1, 0, 0], "degrees": 90},
        translation=[0, 0.25, -0.062],
    )
    + scenes.body("hand", "sphere", radius=0.05, segments=32, translation=[0, 0, 0.17])
)
# The reduced method takes about a second for this scene.
SHORT = SENSOR + scenes.body("hand", "sphere", radius=0.05, segments=16, translation=[0, 0, 0.17])
# This scene has its first matrix after about a second.
REFINED = SENSOR + (
    scenes.body("a", "cone", radius=0.05, height=0.1, segments=24, translation=[0, 0, 0.07])
    + scenes.body("b", "cylinder", radius=0.05, height=0.1, segments=24, translation=[0.15, 0, 0.07])
    + scenes.body("c", "cylinder", radius=0.05, height=0.1, segments=24, translation=[-0.15, 0, 0.07])
)
MOTION = scenes.table("frame", name="first") + scenes.table("frame", name="second")


@contextmanager
def alarm(seconds: float) -> Iterator[None]:
    """Raises TimeoutError after some seconds, as Ctrl-C raises KeyboardInterrupt."""

    def ring(_: int, __: FrameType | None) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


CALLS: dict[str, Callable[[fringe.Scene, Path], object]] = {
    "maxwell": lambda scene, _: scene.maxwell(rtol=1e-4),
    "readings": lambda scene, _: scene.readings("boundary-elements", rtol=1e-4),
    "capacitance": lambda scene, _: scene.capacitance("reduced", rtol=3e-4, entries=True),
    "readings of": lambda scene, motion: scene.readings_of(motion, "boundary-elements", rtol=1e-4),
}


@pytest.mark.parametrize(
    ("call", "seconds"), [("maxwell", 0.1), ("readings", 0.1), ("capacitance", 1.0), ("readings of", 1.0)]
)
def test_a_signal_ends_a_call_in_python(call: str, seconds: float, tmp_path: Path) -> None:
    motion = tmp_path / "motion.toml"
    motion.write_text(MOTION)
    scene = fringe.Scene.loads(LONG)
    with alarm(seconds), pytest.raises(TimeoutError):
        CALLS[call](scene, motion)


def test_ctrl_c_is_a_keyboard_interrupt() -> None:
    program = (
        "import fringe, signal, sys\n"
        # A shell that starts the tests in the background has its children ignore Ctrl-C.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "scene = fringe.Scene.loads(sys.argv[1])\n"
        "try:\n    print('begun', flush=True)\n    scene.maxwell(rtol=1e-4)\n    print('finished')\n"
        "except KeyboardInterrupt:\n    print('ended')"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program, LONG],
        stdout=subprocess.PIPE,
        text=True,
        env={"PYTHONPATH": str(ROOT / "build/python")},
    )
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=DEADLINE)[0] == "ended\n"


@pytest.mark.parametrize("call", CALLS)
def test_a_question_ends_a_call_on_another_thread(call: str, tmp_path: Path) -> None:
    motion = tmp_path / "motion.toml"
    motion.write_text(MOTION)
    scene = fringe.Scene.loads(LONG)
    asked = threading.Event()

    def ask() -> None:
        if asked.is_set():
            raise TimeoutError
        asked.set()

    def compute() -> None:
        with fringe.InterruptionScope(ask):
            CALLS[call](scene, motion)

    with ThreadPoolExecutor(1) as pool, pytest.raises(TimeoutError):
        pool.submit(compute).result()


def test_an_interrupted_scene_answers_as_if_nothing_had_been() -> None:
    scene = fringe.Scene.loads(SHORT)
    with alarm(0.05), pytest.raises(TimeoutError):
        scene.maxwell(method="reduced", rtol=0.1)
    expected = fringe.Scene.loads(SHORT).maxwell(method="reduced", rtol=0.1)["maxwell"]
    np.testing.assert_array_equal(scene.maxwell(method="reduced", rtol=0.1)["maxwell"], expected)


ENTRIES = ("--method", "boundary-elements", "--rtol", "3e-3", "--entries")


@dataclass(frozen=True)
class Whole:
    """A scene, its answer that nothing ended, and the seconds that it took."""

    scene: Path
    answer: dict[str, Any]
    seconds: float

    def first_that_answers(self, call: Callable[[float], Done]) -> Done:
        """Calls with ever more seconds, from far fewer than the whole answer takes: the first matrix takes a fifth of them."""
        seconds = self.seconds / 8
        while not (done := call(seconds)).stdout:
            seconds *= 1.5
        return done


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    path = tmp_path_factory.mktemp("refined") / "scene.toml"
    path.write_text(REFINED)
    begun = time.monotonic()
    answer = json.loads(fringe_command("capacitance", path, *ENTRIES, "--json").stdout)
    return Whole(path, answer, time.monotonic() - begun)


def test_after_the_limit_of_time_the_best_matrix_is_printed(whole: Whole) -> None:
    """Its errors are those reached, and hold what the finest matrix is."""
    words = ("capacitance", whole.scene, *ENTRIES, "--json", "--max-seconds")
    done = whole.first_that_answers(lambda seconds: fringe_command(*words, f"{seconds:g}"))
    assert done.returncode == 3
    told = rf"fringe: {whole.scene}: stopped after [\d.]+ s: an error of 0\.003 was not reached\n"
    assert re.fullmatch(told, done.stderr)
    found = json.loads(done.stdout)
    assert not found["reached"]
    differences = np.abs(np.array(found["maxwell"]) - whole.answer["maxwell"])
    assert np.all(differences <= np.array(found["error"]) + whole.answer["error"])


def interrupted(seconds: float, *words: str | Path) -> Done:
    """What came of the command that Ctrl-C ends after so many seconds."""
    process = subprocess.Popen([FRINGE, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=DEADLINE)
    return subprocess.CompletedProcess(process.args, process.returncode, output, errors)


def test_after_ctrl_c_the_command_prints_the_best_matrix(whole: Whole) -> None:
    done = whole.first_that_answers(
        lambda seconds: interrupted(seconds, "capacitance", whole.scene, *ENTRIES)
    )
    assert done.returncode == 130 and "NOT reached" in done.stdout
    assert done.stderr == f"fringe: {whole.scene}: interrupted: an error of 0.003 was not reached\n"


def test_an_interrupted_sweep_keeps_the_frames_that_are_finished(tmp_path: Path) -> None:
    path, frames = tmp_path / "scene.toml", 400
    path.write_text(SHORT)
    path.with_suffix(".motion.toml").write_text("[[frame]]\n" * frames)
    seconds, finished = 0.5, 0
    while finished < 1:
        done = interrupted(seconds, "sweep", path, "--method", "boundary-elements", "--rtol", "1e-3")
        finished = len(done.stdout.splitlines()) - 1
        seconds *= 2
    assert done.returncode == 130 and finished < frames
    assert done.stderr.startswith(f"fringe: {path}: interrupted after {finished} of {frames} frames\n")


def test_on_a_terminal_the_progress_is_shown_and_erased(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(REFINED)
    shown = shown_on_a_terminal("capacitance", path, "--method", "boundary-elements", "--entries")
    assert re.search(r"\r\x1b\[K\d+ unknowns, error [\d.e-]+ of 0.01 asked for, [\d.]+ s", shown)
    # Only what the command says of the accuracy stands after it.
    assert re.search(r"\r\x1b\[K(fringe: [^\r]*\r\n)?$", shown)


SCENE = (
    scenes.link("arm")
    + scenes.sensor("front", [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]], link="arm")
    + scenes.body("ball", "sphere", radius=0.05, segments=24, translation=[0.01, 0.02, 0.2])
)
THREADS, POSES = 4, 12


def answers(path: Path) -> list[Any]:
    """Of a scene of its own that moves: capacitances, collisions and what stands where."""
    scene = fringe.Scene.load(str(path))
    found = []
    for step in range(POSES):
        turned = math.radians(5 * step)
        rotation = [
            [math.cos(turned), -math.sin(turned), 0],
            [math.sin(turned), math.cos(turned), 0],
            [0, 0, 1],
        ]
        scene.set_pose("arm", [0, 0, 0.005 * step], rotation)
        found.append([scene.capacitance()["sensors"], scene.collide()])
    return found


def test_every_thread_has_the_answers_of_one_alone(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    alone = answers(path)
    with ThreadPoolExecutor(THREADS) as pool:
        together = list(pool.map(answers, [path] * THREADS))
    assert all(found == alone for found in together)
