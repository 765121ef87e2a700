"""`python3 -m analysis`: run a study, also night by night, compare two of them, verify the reference, take the
model's error apart, show a scene."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from geometries import installation
from geometries.interpreter import continue_with

if TYPE_CHECKING:
    from analysis.jobs import Failure
    from geometries.study import Study

# As everywhere in the project.
ANSWERED, FAILED, WRONG_INPUT, NOT_REACHED = 0, 1, 2, 3
# What shells report for a command that was interrupted.
_INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    options = _parser(installation.command("analysis")).parse_args(arguments)
    before = {number: signal.signal(number, _interrupt) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        return _run_command(options)
    except KeyboardInterrupt:
        print(
            "\nanalysis: stopped; finished cases are kept, the same command goes on from there",
            file=sys.stderr,
        )
        return _INTERRUPTED
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _run_command(options: argparse.Namespace) -> int:
    continue_with("plotly" if options.command == "show" else "dolfinx")
    from geometries.errors import InputError

    from analysis.store import InUse

    try:
        if options.command == "run":
            return _run(options)
        if options.command == "verify":
            return _verify(options.output, options.jobs)
        if options.command == "documentation":
            return _documentation(options.output)
        if options.command == "corrections":
            return _corrections(options.output)
        if options.command == "table":
            return _table(options.answers, options.output, options.jobs)
        if options.command == "nightly":
            return _nightly(options)
        if options.command == "job":
            return _job(options.file)
        if options.command == "diff":
            return _diff(options.old, options.new, options.output)
        if options.command == "errors":
            return _errors(options.output, options.jobs)
        if options.command == "show":
            return _show(options.scene, options.motion, options.output)
        return _report(options.results)
    except InputError as error:
        print(f"analysis: {error}", file=sys.stderr)
        return WRONG_INPUT
    except InUse as error:
        print(f"analysis: {error}", file=sys.stderr)
        return FAILED
    except ModuleNotFoundError as error:
        if error.name != "fringe":
            raise
        print("analysis: the model's Python module is missing: ./run builds it", file=sys.stderr)
        return FAILED
    # What the machine refuses: a full or read-only file system, a folder that is gone, memory, processes.
    except (OSError, MemoryError) as error:
        place = f"{error.filename}: " if isinstance(error, OSError) and error.filename else ""
        told = (error.strerror if isinstance(error, OSError) else "") or str(error) or "out of memory"
        print(
            f"\nanalysis: {place}{told}; finished cases are kept, the same command goes on from there",
            file=sys.stderr,
        )
        return FAILED


def _parser(program: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=program,
        description="Run a study, also night by night, compare two of them, verify the reference, take the model's error apart, "
        "show a scene.",
        epilog="Exit status: 0 answered; 2 wrong input; 3 a case is short of the asked accuracy, its wider errors are "
        "reported; 1 a case failed, a value moved, or anything else.",
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
        help="measure the model by itself, too: run time against error, stability, collisions (five minutes, kept with the results)",
    )
    _add_verify(run)
    _add_nightly(commands)
    report = commands.add_parser(
        "report", help="write table.csv, report.html and its pages from stored answers"
    )
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
    errors = commands.add_parser(
        "errors",
        help="take the model's error apart in hundreds of set-ups, by boundary elements (a minute or two; finished ones are kept)",
    )
    errors.add_argument(
        "--output", type=Path, metavar="DIR", help="where to keep the answers (default: results/errors)"
    )
    errors.add_argument(
        "--jobs", type=_count, metavar="N", help="set-ups at a time (default: by cores and memory)"
    )
    documentation = commands.add_parser(
        "documentation", help="make a site of all notes, algorithms and references (needs the model built)"
    )
    documentation.add_argument(
        "--output", type=Path, metavar="DIR", help="where to put it (default: results/documentation)"
    )
    corrections = commands.add_parser(
        "corrections", help="evaluate the model's corrections against boundary elements, with their run times"
    )
    corrections.add_argument(
        "--output", type=Path, metavar="DIR", help="where to keep the answer (default: results/corrections)"
    )
    table = commands.add_parser(
        "table",
        help="make the published table of capacitances anew (an hour of one core; what is solved already is kept)",
    )
    table.add_argument(
        "--answers", type=Path, metavar="DIR", help="where to keep the answers (default: results/published)"
    )
    table.add_argument(
        "--output", type=Path, metavar="DIR", help="where to write the table (default: analysis/published)"
    )
    table.add_argument(
        "--jobs", type=_count, metavar="N", help="solves at a time (default: by cores and memory)"
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


def _add_nightly(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    nightly = commands.add_parser(
        "nightly", help="run a study by Snakemake, compare with the night before, report the nights"
    )
    nightly.add_argument("study", metavar="STUDY", nargs="?", default="nightly", help="default: nightly")
    nightly.add_argument("--results", type=Path, metavar="DIR", help="default: results/<study>")
    nightly.add_argument("--jobs", type=_count, metavar="N", help="jobs at a time on this machine")
    nightly.add_argument(
        "--profile",
        metavar="PROFILE",
        help="run on a cluster: slurm, or the folder of another profile of Snakemake",
    )
    nightly.add_argument(
        "--job-seconds",
        type=_count,
        metavar="S",
        help="expected length of a job (default: 60 here, 600 on a cluster)",
    )
    _add_verify(nightly)
    job = commands.add_parser("job", help="solve the cases of one job's file; Snakemake calls this")
    job.add_argument("file", type=Path, metavar="FILE")
    difference = commands.add_parser(
        "diff", help="what has moved between two results; status 1 if anything has"
    )
    difference.add_argument("old", type=Path, metavar="OLD", help="a folder of results, or a table.csv")
    difference.add_argument("new", type=Path, metavar="NEW", help="likewise")
    difference.add_argument("--output", type=Path, metavar="JSON", help="also write all of it to this file")


def _add_verify(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--verify",
        action="store_true",
        help="verify the reference, too, as the command verify does, in the folder verification beside the results",
    )


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number greater than 0")
    return int(text)


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Stop, once: a second signal while the running processes are ended would only leave them behind."""
    for other in (signal.SIGINT, signal.SIGTERM):
        signal.signal(other, signal.SIG_IGN)
    raise KeyboardInterrupt


