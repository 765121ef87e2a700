"""The commands of `python3 -m analysis`: each calls one stage or one page, tells what failed and returns the exit status."""

import argparse
import sys
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from analysis import live, show
from analysis.documentation import make as documentation, measurements
from analysis.nightly import night
from analysis.pipeline import reference_stage
from analysis.report import index_page
from analysis.results import statistics, store
from analysis.results.refusals import named
from analysis.results.store import InUse, exclusive
from analysis.results.study_results import Failure
from analysis.study import report, workflow
from analysis.sweep import make as sweep
from analysis.topics.all import TOPICS
from analysis.topics.corrections import set_ups as corrections
from analysis.topics.insulators import set_ups as insulators
from analysis.topics.published.topic import PUBLISHED
from analysis.topics.topic import Topic
from analysis.topics.trends import changes, commits, page as trends_page
from analysis.topics.verification.topic import VERIFICATION
from geometries.common import installation
from geometries.common.errors import InputError
from geometries.studies import study

_TRUTHS = {topic.name: topic.truths for topic in TOPICS if topic.truths}
_CHECKS = {topic.name: topic.check for topic in TOPICS if topic.check}


def _solve_truths(options: argparse.Namespace) -> None:
    print(f"{options.topic}: {_TRUTHS[options.topic].complete().solved} set-ups solved")


def _solve_checks(options: argparse.Namespace) -> int:
    """Solves what has no record; status 1 where some remain without."""
    own = insulators.STAGES.name
    if options.boundary and options.topic != own:
        reason = f"--boundary is an option of {own}: the records of {options.topic} have no boundary elements"
        raise InputError("", "", reason)
    if options.boundary:
        print(f"{own}: {insulators.solve_again()} set-ups solved by boundary elements")
        return 0
    solved, left = _CHECKS[options.topic].complete(seconds=options.seconds)
    print(f"{options.topic}: {solved} set-ups solved, {left} remain without a record")
    return 1 if left else 0


MEASURES: dict[str, Callable[[argparse.Namespace], int | None]] = {
    "truths": _solve_truths,
    "field-check": _solve_checks,
    "corrections": corrections.measure,
    "benchmarks": measurements.measure,
}

# Exit statuses, the same for all commands of the project.
ANSWERED, FAILED, WRONG_INPUT, NOT_REACHED = 0, 1, 2, 3

_WRITTEN = dict.fromkeys(("diff", "show", "live", "sweep", "coverage"), "output") | {"golden": "file"}
"""The options that name the one file which a command is to write."""


def run_command(options: argparse.Namespace) -> int:
    """Runs one command; returns the exit status, after one line on what went wrong if it did."""
    try:
        if (output := getattr(options, _WRITTEN.get(options.command, ""), None)) is not None:
            store.refuse_unwritable(output)
        status = _COMMANDS[options.command](options) or ANSWERED
        # Jobs are parts of a command that is still at work.
        if options.command != "job":
            index_page.make(installation.results_folder())
        return status
    except InputError as error:
        print(f"analysis: {error}", file=sys.stderr)
        return WRONG_INPUT
    except (InUse, live.NoLibrary, commits.CountingFailed, documentation.DocumentationError) as error:
        print(f"analysis: {error}", file=sys.stderr)
        return FAILED
    except ModuleNotFoundError as error:
        if error.name != "fringe":
            raise
        print("analysis: the model's Python module is missing: ./run builds it", file=sys.stderr)
        return FAILED
    # The machine refused something: a full or read-only file system, a folder that is gone, memory, processes.
    except (OSError, MemoryError) as error:
        place = f"{error.filename}: " if isinstance(error, OSError) and error.filename else ""
        reason = (error.strerror if isinstance(error, OSError) else "") or str(error) or "out of memory"
        kept = "finished cases are kept, the same command goes on from there"
        print(f"\nanalysis: {place}{reason}; {kept}", file=sys.stderr)
        return FAILED


def _run(options: argparse.Namespace) -> int:
    chosen, target = _study(options.study, options.results)
    with exclusive(target):
        night.end_left_over(target)

        def tell() -> None:
            """Reports the answers before the pictures are solved for, which can take as long again."""
            now = f"The report is there and can be read now: {report.make(target).path}"
            print(f"{now}; pictures of the potential are still to come", flush=True)

        failures = workflow.run(chosen, target, options.jobs, options.measure_model, tell)
        return _status(failures, _own_report(options, target, failures))


