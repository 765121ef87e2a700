"""`python3 -m analysis`: the command line; `commands` does the work."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from types import FrameType

from analysis import measure
from geometries.common import installation
from geometries.common.arguments import positive_integer, positive_number
from geometries.common.interpreter import continue_with

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


def main(arguments: list[str] | None = None) -> int:
    """Runs the command line; returns the exit code."""
    options = _parser(installation.command("analysis")).parse_args(arguments)
    before = {number: signal.signal(number, _interrupt) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        continue_with("plotly" if options.command in ("coverage", "live", "show", "sweep") else "dolfinx")
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
    run = commands.add_parser("run", help="compute a study's missing answers, then report")
    run.add_argument("study", metavar="STUDY", help="a name in geometries/studies, or a file")
    run.add_argument(
        "--results",
        type=Path,
        metavar="DIR",
        help="where to keep the results (default: results/<study>, in the current folder for a study that is not the repository's)",
    )
    _add_jobs(run, "solves")
    run.add_argument(
        "--measure-model",
        action="store_true",
        help="also measure the model by itself: run time against error, stability, collisions (five minutes; kept with the results)",
    )
    _add_verify(run)
    _add_nightly(commands)
    report = commands.add_parser(
        "report", help="write table.csv, report.html and its pages from stored answers"
    )
    report.add_argument("results", type=Path, metavar="RESULTS", help="a folder that `run` has filled")
    for name, does in TOPICS.items():
        _add_topic(commands.add_parser(name, help=does), name)
    documentation = commands.add_parser(
        "documentation", help="make a site of all notes, algorithms and references (the model must be built)"
    )
    documentation.add_argument(
        "--output", type=Path, metavar="DIR", help="where to write the site (default: results/documentation)"
    )
    show = commands.add_parser(
        "show", help="write one page with a scene, its sensors' readings and its motion"
    )
    _add_scene(show)
    _add_motion(show, "the frames of its motion (default: SCENE.motion.toml beside it, if any)")
    _add_page(
        show,
        "the page (default: <scene>.html in the current folder; results/show/<scene>.html for scenes of the repository)",
    )
    show.add_argument(
        "--readings",
        action="store_true",
        help="plot the changes of the readings along the motion: model, formula and reduced method in every frame, boundary elements "
        "in those of the motion file",
    )
    show.add_argument(
        "--between",
        type=positive_integer,
        metavar="N",
        help="frames shown between two of the motion file, with --readings (default: 8)",
    )
    show.add_argument(
        "--rtol",
        type=_relative,
        metavar="R",
        help="relative error asked of boundary elements, with --readings (default: 1e-2)",
    )
    _add_live(commands)
    _add_sweep(commands)
    _add_coverage(commands)
    _add_honesty(commands)
    _add_golden(commands)
    measure.add_arguments(
        commands.add_parser(
            "measure", help="make what is stored with the project anew, or measure what a note tells"
        )
    )
    return parser


def _add_golden(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    golden = commands.add_parser(
        "golden",
        help="record answers, stated errors and times of boundary elements, the reduced method and the formula in set-ups with stored truths (six minutes), "
        "and compare them with an older record; status 1 if an answer left its error, or an error widened",
    )
    golden.add_argument(
        "file", type=Path, metavar="FILE", help="the record, as JSON; its folder must be there"
    )
    golden.add_argument("--against", type=Path, metavar="OLD", help="an older record of the same cases")
    golden.add_argument(
        "--only",
        default="",
        metavar="PATTERN",
        help="only cases whose names hold this, in which * stands for anything, as in machines/*reduced",
    )
    golden.add_argument(
        "--times", action="store_true", help="fail, not only warn, where a method takes 10 %% longer"
    )


def _add_honesty(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    honesty = commands.add_parser(
        "honesty",
        help="ask every method for random scenes of every kind, and print how often its stated errors hold (hours; finished scenes are kept); "
        "status 1 if they hold less often than they should",
    )
    honesty.add_argument(
        "--scenes", type=positive_integer, metavar="N", help="how many scenes (default: 416, 32 of each kind)"
    )
    honesty.add_argument("--first", type=_seed, metavar="SEED", help="the first scene's seed (default: 0)")
    honesty.add_argument("--kinds", metavar="A,B,…", help="kinds of scenes (default: all)")
    honesty.add_argument("--methods", metavar="A,B,…", help="methods that are asked (default: all)")
    field = honesty.add_mutually_exclusive_group()
    field.add_argument(
        "--field-solver",
        type=_share,
        metavar="SHARE",
        help="part of the scenes for which the field solver is asked, up to a minute each (default: 0.05)",
    )
    field.add_argument("--no-field-solver", action="store_true", help="do not ask the field solver")
    honesty.add_argument(
        "--seconds",
        type=positive_number,
        metavar="S",
        help="most processor time for an answer of the model (default: 10)",
    )
    honesty.add_argument(
        "--only", type=_seed, metavar="SEED", help="print this scene and all answers instead"
    )
    honesty.add_argument(
        "--results", type=Path, metavar="DIR", help="where to keep the answers (default: results/honesty)"
    )
    _add_jobs(honesty, "scenes")


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least 0")
    return int(text)


def _share(text: str) -> float:
    return 1.0 if text == "1" else _relative(text)


def _add_live(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    live = commands.add_parser(
        "live",
        help="write one page on which a scene can be moved: the library in it computes readings, distances and collisions in every frame",
    )
    _add_scene(live)
    _add_motion(live, "the frames of a path (default: SCENE.motion.toml beside it, if any)")
    reference = live.add_mutually_exclusive_group()
    reference.add_argument(
        "--rtol",
        type=_relative,
        default=1e-2,
        metavar="R",
        help="relative error asked of the reference readings along the paths, by boundary elements (default: 1e-2)",
    )
    reference.add_argument("--no-reference", action="store_true", help="solve no reference readings")
    _add_page(
        live,
        "the page (default: <scene>.html in the current folder; results/live/<scene>.html for scenes of the repository)",
    )


def _add_coverage(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    coverage = commands.add_parser(
        "coverage",
        help="survey from which distance a probe is noticed at every place around a machine: a page, a table and a file for ParaView",
    )
    _add_scene(coverage)
    coverage.add_argument(
        "--probe",
        action="append",
        default=[],
        metavar="PROBE",
        help="sphere:R, capsule:R:L, box:X:Y:Z (metres), mesh:FILE, finger, fist, hand or infant; may be repeated (default: sphere:0.02 and the four named ones)",
    )
    coverage.add_argument(
        "--reading",
        action="append",
        default=[],
        metavar="NAME",
        help="a reading; may be repeated (default: all)",
    )
    coverage.add_argument(
        "--grid",
        type=positive_number,
        metavar="M",
        help="side of the square of surface for each place, in metres (default: about 2,000 places)",
    )
    coverage.add_argument(
        "--potential",
        type=_potential,
        metavar="P",
        help="of the probe: grounded (default), floating, or a capacitance to ground in F",
    )
    coverage.add_argument(
        "--threshold",
        type=positive_number,
        metavar="F",
        help="least change that is noticed (default: that of each reading, or five times its noise, or 2.5e-15)",
    )
    coverage.add_argument(
        "--method",
        metavar="A,B,…",
        help="methods to compare with at a few places, those of fringe capacitance, formula and small-probe (default: exact,formula,small-probe); none: no comparison",
    )
    _add_page(
        coverage,
        "the page, with table and file beside it (default: results/coverage/<scene>.html)",
        "FILE.html",
    )


def _potential(text: str) -> float | None:
    """Returns the capacitance to ground (F): none for a grounded probe, 0 for a floating one."""
    return (
        {"grounded": None, "floating": 0.0}[text]
        if text in ("grounded", "floating")
        else positive_number(text)
    )


def _add_sweep(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    sweep = commands.add_parser(
        "sweep",
        help="write a table and a page of the readings in every frame of a motion, and where they cross their thresholds",
    )
    _add_scene(sweep)
    _add_motion(sweep, "the frames of its motion (default: SCENE.motion.toml beside it)")
    sweep.add_argument(
        "--method",
        metavar="A,B,…",
        help="methods of fringe sweep (default: exact,formula,auto,boundary-elements)",
    )
    sweep.add_argument(
        "--rtol",
        type=float,
        metavar="R",
        help="relative error asked of those methods that state one (default: 1e-2)",
    )
    _add_page(
        sweep,
        "the page, with the table beside it; frames that the table holds are not computed again (default: results/sweep/<scene>.html)",
        "FILE.html",
    )


def _add_nightly(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    nightly = commands.add_parser(
        "nightly", help="run a study by Snakemake, add it to the trends, and tell what has changed"
    )
    nightly.add_argument("study", metavar="STUDY", nargs="?", default="nightly", help="default: nightly")
    nightly.add_argument("--results", type=Path, metavar="DIR", help="default: results/<study>")
    nightly.add_argument("--jobs", type=positive_integer, metavar="N", help="jobs at a time on this machine")
    nightly.add_argument(
        "--profile",
        metavar="PROFILE",
        help="run on a cluster: slurm, or the folder of another profile of Snakemake",
    )
    nightly.add_argument(
        "--job-seconds",
        type=positive_integer,
        metavar="S",
        help="expected length of a job (default: 60 here, 600 on a cluster)",
    )
    _add_verify(nightly)
    job = commands.add_parser("job", help="solve the cases of one job's file; Snakemake calls this")
    job.add_argument("file", type=Path, metavar="FILE")
    difference = commands.add_parser(
        "diff", help="compare two results; status 1 if any value moved by more than its error"
    )
    difference.add_argument("old", type=Path, metavar="OLD", help="a folder of results, or a table.csv")
    difference.add_argument("new", type=Path, metavar="NEW", help="likewise")
    difference.add_argument("--output", type=Path, metavar="JSON", help="also write all of it to this file")
    trends = commands.add_parser(
        "trends",
        help="tell what has changed over the nights, make their page, or find the commit of a change",
    )
    trends.add_argument(
        "results",
        type=Path,
        metavar="RESULTS",
        nargs="?",
        help="a folder of results (default: results/nightly)",
    )
    back = trends.add_mutually_exclusive_group()
    back.add_argument(
        "--count",
        metavar="COMMITS",
        help="first add the instruction counts of these commits, as HEAD~10..HEAD, each built in a working tree of its own (minutes each)",
    )
    back.add_argument(
        "--bisect",
        metavar="VALUE",
        help="find the commit of the last change of this value, as `trends` names it, by building commits in a working tree of their own",
    )


def _add_topic(command: argparse.ArgumentParser, name: str) -> None:
    folder = _FOLDERS.get(name, name)
    command.add_argument(
        "--output", type=Path, metavar="DIR", help=f"where to keep the answers (default: results/{folder})"
    )
    command.set_defaults(jobs=None)
    if name not in _MEASURED_TOGETHER:
        _add_jobs(command, "answers")


def _add_scene(command: argparse.ArgumentParser) -> None:
    command.add_argument("scene", metavar="SCENE", help="a name in geometries/scenes, or a file")


def _add_motion(command: argparse.ArgumentParser, what: str) -> None:
    command.add_argument("--motion", type=Path, metavar="FILE", help=what)


def _add_page(command: argparse.ArgumentParser, what: str, metavar: str = "FILE") -> None:
    command.add_argument("--output", type=Path, metavar=metavar, help=what)


def _add_jobs(command: argparse.ArgumentParser, at_a_time: str) -> None:
    command.add_argument(
        "--jobs",
        type=positive_integer,
        metavar="N",
        help=f"{at_a_time} at a time (default: by cores and memory)",
    )


def _add_verify(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--verify",
        action="store_true",
        help="also verify the reference, as the command verify does, in the folder verification beside the results",
    )


def _relative(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number between 0 and 1")
    return value


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Stops on the first signal and ignores later ones, which would leave running processes behind."""
    for other in (signal.SIGINT, signal.SIGTERM):
        signal.signal(other, signal.SIG_IGN)
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