def _run(options: argparse.Namespace) -> int:
    from analysis import workflow
    from analysis.nightly import cluster
    from analysis.store import exclusive

    chosen, target = _study(options.study, options.results)
    with exclusive(target):
        cluster.end_left_over(target)
        failures = workflow.run(chosen, target, options.jobs, options.measure_model)
        failures += _verified(options, target)
        _tell(failures)
        code = _own_report(target)
    return FAILED if _any_failed(failures) else code


def _nightly(options: argparse.Namespace) -> int:
    from analysis import report
    from analysis.nightly import history, history_page, night
    from analysis.nightly.difference import to_text
    from analysis.store import exclusive

    if options.profile:
        night.find_profile(options.profile)
    chosen, target = _study(options.study, options.results)
    with exclusive(target):
        done = night.run(chosen, target, night.Options(options.profile, options.jobs, options.job_seconds))
        failures = done.failures + _verified(options, target)
        _tell(failures)
        code = _own_report(target)
        moved = history.add(target, done)
        print(f"nights: {history_page.make(target)}")
        # It leads to the nights, of which this one is the last.
        disagreements = report.make(target).disagreements
    if moved is not None:
        print(to_text(moved), end="")
    drifted = moved is not None and moved.drifted
    return FAILED if _any_failed(failures) or drifted or disagreements else code


def _job(file: Path) -> int:
    from analysis.nightly import chunks

    chunks.solve(file)
    return ANSWERED


def _diff(old: Path, new: Path, output: Path | None) -> int:
    from analysis import store
    from analysis.nightly import difference

    found = difference.between(difference.read(old), difference.read(new))
    if output is not None:
        store.write_json(output, difference.to_document(found))
    print(difference.to_text(found), end="")
    return FAILED if found.drifted else ANSWERED


def _study(name: str, folder: Path | None) -> tuple[Study, Path]:
    from geometries import study

    chosen = study.load(study.find(name))
    return chosen, folder or installation.results_folder() / chosen.name