def _nightly(options: argparse.Namespace) -> int:
    if options.profile:
        night.find_profile(options.profile)
    chosen, target = _study(options.study, options.results)
    with exclusive(target):
        asked = night.Options(options.profile, options.jobs, options.job_seconds)
        failures = night.run(chosen, target, asked)
        made = _own_report(options, target, failures)
        new = changes.add(target, [*changes.of_night(target), *commits.of_build()])
        tonight = new[0].time if new else None
        marks = _trends(target, lambda mark: mark.after.time == tonight)
        # The report links to the trends, which now include this night.
        disagreements = report.make(target).disagreements
    return FAILED if any(mark.is_alarm for mark in marks) or disagreements else _status(failures, made)


def _trends(folder: Path, told: Callable[[changes.Mark], bool]) -> list[changes.Mark]:
    """Makes the page of the trends, prints those changes that are to be told, and returns them."""
    found = [mark for mark in changes.marks(changes.load(folder)) if told(mark)]
    print(changes.to_text(found), end="")
    print(f"trends: {trends_page.make(folder)}")
    return found


def _look_back(options: argparse.Namespace) -> None:
    target = options.results or installation.results_folder() / "nightly"
    if options.bisect is not None:
        print(commits.find(target, options.bisect), end="")
        return
    if options.count is not None:
        for commit, new in commits.count_each(target, options.count):
            print(f"{commit}: {len(new)} counts are new", flush=True)
    _trends(target, lambda _: True)


def _diff(old: Path, new: Path, output: Path | None) -> int:
    before, after = changes.of_table(old), changes.of_table(new)
    found = changes.marks([*before, *after])
    earlier, later = ({each.series for each in some} for some in (before, after))
    if output is not None:
        store.write_json(output, {"moved": [asdict(mark) for mark in found]})
    print(f"{len(earlier & later)} values in both, {len(later - earlier)} new, {len(earlier - later)} gone")
    print(changes.to_text(found), end="")
    return FAILED if found else ANSWERED


def _study(name: str, folder: Path | None) -> tuple[study.Study, Path]:
    file = study.find(name)
    chosen = study.load(file)
    return chosen, folder or installation.results_folder(file) / chosen.name


def _tell(failures: list[Failure]) -> None:
    """Prints a line for each stage and reason; the report tells what was refused."""
    failed = (failure for failure in failures if not failure.refused)
    for (stage, reason), alike in statistics.grouped(failed, lambda each: (each.stage, each.reason)).items():
        cases = tuple(failure.case for failure in alike)
        place = f"{len(cases)} cases ({named(cases)}): " if cases[1:] else cases[0] and f"case {cases[0]}: "
        print(f"analysis: {place}{stage}: {reason}", file=sys.stderr)


def _status(failures: list[Failure], made: report.Report) -> int:
    """Returns the exit status. What a method refuses and another answers is no failure; nor is a missing slice, which the comparison
    does not need."""
    failed = any(failure.stage != reference_stage.SLICE and not failure.refused for failure in failures)
    return FAILED if failed or made.unanswered else _reached(made)


def _reached(made: report.Report) -> int:
    return NOT_REACHED if made.not_reached else ANSWERED


def _own_report(options: argparse.Namespace, folder: Path, failures: list[Failure]) -> report.Report:
    """Verifies the reference if the option asks for it, in the folder beside this run's results, tells and adds what failed, and reports the
    results. If they cannot be read, somebody has removed or changed them meanwhile: OSError."""
    if options.verify:
        beside = VERIFICATION.beside(folder)
        failures += VERIFICATION.stages.run(beside, VERIFICATION.set_ups(), options.jobs)
    _tell(failures)
    try:
        return _report(folder)
    except InputError as error:
        raise OSError(f"the results were removed or changed while the run was on: {error}") from error


def _report(folder: Path) -> report.Report:
    """Makes the report; prints the model's errors, and on standard error a line for each reason to refuse cases."""
    made = report.make(folder)
    for refusal in made.refusals:
        print(f"analysis: {refusal.sentence}", file=sys.stderr)
    if made.summaries:
        print(statistics.headline(made.summaries))
    short = "cases are short of the asked accuracy; their wider errors are in the report"
    apart = "values of boundary elements and the field solver disagree by more than their errors"
    for count, what in ((made.not_reached, short), (made.disagreements, apart)):
        if count:
            print(f"{count} {what}")
    print(f"report: {made.path}")
    return made


