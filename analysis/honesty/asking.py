"""Asks for one answer with a limit of time: the model's Python module, in a process of its own whose end ends no run, and the field solver."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType
from typing import Any

from analysis.honesty.kinds import Drawn
from analysis.honesty.methods import (
    ANSWERED,
    AUTO,
    CHANGE,
    ENDED,
    FIELD_RTOL,
    FIELD_SECONDS,
    FIELD_SOLVER,
    LATE,
    PARTS,
    REFUSED,
    Answer,
    Stated,
    entry,
    in_pose,
    pair,
    part_of,
)
from analysis.pipeline import reference_stage
from analysis.pipeline.model_stage import model_module
from analysis.pipeline.stage import NoAnswer, Processes, Refused
from analysis.results.answers import MatrixAnswer
from analysis.results.store import write_text
from geometries.common.children import end_with

_LONGEST_REASON = 300


class TooLong(Exception):
    """An answer takes longer than it may."""


def ask(text: str, has_readings: bool, options: dict[str, Any], seconds: float) -> Answer:
    """Answers a scene's text: parts of its readings or, if it has none, entries of its Maxwell matrix, or the capacitances of its pairs where
    the method finds no matrix; with the option `motion`, an array of poses, the changes in each of them. What takes more than `seconds`
    of processor time has no answer: that is the same on a busy machine. To be called on the main thread only, whose signals end what takes too long.
    """
    before = signal.signal(signal.SIGPROF, _ring)
    begin = time.monotonic()

    def outcome(kind: str, reason: str = "") -> Answer:
        return Answer(kind, time.monotonic() - begin, reason[:_LONGEST_REASON])

    try:
        signal.setitimer(signal.ITIMER_PROF, seconds)
        try:
            found = _answered(text, has_readings, options)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
    except TooLong:
        return outcome(LATE)
    except ValueError as error:
        return outcome(REFUSED, str(error))
    # Whatever else the library raises is a finding, not an end of the run.
    except Exception as error:
        return outcome(ENDED, f"{type(error).__name__}: {error}")
    finally:
        signal.signal(signal.SIGPROF, before)
    return replace(found, seconds=time.monotonic() - begin)


def _answered(text: str, has_readings: bool, options: dict[str, Any]) -> Answer:
    scene = model_module().Scene.loads(text)
    if "motion" in options:
        return Answer(ANSWERED, values=_changes(scene.readings_of(**options)))
    if not has_readings:
        # The formula knows no entries of a matrix.
        entries = {} if options["method"] == "formula" else {"entries": True}
        answer = scene.capacitance(**{**options, **entries})
        whole = [answer.get(name) for name in ("conductors", "maxwell", "error", "answered_by")]
        values = _matrix(*whole) if "maxwell" in answer else _pairs(answer)
        return Answer(ANSWERED, values=values, reached=answer.get("reached"), guess=_guess(answer))
    if options["method"] == AUTO:
        answer = scene.capacitance(**options)
        values = {
            part_of(each["name"], part): stated(each[part], each["error"][part], each["answered_by"])
            for each in answer["readings"]
            for part in PARTS
        }
        return Answer(ANSWERED, values=values, guess=_guess(answer))
    values = {
        part_of(name, part): stated(getattr(reading, part), reading.error[part], reading.answered_by)
        for name, reading in scene.readings(**options).items()
        for part in PARTS
    }
    return Answer(ANSWERED, values=values)


def _guess(answer: dict[str, Any]) -> float | None:
    if answer["options"]["method"] != AUTO:
        return None
    return float(answer["expected_seconds"] / answer["seconds"])


def _changes(answer: Any) -> dict[str, Stated]:
    """Returns the changes in each pose."""
    return {
        part_of(in_pose(name, frame), CHANGE): stated(
            float(answer.change[frame, column]),
            float(answer.error["change"][frame, column]),
            answer.answered_by[frame][column],
        )
        for frame in range(len(answer.frames))
        for column, name in enumerate(answer.readings)
    }


def _pairs(answer: dict[str, Any]) -> dict[str, Stated]:
    if not answer["sensors"]:
        raise ValueError("finds no Maxwell matrix")
    return {
        pair(sensor["name"], each["name"]): stated(each["capacitance"], each["error"], each["answered_by"])
        for sensor in answer["sensors"]
        for each in sensor["objects"]
    }


def _matrix(names: Sequence[str], values: Any, errors: Any, by: str) -> dict[str, Stated]:
    return {
        entry(names[i], names[j]): stated(float(values[i][j]), float(errors[i][j]), by)
        for i in range(len(names))
        for j in range(i + 1)
    }


def stated(value: float | None, error: float | None, by: str) -> Stated:
    """Returns what is stated; a number that is not finite is one that is not known."""
    return Stated(_known(value), _known(error), by)


def _known(number: float | None) -> float | None:
    return number if number is not None and math.isfinite(number) else None


def _ring(number: int, frame: FrameType | None) -> None:
    raise TooLong


_WAITING, _GRACE = 10.0, 60.0
"""How many times the limit of processor time an answer may take by the clock, and seconds more within which the library has to notice it."""
_STARTING = 60.0
"""Seconds that a process may take to start."""
_PATIENCE = 0.2
"""Seconds after which the waiting thread looks whether it is to stop."""


class Worker:
    """One process at a time, started when it is first asked, and anew after it has ended; a context manager."""

    def __init__(self) -> None:
        self._process: Any = None
        self._pipe: Connection | None = None

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def ask(
        self,
        text: str,
        has_readings: bool,
        options: dict[str, Any],
        seconds: float,
        go_on: Callable[[], None],
    ) -> Answer:
        """Returns the answer of `asking.ask`, or how the process ended; `go_on` raises when the run is to stop."""
        pipe = self._started()
        begin = time.monotonic()
        try:
            pipe.send((text, has_readings, options, seconds))
            while time.monotonic() - begin < _WAITING * seconds + _GRACE:
                if pipe.poll(_PATIENCE):
                    answer: Answer = pipe.recv()
                    return answer
                go_on()
            self.end()
            return Answer(LATE, time.monotonic() - begin, "does not notice the limit of time")
        except (EOFError, OSError):
            self._process.join()
            code = self._process.exitcode
            self.end()
            how = f"signal {-code} ({signal.strsignal(-code)})" if code < 0 else f"status {code}"
            return Answer(ENDED, time.monotonic() - begin, f"the process ended by {how}")
        except BaseException:
            self.end()
            raise

    def end(self) -> None:
        """Ends the process, if there is one."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
        if self._pipe is not None:
            self._pipe.close()
        self._process = self._pipe = None

    def _started(self) -> Connection:
        if self._pipe is None:
            context = multiprocessing.get_context("spawn")
            self._pipe, other = context.Pipe()
            self._process = context.Process(target=_serve, args=(other, os.getpid()), daemon=True)
            with _STARTS:
                self._process.start()
            other.close()
            # The first message says that the modules are loaded.
            if not self._pipe.poll(_STARTING):
                raise OSError("a process does not start")
            self._pipe.recv()
        return self._pipe


