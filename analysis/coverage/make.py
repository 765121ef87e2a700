"""`python3 -m analysis coverage SCENE`: surveys a machine and writes its page, its table and its file for ParaView."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

from analysis.coverage import distances, page
from analysis.coverage.probes import DEFAULT, probe
from analysis.coverage.survey import Options, survey
from analysis.pipeline import keys
from analysis.pipeline.model_stage import model_module
from analysis.results.store import write_text
from analysis.show.make import find_scene
from geometries.common import installation
from geometries.common.errors import InputError
from geometries.scene import reader


@dataclass(frozen=True)
class Made:
    """The page, and what the survey found, a sentence for each probe."""

    page: Path
    findings: list[str]


def make(name: str, probes: tuple[str, ...], options: Options, target: Path | None) -> Made:
    """Surveys a scene, a file or a name in geometries/scenes, and writes SCENE.html, SCENE.csv and SCENE.vtu. InputError for files and options that
    cannot be used."""
    path = find_scene(name)
    scene = reader.load(path)
    model = model_module()
    chosen = tuple(probe(text) for text in probes or DEFAULT)
    try:
        found = survey(path, scene, chosen, options, model)
    except InputError as error:
        # Errors of the reader name the file already, those of the methods do not.
        if error.file or error.reason.startswith(str(path)):
            raise
        raise InputError(str(path), error.key, error.reason) from error
    place = target or installation.results_folder() / "coverage" / f"{path.stem}.html"
    table = place.with_suffix(".csv")
    distances.write_csv(found, table)
    distances.write_vtu(found, place.with_suffix(".vtu"))
    inputs = keys.page_inputs(table.read_text(encoding="utf-8"))
    shown = shlex.join(
        [*shlex.split(installation.command("analysis")), "coverage", str(name)]
        + [part for one in probes for part in ("--probe", one)]
        + [part for one in options.readings for part in ("--reading", one)]
    )
    title = f"{path.stem.replace('_', ' ')}: where a probe is noticed"
    targets = {body.name for body in scene.objects if body.target}
    whole = model.Scene.load(str(path)).conductors()
    conductors = {name: triangles for name, triangles in whole.items() if name not in targets}
    write_text(place, page.document(title, inputs, scene, found, conductors, table.name, shown))
    return Made(place, page.sentences(found))
