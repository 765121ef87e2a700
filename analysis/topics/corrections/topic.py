"""The corrections of the model as a topic: their errors and run times, evaluated and measured together, and every set-up as plain data."""

import json
import subprocess
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from analysis.pipeline import keys, model_stage
from analysis.pipeline.measurement_stage import timed
from analysis.pipeline.scheduler import run_all
from analysis.pipeline.set_up_stages import Whole
from analysis.pipeline.stage import NoAnswer, Processes, Stage, outdated
from analysis.report import page, set_ups_page
from analysis.report.plot import Panel, axis, by_family, figure, log_axis
from analysis.report.run_times_section import by_set, seconds
from analysis.report.set_ups_page import Around, Shown
from analysis.results import machine
from analysis.results.store import Document, read_json
from analysis.results.study_results import Failure
from analysis.results.units import CENTIMETRE, percent, signed_percent, too
from analysis.topics.corrections import set_ups
from analysis.topics.corrections.set_ups import FORMULA, PLAIN, REDUCED, RTOL, STORED, off
from analysis.topics.topic import Topic
from geometries.common.children import ending_with_this, temporary_folder
from geometries.common.installation import ROOT, no_benchmark
from geometries.common.measured import PICOFARAD, measured
from geometries.scene import reader
from geometries.scene.scene import Scene
from geometries.scene.shapes import Cuboid, PlateShape

SHOWN = (FORMULA, REDUCED)
"""The methods whose errors are plotted set-up by set-up."""
_PERCENT = 100.0
_WITHIN = 0.05


def set_by_set(cases: list[Document], set_ups: str) -> Markup:
    """Returns the finding and the plot; `set_ups` is the file of the page that the points open, as seen from the page."""
    figures = page.figures([_panel(cases, name) for name in SHOWN], set_ups=set_ups)
    says = page.soft(
        "A click on a point opens its set-up. The distance is the shortest between the two bodies, the sensor's size the root of its area."
    )
    heading = page.heading("Set-up by set-up")
    return page.lines([heading, page.finding(finding_of_set_ups(cases)), figures, says])


def finding_of_set_ups(cases: list[Document]) -> str:
    """Tells for how many set-ups the best closed formula is nearly right, and where it and the reduced method are worst."""
    best, reduced = SHOWN
    near = sum(abs(off(case, best)) <= _WITHIN for case in cases)

    def worst(name: str) -> str:
        case = max(cases, key=lambda case: abs(off(case, name)))
        place = f"{_relative_distance(case):.2g} sensor sizes"
        return f"{case['name']}, {_PERCENT * off(case, name):+.2g} % at {place}"

    return (
        f"The {best} is within {percent(_WITHIN)} in {near} of {len(cases)} set-ups and worst in {worst(best)}; "
        f"{reduced} is worst in {worst(reduced)}."
    )


def _panel(cases: list[Document], name: str) -> Panel:
    points = by_family(
        cases,
        lambda case: str(case["family"]),
        "%{customdata}: %{y:+.2g} %<extra></extra>",
        size=6,
        x=_relative_distance,
        y=lambda case: _PERCENT * off(case, name),
        customdata=lambda case: case["name"],
    )
    x, y = log_axis("distance over sensor size"), axis("error in mutual, %")
    return Panel(name, figure(points, x, y))


def set_ups_document(cases: list[Document], back: str, back_title: str, inputs: str, script: str) -> str:
    """Returns the page of all set-ups; `back` is the file of the page that leads to it."""
    options = (FORMULA, f"{REDUCED} --entries", f"boundary-elements --rtol {RTOL:g} --entries")
    around = Around(
        "Set-ups of the corrections",
        back,
        back_title,
        ("method", "mutual (pF)", "off by"),
        "mutual = −M[sensor, target]. The truth's error is what boundary elements state.",
        tuple(f"--method {each}" for each in options),
    )
    return set_ups_page.document(around, [_shown(case) for case in cases], inputs, script)


def _shown(case: Document) -> Shown:
    scene = reader.loads(case["scene"], case["name"])
    kept = "sealed: no constant was fitted on it" if case["sealed"] else "open to the fit of constants"
    truth, error = case["truth"] / PICOFARAD, case["error"] / PICOFARAD
    wrong = ", ".join(f"{name} is {too(off(case, name))}" for name in SHOWN)
    finding_ = f"mutual: {measured(truth, error)} pF by boundary elements; {wrong}, the plain model {too(off(case, PLAIN))}."
    rows = [("boundary elements", measured(truth, error), "")]
    for name, value in case["estimates"].items():
        rows.append((name, f"{value / PICOFARAD:.6g}", signed_percent(value / case["truth"] - 1)))
    description = f"{_sizes(scene)}; {case['distance'] / CENTIMETRE:.3g} cm between them; {kept}."
    return Shown(case["name"], case["family"], description, (finding_,), tuple(rows), scene, case["scene"])