_STARTS = threading.Lock()
"""Processes are started one after the other: their ends of pipes must not be inherited by others."""


def _serve(pipe: Connection, parent: int) -> None:
    """Answers until the pipe ends."""
    end_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    model_module()
    pipe.send(None)
    while True:
        try:
            asked = pipe.recv()
        except EOFError:
            return
        pipe.send(ask(*asked))


_SCENES = "scenes"
_LATE = "no level was finished within"


def field_answer(scene: Drawn, folder: Path, processes: Processes) -> Answer:
    """Answers a scene, which is written to a file in the folder, by the field solver's intervals."""
    file = folder / _SCENES / f"{scene.seed}.toml"
    write_text(file, scene.text)
    asked = ["--rtol", repr(FIELD_RTOL), "--max-seconds", repr(FIELD_SECONDS)]
    if scene.has_readings:
        asked.append("--only-readings")
    begin = time.monotonic()
    try:
        answer = MatrixAnswer.of(reference_stage.solve(file, processes, *asked))
    except Refused as error:
        return Answer(REFUSED, time.monotonic() - begin, str(error))
    except NoAnswer as error:
        return Answer(LATE if _LATE in str(error) else ENDED, time.monotonic() - begin, str(error))
    matrix = answer.conductors, answer.maxwell, answer.error, FIELD_SOLVER
    values = _readings(answer) if scene.has_readings else _matrix(*matrix)
    return Answer(ANSWERED, time.monotonic() - begin, values=values)


def _readings(answer: MatrixAnswer) -> dict[str, Stated]:
    return {
        part_of(name, part): stated(getattr(reading, part).value, getattr(reading, part).error, FIELD_SOLVER)
        for name, reading in answer.readings.items()
        for part in PARTS
    }
