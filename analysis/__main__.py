"""`python3 -m analysis`: the command line; `commands` does the work."""

from __future__ import annotations

import argparse
import math
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import Any

from geometries.common import installation
from geometries.common.arguments import positive_integer, positive_number

TOPICS = {
    "verify": "compare the reference with known capacitances (minutes; finished rows are kept)",
    "errors": "split the model's error into parts in hundreds of set-ups, by boundary elements (a minute or two; finished ones are kept)",
    "company": "Experiment VII: a hand before a sensor in company, by boundary elements (a minute or two; finished ones are kept)",
    "machines": "the model's error on machines, taken apart in hundreds of set-ups with stored truths by boundary elements (a minute; finished ones are kept)",
    "insulators": "Experiment VIII: covers, wet films, mattresses, blankets and insulating targets before a sensor, with stored truths by boundary elements (a minute; finished ones are kept)",
    "corrections": "evaluate the formula and the reduced method against boundary elements, with their run times",
}
"""What the commands of the topics do. The topics themselves load slow libraries, which this interpreter may lack."""
_FOLDERS = {"verify": "verification"}
"""The folders of results that are not called as the topic's command is."""
_MEASURED_TOGETHER = {"corrections"}
"""The topics that have one answer, which is computed at one time."""
# What shells report for a command that was interrupted.
_INTERRUPTED = 130


def _potential(text: str) -> float | None:
    """Returns the capacitance to ground (F): none for a grounded probe, 0 for a floating one."""
    named = {"grounded": None, "floating": 0.0}
    return named[text] if text in named else positive_number(text)


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least 0")
    return int(text)


def _share(text: str) -> float:
    return 1.0 if text == "1" else _relative(text)