def _sizes(scene: Scene) -> str:
    """Returns both bodies' sides in words."""
    (plate,) = scene.sensors[0].plates
    shape = scene.objects[0].shape
    assert isinstance(shape, (PlateShape, Cuboid))
    sides = [float(np.linalg.norm(edge)) for edge in (plate.edge_u, plate.edge_v)]
    kind = "plate" if isinstance(shape, PlateShape) else "box"
    both = sides, shape.size
    own, other = (" × ".join(f"{length / CENTIMETRE:.3g}" for length in lengths) for lengths in both)
    return f"Sensor {own} cm, {kind} {other} cm"


def _relative_distance(case: Document) -> float:
    """Returns the distance relative to the root of the sensor's area."""
    return float(case["distance"] / case["sensor_size"])


TITLE = "Corrections of the model (mutual)"
COMMAND = "python3 -m analysis corrections"
ABSENT = f"The corrections were not evaluated yet: {COMMAND} does it in a minute."


def section(document: Document, set_ups: str) -> Markup:
    """Returns the section of the topic's document. `set_ups` is the file of the page of its set-ups, as seen from the page."""
    told = (
        f"{document['set_ups']} set-ups with truths by boundary elements to 1e-4 ({document['truths']}); {document['sealed']} of them are sealed "
        "by a hash of their names: no constant was fitted on them. Errors are relative to the truth. Times: one "
        f"core, one run, new pose each time. Repeat: {COMMAND}."
    )
    cases = set_by_set(document["cases"], set_ups)
    return page.section(TITLE, page.finding(finding(document)), _table(document), cases, page.soft(told))


def finding(document: Document) -> str:
    """Tells the error that the best closed formula leaves on unseen set-ups, and its cost."""
    known = {entry["name"]: entry for entry in document["corrections"]}
    plain, best, reduced = (known[name] for name in set_ups.METHODS)
    ratios = {shape: times[FORMULA] / times[PLAIN] for shape, times in document["nanoseconds"].items()}
    return (
        f"In the {best['sealed']['count']} set-ups never used to find it, the formula is {percent(best['sealed']['rms'])} off (rms) and "
        f"{percent(best['sealed']['worst'])} at worst, where the plain model is {percent(plain['sealed']['rms'])} and "
        f"{percent(plain['sealed']['worst'])}, at {min(ratios.values()):.1f} to {max(ratios.values()):.1f} times its time per "
        "triangle. The reduced method has no fitted constant: "
        f"{percent(reduced['all']['rms'])} off (rms) and {percent(reduced['all']['worst'])} at worst in all "
        f"{reduced['all']['count']}."
    )


def _table(document: Document) -> Markup:
    def error(over: str, name: str) -> Callable[[Document], str]:
        return lambda entry: percent(entry[over][name])

    def time(known: dict[str, float]) -> Callable[[Document], str]:
        return lambda entry: f"{known[entry['name']]:.3g}"

    return page.table_of(
        document["corrections"],
        ("method", lambda entry: page.code(entry["name"])),
        ("rms", error("all", "rms")),
        ("median", error("all", "median")),
        ("95 %", error("all", "percentile_95")),
        ("worst", error("all", "worst")),
        ("sealed: rms", error("sealed", "rms")),
        ("worst", error("sealed", "worst")),
        *((f"ns, {shape}", time(known)) for shape, known in document["nanoseconds"].items()),
        strong=frozenset({set_ups.METHODS.index(REDUCED)}),
    )


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
        return {Whole().id: document} if evaluated_ == list(set_ups.METHODS) else {}


def stage(folder: Path) -> Stage:
    """Returns the stage of the one document."""
    python = [
        path.relative_to(ROOT).as_posix()
        for name in ("analysis/topics/corrections", "geometries")
        for path in sorted((ROOT / name).rglob("*.py"))
    ]
    code = keys.code_of((*_SOURCES, *python, STORED.file.relative_to(ROOT).as_posix()), ROOT)
    key = keys.measurement_key(COMMAND, code, machine.identity())
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
    cases = set_ups.estimate(module)
    return {
        "truths": STORED.file.relative_to(ROOT).as_posix(),
        "set_ups": len(cases),
        "sealed": sum(case["sealed"] for case in cases),
        "corrections": set_ups.evaluations(cases),
        "cases": cases,
    }


def nanoseconds(program: Path) -> dict[str, dict[str, float]]:
    """Measures the processor time per triangle of every method (second key) on every shape, all in one run in random
    order; the least of three."""
    with temporary_folder() as folder:
        answer = folder / "answer.json"
        command = ending_with_this([program, *timed(str(answer))])
        subprocess.run(command, check=True, capture_output=True)
        entries = json.loads(answer.read_text(encoding="utf-8"))["benchmarks"]
    sets = by_set(entries).items()
    return {shape: {name: 1e9 * seconds(entry) for name, entry in methods.items()} for shape, methods in sets}


CORRECTIONS = Topic[Whole, Document](
    stages=Evaluated(),
    set_ups=lambda: (Whole(),),
    entry=lambda _, answer: answer,
    sections=lambda found, _, set_ups: [section(found[0], set_ups)],
    finding=lambda found: finding(found[0]),
    absent=ABSENT,
    title="Corrections",
    question="What can be corrected, and at what cost?",
    short="corrections",
    truths=STORED,
    set_ups_page=lambda found, *around: set_ups_document(found[0]["cases"], *around),
)
