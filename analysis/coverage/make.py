"""`python3 -m analysis coverage SCENE`: surveys a machine and writes its page, its table and its file for ParaView. The page has the machine with the
surface of first notice around it, and what the survey found."""

import base64
import math
import shlex
from pathlib import Path

import numpy as np
from markupsafe import Markup

from analysis.coverage import findings
from analysis.coverage.distances import ANY, distances, write_csv, write_vtu
from analysis.coverage.places import DEFAULT, probe
from analysis.coverage.survey import BOUNDARY_ELEMENTS, FARTHEST, NEAREST, NEGLIGIBLE, Options, Survey, survey
from analysis.pipeline import keys
from analysis.pipeline.model_stage import model_module
from analysis.report import page
from analysis.results.store import Document, write_text
from analysis.show import find_scene, mesh
from geometries.common import installation
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.scene import Scene

FACTORS = np.geomspace(0.1, 100, 31)
"""Thresholds of the slider, over the scene's."""
MOST_DRAWN = 3000
"""Largest number of places on the page; the table has all."""
_BLOCKED = 65535
_PER_METRE = 10_000
"""Units of the distances in the page, 0.1 mm."""
_MOST_BLIND = 12


def make(name: str, probes: tuple[str, ...], options: Options, target: Path | None) -> page.Made:
    """Surveys a scene, a file or a name in geometries/scenes, and writes SCENE.html, SCENE.csv and SCENE.vtu; the headline has a sentence for each
    probe. InputError for files and options that
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
    write_csv(found, table)
    write_vtu(found, place.with_suffix(".vtu"))
    inputs = keys.page_inputs(table.read_text(encoding="utf-8"))
    asked = [("--probe", one) for one in probes] + [("--reading", one) for one in options.readings]
    words = [*shlex.split(installation.command("analysis")), "coverage", str(name)]
    shown = shlex.join([*words, *(word for option in asked for word in option)])
    title = f"{path.stem.replace('_', ' ')}: where a probe is noticed"
    targets = {body.name for body in scene.objects if body.target}
    whole = model.Scene.load(str(path)).conductors()
    conductors = {name: triangles for name, triangles in whole.items() if name not in targets}
    write_text(place, document(title, inputs, scene, found, conductors, table.name, shown))
    return page.Made(place, "\n".join(sentences(found)))


Bodies = dict[str, Array]
"""Triangles (n, 3, 3) of bodies by their names."""


def document(
    title: str, inputs: str, scene: Scene, survey: Survey, bodies: Bodies, table: str, command: str
) -> str:
    """Returns the whole page."""
    body = page.filled(
        "coverage.html",
        style=page.static("show.css"),
        script=page.static("parts.js", "coverage.js"),
        title=title,
        finding=sentences(survey)[0],
        data=page.json_in_page(_data(survey, bodies), allow_nan=False),
        probes=[probe.name for probe in survey.probes],
        readings=[ANY, *(reading.name for reading in survey.readings)],
        steps=len(FACTORS) - 1,
        start=int(np.argmin(np.abs(FACTORS - 1))),
    )
    return page.document(title, inputs, [body, *_sections(scene, survey, table, command)])


def sentences(survey: Survey) -> list[str]:
    """Returns what the survey found, a sentence for each probe."""
    found = []
    for probe, told in zip(survey.probes, findings.noticed(survey)):
        if not told.noticed:
            found.append(f"{probe.name}: no reading notices it at any of {told.held} places.")
            continue
        lengths = told.median, told.nearest, told.farthest
        median, nearest, farthest = (f"{100 * metres:.3g} cm" for metres in lengths)
        found.append(
            f"{probe.name}: noticed at {told.noticed} of {told.held} places, from {median} in the median "
            f"({nearest} to {farthest} at nine of ten); {told.held - told.noticed} are blind."
        )
    return found


def _sections(scene: Scene, survey: Survey, table: str, command: str) -> list[Markup]:
    proven = [reading.name for reading in survey.readings if reading.is_proven]
    known = zip(survey.readings, survey.thresholds)
    thresholds = ", ".join(f"{reading.name} {threshold * 1e15:.3g} fF" for reading, threshold in known)
    # Nothing has been said of a machine without sensors.
    said = (findings.nearby_sentence, findings.centre_sentence) if scene.sensors else ()
    told = filter(None, [sentence(scene, survey) for sentence in said])
    claims = [page.section("What has been said of such sensors", *map(page.paragraph, told))] if said else []
    parts = [
        page.section(
            "How far each probe is noticed",
            *map(page.paragraph, sentences(survey)),
            page.soft(
                f"Thresholds: {thresholds}. A place is a point of the machine's surface; the probe is held before it, its nearest point {NEAREST * 1000:g} mm to {FARTHEST:g} m away along the normal. "
                "Its distance is that up to which every position is noticed. Blind: not noticed at the nearest position."
            ),
            page.navigation(page.link(table, "All places as a table")),
            page.command(command),
        ),
        page.section("Blind spots", *(_blind(survey, p) for p in range(len(survey.probes)))),
        *claims,
        _guarantee(proven, len(survey.readings)),
    ]
    if survey.by_method:
        parts.append(_methods(survey))
    return parts


def _blind(survey: Survey, probe: int) -> Markup:
    counts = sorted(findings.blind_bodies(survey, probe), key=lambda told: -told[2])
    some = [told for told in counts if told[2]]
    rows = [[name, str(held), str(blind), f"{100 * blind / held:.0f} %"] for name, held, blind in some]
    title = page.heading(survey.probes[probe].name)
    if not rows:
        return page.lines([title, page.paragraph("No blind spot among the places.")])
    shown = page.table(["sensor or object", "places", "blind", "share"], rows[:_MOST_BLIND])
    more = [page.soft(f"and {len(rows) - _MOST_BLIND} more, in the table")] if rows[_MOST_BLIND:] else []
    return page.lines([title, shown, *more])


def _guarantee(proven: list[str], count: int) -> Markup:
    of = "every reading" if len(proven) == count else ", ".join(proven)
    guaranteed = (
        f"For {of}, which senses a conductor that it drives, a grounded body that contains a grounded probe changes the reading at least as much as the "
        "probe does (Dirichlet's principle and the maximum principle). So at each place a larger body is noticed at the probe's distance, too: this is guaranteed, within the "
        "error of the computed change."
        if proven
        else "No reading senses a conductor that it drives: nothing is guaranteed for larger bodies."
    )
    return page.section(
        "What is guaranteed",
        page.paragraph(guaranteed),
        page.paragraph(
            "Everything else is sampled: between the places, along other directions, for floating bodies, and for readings that sense what they do not drive."
        ),
    )


def _methods(survey: Survey) -> Markup:
    def known(value: float, words: str) -> str:
        return "–" if math.isnan(value) else words

    return page.section(
        "What other methods would have said",
        page.table_of(
            findings.comparisons(survey),
            ("method", lambda told: told.method),
            ("probe", lambda told: told.probe),
            ("places", lambda told: str(told.places)),
            ("distance, median difference", lambda told: known(told.excess, f"{100 * told.excess:+.1f} cm")),
            ("change, median ratio", lambda told: known(told.ratio, f"{told.ratio:.3g}")),
            ("noticed only by it", lambda told: f"{told.false} of {told.asked}"),
            text_columns=2,
        ),
        page.soft(
            f"At {len(survey.compared)} places. The survey itself solves every probe before the machine by {BOUNDARY_ELEMENTS}: {survey.panels} panels, with an "
            f"estimated error of {100 * survey.error:.2g} % of the sensors' own charges; positions with less than {100 * NEGLIGIBLE:g} % of the threshold are those of the limit for small "
            "probes. A difference of +5 cm says that the method promises 5 cm more than there are."
        ),
    )


def _data(survey: Survey, conductors: dict[str, Array]) -> Document:
    drawn = np.unique(np.linspace(0, len(survey.places.points) - 1, MOST_DRAWN).astype(int))
    packed = []
    for p in range(len(survey.probes)):
        for k in (None, *range(len(survey.readings))):
            steps = np.stack([distances(survey, p, k, float(factor))[0][drawn] for factor in FACTORS])
            units = np.where(np.isnan(steps), _BLOCKED, np.round(np.nan_to_num(steps) * _PER_METRE))
            packed.append(base64.b64encode(units.astype("<u2").tobytes()).decode())
    named = {reading.name for reading in survey.readings}
    return {
        "bodies": [{"name": name, **mesh(triangles)} for name, triangles in conductors.items()],
        "sensors": [name for name in conductors if name in named],
        "points": survey.places.points[drawn].round(4).tolist(),
        "normals": survey.places.normals[drawn].round(4).tolist(),
        "owners": [survey.places.owners[k] for k in drawn],
        "factors": FACTORS.tolist(),
        "thresholds": [None, *survey.thresholds],
        "readings": len(survey.readings) + 1,
        "distances": packed,
        "blocked": _BLOCKED,
        "per_metre": _PER_METRE,
    }