def _relative(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number between 0 and 1")
    return value


Option = tuple[str, dict[str, Any]]
"""An option or argument with what `add_argument` is told of it."""
Command = tuple[str, tuple[Option | list[Option], ...]]
"""What a command does, and its options; of those in a list one at most may be given."""


def _option(name: str, metavar: str, does: str, **more: Any) -> Option:
    return name, {"metavar": metavar, "help": does, **more}


def _path(name: str, metavar: str, does: str, **more: Any) -> Option:
    return _option(name, metavar, does, type=Path, **more)


def _switch(name: str, does: str) -> Option:
    return name, {"action": "store_true", "help": does}


def _repeated(name: str, metavar: str, does: str) -> Option:
    return _option(name, metavar, does, action="append", default=[])


def _jobs(at_a_time: str) -> Option:
    does = f"{at_a_time} at a time (default: by cores and memory)"
    return _option("--jobs", "N", does, type=positive_integer)


_ALSO = "also verify the reference, as the command verify does, in the folder verification beside the results"
_VERIFY = _switch("--verify", _ALSO)
_SCENE = _option("scene", "SCENE", "a name in geometries/scenes, or a file")
_BEFORE_TOPICS: dict[str, Command] = {
    "run": ("compute a study's missing answers, then report", (
        _option("study", "STUDY", "a name in geometries/studies, or a file"),
        _path("--results", "DIR", "where to keep the results (default: results/<study>, in the current folder for a study that is not the repository's)"),
        _jobs("solves"),
        _switch("--measure-model", "also measure the model by itself: run time against error, stability, collisions (five minutes; kept with the results)"),
        _VERIFY,
    )),
    "nightly": ("run a study by Snakemake, add it to the trends, and tell what has changed", (
        _option("study", "STUDY", "default: nightly", nargs="?", default="nightly"),
        _path("--results", "DIR", "default: results/<study>"),
        _option("--jobs", "N", "jobs at a time on this machine", type=positive_integer),
        _option("--profile", "PROFILE", "run on a cluster: slurm, or the folder of another profile of Snakemake"),
        _option("--job-seconds", "S", "expected length of a job (default: 60 here, 600 on a cluster)", type=positive_integer),
        _VERIFY,
    )),
    "job": ("solve the cases of one job's file; Snakemake calls this", (("file", {"type": Path, "metavar": "FILE"}),)),
    "diff": ("compare two results; status 1 if any value moved by more than its error", (
        _path("old", "OLD", "a folder of results, or a table.csv"),
        _path("new", "NEW", "likewise"),
        _path("--output", "JSON", "also write all of it to this file"),
    )),
    "trends": ("tell what has changed over the nights, make their page, or find the commit of a change", (
        _path("results", "RESULTS", "a folder of results (default: results/nightly)", nargs="?"),
        [
            _option("--count", "COMMITS", "first add the instruction counts of these commits, as HEAD~10..HEAD, each built in a working tree of its own (minutes each)"),
            _option("--bisect", "VALUE", "find the commit of the last change of this value, as `trends` names it, by building commits in a working tree of their own"),
        ],
    )),
    "report": ("write table.csv, report.html and its pages from stored answers", (
        _path("results", "RESULTS", "a folder that `run` has filled"),
    )),
}  # fmt: skip
_AFTER_TOPICS: dict[str, Command] = {
    "documentation": ("make a site of all notes, algorithms and references (the model must be built)", (
        _path("--output", "DIR", "where to write the site (default: results/documentation)"),
    )),
    "show": ("write one page with a scene, its sensors' readings and its motion", (
        _SCENE,
        _path("--motion", "FILE", "the frames of its motion (default: SCENE.motion.toml beside it, if any)"),
        _path("--output", "FILE", "the page (default: <scene>.html in the current folder; results/show/<scene>.html for scenes of the repository)"),
        _switch("--readings", "plot the changes of the readings along the motion: model, formula and reduced method in every frame, boundary elements in those of the motion file"),
        _option("--between", "N", "frames shown between two of the motion file, with --readings (default: 8)", type=positive_integer),
        _option("--rtol", "R", "relative error asked of boundary elements, with --readings (default: 1e-2)", type=_relative),
    )),
    "live": ("write one page on which a scene can be moved: the library in it computes readings, distances and collisions in every frame", (
        _SCENE,
        _path("--motion", "FILE", "the frames of a path (default: SCENE.motion.toml beside it, if any)"),
        [
            _option("--rtol", "R", "relative error asked of the reference readings along the paths, by boundary elements (default: 1e-2)", type=_relative, default=1e-2),
            _switch("--no-reference", "solve no reference readings"),
        ],
        _path("--output", "FILE", "the page (default: <scene>.html in the current folder; results/live/<scene>.html for scenes of the repository)"),
    )),
    "sweep": ("write a table and a page of the readings in every frame of a motion, and where they cross their thresholds", (
        _SCENE,
        _path("--motion", "FILE", "the frames of its motion (default: SCENE.motion.toml beside it)"),
        _option("--method", "A,B,…", "methods of fringe sweep (default: exact,formula,auto,boundary-elements)"),
        _option("--rtol", "R", "relative error asked of those methods that state one (default: 1e-2)", type=float),
        _path("--output", "FILE.html", "the page, with the table beside it; frames that the table holds are not computed again (default: results/sweep/<scene>.html)"),
    )),
    "coverage": ("survey from which distance a probe is noticed at every place around a machine: a page, a table and a file for ParaView", (
        _SCENE,
        _repeated("--probe", "PROBE", "sphere:R, capsule:R:L, box:X:Y:Z (metres), mesh:FILE, finger, fist, hand or infant; may be repeated (default: sphere:0.02 and the four named ones)"),
        _repeated("--reading", "NAME", "a reading; may be repeated (default: all)"),
        _option("--grid", "M", "side of the square of surface for each place, in metres (default: about 2,000 places)", type=positive_number),
        _option("--potential", "P", "of the probe: grounded (default), floating, or a capacitance to ground in F", type=_potential),
        _option("--threshold", "F", "least change that is noticed (default: that of each reading, or five times its noise, or 2.5e-15)", type=positive_number),
        _option("--method", "A,B,…", "methods to compare with at a few places, those of fringe capacitance, formula and small-probe (default: exact,formula,small-probe); none: no comparison"),
        _path("--output", "FILE.html", "the page, with table and file beside it (default: results/coverage/<scene>.html)"),
    )),
    "honesty": ("ask every method for random scenes of every kind, and print how often its stated errors hold (hours; finished scenes are kept); status 1 if they hold less often than they should", (
        _option("--scenes", "N", "how many scenes (default: 416, 32 of each kind)", type=positive_integer),
        _option("--first", "SEED", "the first scene's seed (default: 0)", type=_seed),
        _option("--kinds", "A,B,…", "kinds of scenes (default: all)"),
        _option("--methods", "A,B,…", "methods that are asked (default: all)"),
        [
            _option("--field-solver", "SHARE", "part of the scenes for which the field solver is asked, up to a minute each (default: 0.05)", type=_share),
            _switch("--no-field-solver", "do not ask the field solver"),
        ],
        _option("--seconds", "S", "most processor time for an answer of the model (default: 10)", type=positive_number),
        _option("--only", "SEED", "print this scene and all answers instead", type=_seed),
        _path("--results", "DIR", "where to keep the answers (default: results/honesty)"),
        _jobs("scenes"),
    )),
    "golden": ("record answers, stated errors and times of boundary elements, the reduced method and the formula in set-ups with stored truths (six minutes), and compare them with an older record; status 1 if an answer left its error, or an error widened", (
        _path("file", "FILE", "the record, as JSON; its folder must be there"),
        _path("--against", "OLD", "an older record of the same cases"),
        _option("--only", "PATTERN", "only cases whose names hold this, in which * stands for anything, as in machines/*reduced", default=""),
        _switch("--times", "fail, not only warn, where a method takes 10 %% longer"),
    )),
}  # fmt: skip
_MEASURES: dict[str, Command] = {
    "truths": ("solve the set-ups of a topic that have no true values, by boundary elements; they are kept beside the topic's code", (
        ("topic", {"choices": ("corrections", "insulators", "machines"), "help": "a minute for the corrections, a quarter of an hour for the others; delete the file to solve all anew"}),
    )),
    "field-check": ("solve the set-ups of a topic that have no readings by the field solver; they are kept beside the topic's code", (
        ("topic", {"choices": ("company", "insulators", "machines"), "help": "an hour or so of one core for each; delete the file to solve all anew"}),
        _option("--seconds", "S", "begin none after these seconds", type=positive_number, default=math.inf),
        _switch("--boundary", "of the insulators that have a record, solve anew by boundary elements only"),
    )),
    "corrections": ("print the tables of errors in model/CORRECTIONS.md, section 5", ()),
    "benchmarks": ("replace the measured tables of model/MEASUREMENTS.md, in some minutes", ()),
}  # fmt: skip


def _topics() -> dict[str, Command]:
    """Returns the commands of the topics."""
    found: dict[str, Command] = {}
    for name, does in TOPICS.items():
        kept = f"where to keep the answers (default: results/{_FOLDERS.get(name, name)})"
        jobs = () if name in _MEASURED_TOGETHER else (_jobs("answers"),)
        found[name] = does, (_path("--output", "DIR", kept), *jobs)
    return found


def main(arguments: list[str] | None = None) -> int:
    """Runs the command line; returns the exit code."""
    options = _parser(installation.command("analysis")).parse_args(arguments)
    before = {number: signal.signal(number, _interrupt) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        needs_solver = options.command not in ("coverage", "live", "show", "sweep")
        installation.continue_with("dolfinx" if needs_solver else "plotly")
        # The packages that commands import are slow, and this interpreter may lack them until here.
        from analysis.commands import run_command

        return run_command(options)
    except KeyboardInterrupt:
        kept = "finished cases are kept, the same command goes on from there"
        left = "nothing is written" if options.command == "golden" else kept
        print(f"\nanalysis: stopped; {left}", file=sys.stderr)
        return _INTERRUPTED
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _parser(program: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=program,
        description="Run studies and report them, also night by night; compare results; verify the reference; study the model's error, "
        "the formula and the reduced method, readings in company, the model on machines, and insulators; show a scene, its readings over a motion, or where probes are noticed around it.",
        epilog="Exit status: 0 answered; 2 wrong input; 3 a case is short of the asked accuracy, its wider errors are "
        "reported; 1 a case failed or has no answer by any method, a value moved, or anything else.",
    )
    commands = parser.add_subparsers(dest="command", required=True)
    _add(commands, _BEFORE_TOPICS | _topics() | _AFTER_TOPICS)
    what = "make what is stored with the project anew, or measure what a note tells"
    measured = commands.add_parser("measure", help=what)
    _add(measured.add_subparsers(dest="what", metavar="WHAT", required=True), _MEASURES)
    return parser


def _add(commands: Any, table: dict[str, Command]) -> None:
    """Adds the commands of a table."""
    for name, (does, options) in table.items():
        command = commands.add_parser(name, help=does)
        # Commands that start no jobs have no option --jobs.
        command.set_defaults(jobs=None)
        for each in options:
            among = command.add_mutually_exclusive_group() if isinstance(each, list) else command
            for word, more in each if isinstance(each, list) else [each]:
                among.add_argument(word, **more)


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Stops on the first signal and ignores later ones, which would leave running processes behind."""
    for other in (signal.SIGINT, signal.SIGTERM):
        signal.signal(other, signal.SIG_IGN)
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
