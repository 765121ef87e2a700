"""The methods that state errors, the names of what they answer, and how they are asked for one answer with a limit of time: by the model's Python module, in a process
of its own whose end ends no run.

Those names are of parts of readings, also in poses of a motion, and of entries of the Maxwell matrix where there are none."""

import math
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection
from types import FrameType
from typing import Any

from analysis.pipeline.model_stage import model_module
from geometries.common.children import end_with
from geometries.scene.readings import readings
from geometries.scene.scene import Scene

FIELD_SOLVER = "field-solver"
BOUNDARY_ELEMENTS = "boundary-elements"
AUTO = "auto"
METHODS: dict[str, dict[str, Any]] = {
    "formula": {"method": "formula"},
    "reduced:1e-1": {"method": "reduced", "rtol": 1e-1},
    "reduced:1e-2": {"method": "reduced", "rtol": 1e-2},
    "reduced+entries:1e-2": {"method": "reduced", "rtol": 1e-2, "entries": True},
    "boundary-elements:1e-2": {"method": BOUNDARY_ELEMENTS, "rtol": 1e-2},
    "boundary-elements:3e-2": {"method": BOUNDARY_ELEMENTS, "rtol": 3e-2},
    "auto:1e-2": {"method": AUTO, "rtol": 1e-2},
}
"""The methods of the library, with their options in Python; after a colon is the relative accuracy asked for, of the entries of the
Maxwell matrix, too, where the name says so."""
ALL = (*METHODS, FIELD_SOLVER)

FINER = "boundary-elements, finer"
"""The answer that others are held against: boundary elements at a tenth of the error, round bodies with more sides."""
FINER_RTOL = 1e-3
FINER_SECONDS = 20.0
"""After which it ends with the best that it has."""

FIELD_RTOL = 1e-2
FIELD_SECONDS = 60.0
"""After which the field solver starts no further mesh."""


@dataclass(frozen=True)
class Stated:
    """A value (F) and the error stated of it; None where the method says that it does not know one. `by` is who answered."""

    value: float | None
    error: float | None
    by: str = ""


@dataclass(frozen=True)
class Answer:
    """What one method made of a scene: values by the names of the quantities, or why there are none, and seconds of the clock. `key`
    stands for the scene, the options and the code that answered; `reached` tells whether a Maxwell matrix is as accurate as asked, and
    `guess` is the time that `auto` expected over the time that it took."""

    outcome: str
    seconds: float = 0.0
    reason: str = ""
    values: dict[str, Stated] = field(default_factory=dict)
    key: str = ""
    reached: bool | None = None
    guess: float | None = None


ANSWERED, REFUSED, LATE, ENDED = "answered", "refused", "late", "ended"
"""Outcomes of a question: an answer, a refusal by name, none in time, and a process that ended or an error that names no input."""

CHANGE = "change"
PARTS = ("value", "background", CHANGE)


def part_of(reading: str, part: str) -> str:
    """Returns the name of a part of a reading, one of PARTS."""
    return f"{reading}: {part}"


def in_pose(reading: str, number: int) -> str:
    """Returns the name of a reading in a pose of a motion, which is counted from 0."""
    return f"{reading} in pose {number}"


def pair(sensor: str, body: str) -> str:
    """Returns the name of the capacitance between a sensor and a body, by themselves."""
    return f"C[{sensor}, {body}]"


def entry(first: str, second: str) -> str:
    """Returns the name of an entry of the Maxwell matrix, which is symmetrical: the same for both orders of the conductors."""
    return f"M[{', '.join(sorted((first, second)))}]"


def has_readings(scene: Scene) -> bool:
    """Tells whether the scene has readings; else its Maxwell matrix is asked for."""
    return bool(readings(scene))


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
        values = matrix_values(*whole) if "maxwell" in answer else _pairs(answer)
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
    by_auto = answer["options"]["method"] == AUTO
    return float(answer["expected_seconds"] / answer["seconds"]) if by_auto else None


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


def matrix_values(names: Sequence[str], values: Any, errors: Any, by: str) -> dict[str, Stated]:
    """Returns what is stated of the entries of a Maxwell matrix."""
    places = ((i, j) for i in range(len(names)) for j in range(i + 1))
    numbers = ((i, j, float(values[i][j]), float(errors[i][j])) for i, j in places)
    return {entry(names[i], names[j]): stated(value, error, by) for i, j, value, error in numbers}


def stated(value: float | None, error: float | None, by: str) -> Stated:
    """Returns what is stated; a number that is not finite is one that is not known."""
    value, error = (each if each is not None and math.isfinite(each) else None for each in (value, error))
    return Stated(value, error, by)


def _ring(number: int, frame: FrameType | None) -> None:
    raise TooLong


_WAITING, _GRACE = 10.0, 60.0
"""How many times the limit of processor time an answer may take by the clock, and seconds more within which the library has to notice it."""
_STARTING = 60.0
"""Seconds that a process may take to start."""
_PATIENCE = 0.2
"""Seconds after which the waiting thread looks whether it is to stop."""


class Worker(AbstractContextManager["Worker"]):
    """One process at a time, started when it is first asked, and anew after it has ended; a context manager."""

    def __init__(self) -> None:
        self._process: Any = None
        self._pipe: Connection | None = None

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
        if self._pipe is not None:
            self._process.kill()
            self._process.join()
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
