"""`python3 -m analysis sweep SCENE`: runs `fringe sweep` and makes the page of its table."""

from __future__ import annotations

import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

from analysis.pipeline import keys
from analysis.report.page import provide_script, write
from analysis.show.make import find_scene, motion_beside
from analysis.sweep import page, series
from geometries.common import installation
from geometries.common.children import ending_with_this
from geometries.common.errors import InputError
from geometries.scene import motion, reader

METHODS = "exact,formula,auto,boundary-elements"
"""The model, the formula, and what states an error."""
RTOL = 1e-2
_STATING = ("auto", "boundary-elements", "reduced")
_ANSWERED, _NOT_REACHED = 0, 3


@dataclass(frozen=True)
class Made:
    """The page and its findings; whether every method reached the error asked for; or the exit status of a sweep that failed."""

    page: Path
    findings: list[str]
    status: int

    @property
    def is_made(self) -> bool:
        return self.status in (_ANSWERED, _NOT_REACHED)


def make(
    name: str,
    motion_file: Path | None = None,
    target: Path | None = None,
    methods: str = METHODS,
    rtol: float | None = None,
) -> Made:
    """Runs the sweep of a scene, a file or a name in geometries/scenes, and writes its page, with the table beside it under the same
    name, of a scene outside of the repository in the current folder. Frames that the table holds already are not computed again.

    `methods` are separated by commas; of those that state errors the relative error `rtol` is asked, RTOL if it is None. InputError for files
    that cannot be used.
    """
    path = find_scene(name)
    scene = reader.load(path)
    moved = motion_file or motion_beside(path)
    if moved is None:
        raise InputError(str(path), "", "has no motion beside it: name one by --motion")
    frames = motion.load(moved, scene)
    place = target or installation.results_folder(path) / "sweep" / f"{path.stem}.html"
    table = place.with_suffix(".csv")
    arguments = ["sweep", str(path), "--motion", str(moved), "--method", methods]
    if rtol is not None or any(method.startswith(_STATING) for method in methods.split(",")):
        arguments += ["--rtol", f"{RTOL if rtol is None else rtol:g}"]
    command = [*arguments, "--output", str(table)]
    # Its progress and its messages go to the terminal.
    program = ending_with_this([installation.model_program(), *command])
    status = subprocess.run(program, stdout=subprocess.DEVNULL, check=False).returncode
    if status not in (_ANSWERED, _NOT_REACHED):
        return Made(place, [], status)
    found = series.read(table)
    inputs = keys.page_inputs(table.read_text(encoding="utf-8"))
    title = f"{path.stem.replace('_', ' ')}: readings over {len(frames)} frames"
    shown = shlex.join([installation.model_command(), *command])
    provide_script(place.parent)
    write(place, page.document(title, inputs, found, frames, table.name, shown))
    return Made(place, page.findings(found, frames), status)