def _verified(options: argparse.Namespace, target: Path) -> list[Failure]:
    """What failed while the reference was verified, if it was to be, in the folder beside a study's results."""
    from analysis.verification import page as verification_page, stage as verification_stage

    if not options.verify:
        return []
    return verification_stage.run(
        verification_page.beside(target), verification_stage.row_names(), options.jobs
    )


def _tell(failures: list[Failure]) -> None:
    for failure in failures:
        place = f"case {failure.case}: " if failure.case else ""
        print(f"analysis: {place}{failure.stage}: {failure.reason}", file=sys.stderr)


def _any_failed(failures: list[Failure]) -> bool:
    """A missing picture is told, but takes nothing from the comparison."""
    from analysis import reference_stage

    return any(failure.stage != reference_stage.SLICE for failure in failures)


def _own_report(folder: Path) -> int:
    """Of results that this very run has made: if they cannot be read, somebody has removed or changed them meanwhile."""
    from geometries.errors import InputError

    try:
        return _report(folder)
    except InputError as error:
        raise OSError(f"the results were removed or changed while the run was on: {error}") from error


def _report(folder: Path) -> int:
    from analysis import report, statistics

    made = report.make(folder)
    if made.summaries:
        print(statistics.headline(made.summaries))
    if made.not_reached:
        print(
            f"{made.not_reached} cases are short of the asked accuracy; their wider errors are in the report"
        )
    if made.disagreements:
        print(
            f"{made.disagreements} values of boundary elements and the field solver disagree by more than their errors"
        )
    print(f"report: {made.path}")
    return NOT_REACHED if made.not_reached else ANSWERED


def _verify(folder: Path | None, jobs: int | None) -> int:
    from analysis.verification import page as verification_page, stage as verification_stage

    target = folder or installation.results_folder() / verification_stage.FOLDER
    failures = verification_stage.run(target, verification_stage.row_names(), jobs)
    _tell(failures)
    made = verification_page.make(target)
    print(made.headline)
    print(f"report: {made.path}")
    return FAILED if failures else ANSWERED


def _errors(folder: Path | None, jobs: int | None) -> int:
    from analysis.errors import page as errors_page, set_ups, stage
    from analysis.store import exclusive

    target = folder or installation.results_folder() / stage.FOLDER
    with exclusive(target):
        failures = stage.run(target, set_ups.all_set_ups(), jobs)
        _tell(failures)
        made = errors_page.make(target)
    print(made.headline)
    print(f"report: {made.path}")
    return FAILED if failures else ANSWERED


def _corrections(folder: Path | None) -> int:
    from analysis.corrections import page as corrections_page, section, stage
    from analysis.model_stage import model_module
    from analysis.store import exclusive

    target = folder or installation.results_folder() / stage.FOLDER
    with exclusive(target):
        failures = stage.run(target, model_module())
        _tell(failures)
        made = corrections_page.make(target)
    document = stage.load(target)
    print(section.finding(document) if document else section.ABSENT)
    print(f"report: {made}")
    return FAILED if failures else ANSWERED


def _documentation(folder: Path | None) -> int:
    from analysis.documentation import make

    try:
        page = make.build(folder or installation.results_folder() / "documentation")
    except make.DocumentationError as error:
        print(f"analysis: {error}", file=sys.stderr)
        return FAILED
    print(f"documentation: {page}")
    return ANSWERED


def _show(scene: str, motion: Path | None, target: Path | None) -> int:
    from analysis import show

    print(f"page: {show.make(scene, motion, target)}")
    return ANSWERED


def _table(answers: Path | None, target: Path | None, jobs: int | None) -> int:
    from analysis.published import files, stage, table
    from analysis.store import exclusive

    place, output = answers or installation.results_folder() / stage.FOLDER, target or table.PLACE
    with exclusive(place):
        made = table.make(place, output, jobs)
    _tell(made.failures)
    if made.failures:
        return FAILED
    print(made.headline)
    print(f"table: {output / files.TABLE}")
    return ANSWERED


if __name__ == "__main__":
    sys.exit(main())
