"""`python3 -m analysis`: run a study, report on its results, verify the reference, show a scene."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from types import FrameType

from geometries.interpreter import continue_with

# As everywhere in the project.
ANSWERED, FAILED, WRONG_INPUT, NOT_REACHED = 0, 1, 2, 3
# What shells report for a command that was interrupted.
_INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    options = _parser().parse_args(arguments)
    continue_with("plotly" if options.command == "show" else "dolfinx")
    from geometries.errors import InputError

    signal.signal(signal.SIGTERM, _interrupt)
    try:
        if options.command == "run":
            return _run(options.study, options.results, options.jobs, options.measure_model, options.verify)
        if options.command == "verify":
            return _verify(options.output, options.jobs)
        if options.command == "show":
            return _show(options.scene, options.motion, options.output)
        return _report(options.results)
    except InputError as error:
        print(f"analysis: {error}", file=sys.stderr)
        return WRONG_INPUT
    except ModuleNotFoundError as error:
        if error.name != "fringe":
            raise
        print("analysis: the model is not built: ./run builds it", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print(
            "\nanalysis: stopped; finished cases are kept, the same command goes on from there",
            file=sys.stderr,
        )
        return _INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python3 -m analysis",
        description=__doc__,
        epilog="Exit status: 0 answered; 2 wrong input; 3 a case is short of the asked accuracy, its wider errors are "
        "reported; 1 a case failed, or anything else.",
    )
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="solve what is not solved yet, then report")
    run.add_argument("study", metavar="STUDY", help="a name in geometries/studies, or a file")
    run.add_argument(
        "--results", type=Path, metavar="DIR", help="where to keep the results (default: results/<study>)"
    )
    run.add_argument(
        "--jobs", type=_count, metavar="N", help="solves at a time (default: by cores and memory)"
    )
    run.add_argument(
        "--measure-model",
        action="store_true",
        help="measure the model by itself, too: run time against error, stability, collisions (three minutes, kept with the results)",
    )
    run.add_argument(
        "--verify",
        action="store_true",
        help="verify the reference, too, as the command verify does, in the folder verification beside the results",
    )
    report = commands.add_parser("report", help="write table.csv and report.html from stored answers")
    report.add_argument("results", type=Path, metavar="RESULTS", help="a folder that `run` has filled")
    verify = commands.add_parser(
        "verify",
        help="hold the reference against known capacitances, and its run time against error (minutes; finished rows are kept)",
    )
    verify.add_argument(
        "--output", type=Path, metavar="DIR", help="where to keep the rows (default: results/verification)"
    )
    verify.add_argument(
        "--jobs", type=_count, metavar="N", help="rows at a time (default: by cores and memory)"
    )
    show = commands.add_parser(
        "show", help="write one page with a scene, its sensors' readings and its motion"
    )
    show.add_argument("scene", metavar="SCENE", help="a name in geometries/scenes, or a file")
    show.add_argument(
        "--motion",
        type=Path,
        metavar="FILE",
        help="its frames (default: SCENE.motion.toml beside it, if any)",
    )
    show.add_argument(
        "--output", type=Path, metavar="FILE", help="the page (default: results/show/<scene>.html)"
    )
    return parser


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number greater than 0")
    return int(text)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _run(name: str, folder: Path | None, jobs: int | None, measure_model: bool, verify: bool) -> int:
    from analysis import reference_stage, verification_page, verification_stage, workflow
    from analysis.keys import REPOSITORY
    from geometries import study

    chosen = study.load(study.find(name))
    target = folder or REPOSITORY / "results" / chosen.name
    failures = workflow.run(chosen, target, jobs, measure_model)
    if verify:
        failures += verification_stage.run(
            verification_page.beside(target), verification_stage.row_names(), jobs
        )
    for failure in failures:
        place = f"case {failure.case}: " if failure.case else ""
        print(f"analysis: {place}{failure.stage}: {failure.reason}", file=sys.stderr)
    code = _report(target)
    # A missing picture is told, but takes nothing from the comparison.
    return FAILED if any(failure.stage != reference_stage.SLICE for failure in failures) else code


def _report(folder: Path) -> int:
    from analysis import report, statistics

    made = report.make(folder)
    if made.summaries:
        print(statistics.headline(made.summaries))
    if made.not_reached:
        print(
            f"{made.not_reached} cases are short of the asked accuracy; their wider errors are in the report"
        )
    print(f"report: {made.path}")
    return NOT_REACHED if made.not_reached else ANSWERED


def _verify(folder: Path | None, jobs: int | None) -> int:
    from analysis import verification_page, verification_stage
    from analysis.keys import REPOSITORY

    target = folder or REPOSITORY / "results" / verification_stage.FOLDER
    failures = verification_stage.run(target, verification_stage.row_names(), jobs)
    for failure in failures:
        print(f"analysis: {failure.stage}: {failure.reason}", file=sys.stderr)
    made = verification_page.make(target)
    print(made.headline)
    print(f"report: {made.path}")
    return FAILED if failures else ANSWERED


def _show(scene: str, motion: Path | None, target: Path | None) -> int:
    from analysis import show

    print(f"page: {show.make(scene, motion, target)}")
    return ANSWERED


if __name__ == "__main__":
    sys.exit(main())
