"""`python3 -m analysis measure survey SCENE`: times a survey by itself, without its page."""

from __future__ import annotations

import argparse
import time

from analysis.coverage.probes import DEFAULT, probe
from analysis.coverage.survey import Options, survey
from analysis.pipeline.model_stage import model_module
from analysis.show.make import find_scene
from geometries.common.arguments import positive_number
from geometries.scene import reader


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what may be asked for."""
    parser.add_argument("scene", metavar="SCENE")
    parser.add_argument("--probe", action="append", default=[], metavar="PROBE")
    parser.add_argument("--grid", type=positive_number, metavar="M")


def measure(options: argparse.Namespace) -> int:
    """Prints the times."""
    print(_measured(options.scene, tuple(options.probe) or DEFAULT, options.grid))
    return 0


def _measured(name: str, names: tuple[str, ...], grid: float | None) -> str:
    """Surveys a scene; returns the times as a line."""
    path = find_scene(name)
    scene, model = reader.load(path), model_module()
    probes = tuple(probe(each) for each in names)
    passed, used = time.perf_counter(), time.process_time()
    found = survey(path, scene, probes, Options(grid=grid, methods=()), model)
    passed, used = time.perf_counter() - passed, time.process_time() - used
    return f"{path.stem}: {len(found.places.points)} places, {len(probes)} probes, {found.panels} panels: {used:.1f} s of processor time, {passed:.1f} s passed"
