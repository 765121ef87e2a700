"""The corrections of the model as a topic: their errors and run times, evaluated and measured together."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from analysis.pipeline import keys, model_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import run_all
from analysis.pipeline.set_up_stages import Whole
from analysis.pipeline.stage import NoAnswer, Stage, outdated
from analysis.results import machine
from analysis.results.store import Document, read_json
from analysis.results.study_results import Failure
from analysis.topics.corrections import cases, estimates, section
from analysis.topics.corrections.set_ups import FILE, set_ups
from analysis.topics.topic import Topic
from geometries.common.children import ending_with_this, temporary_folder
from geometries.common.installation import ROOT, no_benchmark

DOCUMENT = "corrections.json"
_BENCHMARK = Path("build", "bin", "correction_benchmark")
_SECONDS = 60.0
_SOURCES = ("model", "CMakeLists.txt", "CMakePresets.json")


@dataclass(frozen=True)
class Evaluated:
    """The one stage, by which all methods are evaluated."""

    name: str = "corrections"

    def run(self, folder: Path, _: Iterable[Whole], workers: int | None = None) -> list[Failure]:
        """Fills the folder, unless this code made its document on this machine; returns the failures."""
        return run_all(outdated([stage(folder)]), 1, shown=False)

    def load(self, folder: Path, _: Iterable[Whole]) -> dict[str, Document]:
        """Returns the document in a folder, also one of an earlier form of the code; none without single set-ups, or with other
        methods."""
        document = read_json(folder / DOCUMENT) or {}
        evaluated_ = [entry["name"] for entry in document.get("corrections", ())]
        return {Whole().id: document} if evaluated_ == list(estimates.METHODS) else {}


def stage(folder: Path) -> Stage:
    """Returns the stage of the one document."""
    python = [
        path.relative_to(ROOT).as_posix()
        for name in ("analysis/topics/corrections", "geometries")
        for path in sorted((ROOT / name).rglob("*.py"))
    ]
    truths = FILE.relative_to(ROOT).as_posix()
    code = keys.code_of((*_SOURCES, *python, truths), ROOT)
    key = keys.measurement_key(section.COMMAND, code, machine.identity())
    return Stage("corrections", "", folder / DOCUMENT, key, _SECONDS, _answer)


def _answer(_: Processes) -> Document:
    program = ROOT / _BENCHMARK
    if not program.is_file():
        raise NoAnswer(no_benchmark(_BENCHMARK))
    try:
        return {**evaluated(model_stage.model_module()), "nanoseconds": nanoseconds(program)}
    except (OSError, subprocess.SubprocessError) as error:
        raise NoAnswer(str(error)) from error


def evaluated(module: Any) -> Document:
    """Returns the errors of every method as a document; half a minute."""
    chosen = list(set_ups(module))
    found = estimates.estimate(module, chosen)
    return {
        "truths": FILE.relative_to(ROOT).as_posix(),
        "set_ups": len(found.names),
        "sealed": int(found.sealed.sum()),
        "corrections": [
            {name.rstrip("_"): value for name, value in asdict(entry).items()}
            for entry in estimates.evaluations(found)
        ],
        "cases": cases.documents(module, found, chosen),
    }


def nanoseconds(program: Path) -> dict[str, dict[str, float]]:
    """Measures the processor time per triangle of every method (second key) on every shape, all in one run in random
    order; the least of three."""
    with temporary_folder() as folder:
        answer = folder / "answer.json"
        subprocess.run(
            ending_with_this(
                [
                    program,
                    "--benchmark_repetitions=3",
                    "--benchmark_enable_random_interleaving=true",
                    f"--benchmark_out={answer}",
                    "--benchmark_out_format=json",
                ]
            ),
            check=True,
            capture_output=True,
        )
        entries = json.loads(answer.read_text(encoding="utf-8"))["benchmarks"]
    times: dict[str, dict[str, float]] = {}
    for entry in sorted(entries, key=lambda entry: int(entry["family_index"])):
        if entry["run_type"] == "iteration":
            shape, method = entry["name"].split("/")[:2]
            time = 1e9 * float(entry["per_triangle"])
            of_shape = times.setdefault(shape, {})
            of_shape[method] = min(time, of_shape.get(method, time))
    return times


CORRECTIONS = Topic[Whole, Document](
    stages=Evaluated(),
    set_ups=lambda: (Whole(),),
    entry=lambda _, answer: answer,
    sections=lambda found, _, set_ups: [section.section(found[0], set_ups)],
    finding=lambda found: section.finding(found[0]),
    absent=section.ABSENT,
    title="Corrections",
    question="What can be corrected, and at what cost?",
    short="corrections",
    set_ups_page=lambda found, *around: cases.set_ups_document(found[0]["cases"], *around),
)