def _topic(topic: Topic[Any, Any], options: argparse.Namespace) -> int:
    """Brings the answers of a topic's set-ups up to date and makes the topic's page."""
    target = options.output or installation.results_folder() / topic.name
    with exclusive(target):
        failures = topic.stages.run(target, topic.set_ups(), options.jobs)
        _tell(failures)
        made = topic.make(target)
    print(made.headline)
    print(f"report: {made.path}")
    return FAILED if failures else ANSWERED


def _documentation(options: argparse.Namespace) -> None:
    target = options.output or installation.results_folder() / "documentation"
    print(f"documentation: {documentation.build(target)}")


def _show(options: argparse.Namespace) -> None:
    given = {name: getattr(options, name) for name in ("between", "rtol")}
    given = {name: value for name, value in given.items() if value is not None}
    if given and not options.readings:
        raise InputError("", "", f"--{next(iter(given))} is an option of --readings, which is missing")
    readings = show.Readings(**given) if options.readings else None
    print(f"page: {show.make(options.scene, options.motion, options.output, readings)}")


def _live(options: argparse.Namespace) -> None:
    rtol = None if options.no_reference else options.rtol
    print(f"page: {live.make(options.scene, options.motion, options.output, rtol)}")


def _sweep(options: argparse.Namespace) -> int:
    methods = options.method or sweep.METHODS
    made, status = sweep.make(options.scene, options.motion, options.output, methods, options.rtol)
    if made is not None:
        print("\n".join(filter(None, [made.headline, f"page: {made.path}"])))
    return status


def _coverage(options: argparse.Namespace) -> None:
    # It loads scipy and meshio, which no other command of this module needs.
    from analysis.coverage import make as coverage, survey

    methods = survey.Options().methods if options.method is None else tuple(options.method.split(","))
    compared = () if methods == ("none",) else methods
    of_probe = options.grid, options.potential, options.threshold
    asked = survey.Options(tuple(options.reading), *of_probe, compared)
    made = coverage.make(options.scene, tuple(options.probe), asked, options.output)
    print(f"{made.headline}\npage: {made.path}")


def _honesty(options: argparse.Namespace) -> int:
    # It loads scipy, which few commands of this module need.
    from analysis.honesty import judging, run as honesty

    share = 0.0 if options.no_field_solver else options.field_solver
    given = {name: getattr(options, name) for name in ("scenes", "first", "seconds", "jobs")}
    more = {name: each for name, each in (given | {"field_share": share}).items() if each is not None}
    asked = honesty.options(options.kinds, options.methods, **more)
    target = options.results or installation.results_folder() / honesty.FOLDER
    if options.only is not None:
        for line in honesty.show(options.only, target, asked):
            print(line, flush=True)
        return ANSWERED
    with exclusive(target):
        league = honesty.run(target, asked)
    print(league.text, end="")
    print(f"table: {league.path}")
    return FAILED if judging.misses(league.rows) else ANSWERED


def _golden(options: argparse.Namespace) -> int:
    # It loads scipy, which few commands of this module need.
    from analysis import golden

    if options.times and options.against is None:
        raise InputError("", "", "--times is an option of --against, which is missing")
    comparison = golden.run(options.file, options.against, options.only, options.times)
    if comparison is not None:
        print(comparison.text, end="")
    print(f"golden file: {options.file}")
    return FAILED if comparison is not None and comparison.faults else ANSWERED


_COMMANDS: dict[str, Callable[[argparse.Namespace], int | None]] = {
    "run": _run,
    "report": lambda options: _reached(_report(options.results)),
    "nightly": _nightly,
    "job": lambda options: night.solve(options.file),
    "diff": lambda options: _diff(options.old, options.new, options.output),
    "trends": _look_back,
    # The published table is kept as it is.
    **{topic.verb: partial(_topic, topic) for topic in TOPICS if topic is not PUBLISHED},
    "documentation": _documentation,
    "show": _show,
    "live": _live,
    "sweep": _sweep,
    "coverage": _coverage,
    "honesty": _honesty,
    "golden": _golden,
    "measure": lambda options: MEASURES[options.what](options),
}
