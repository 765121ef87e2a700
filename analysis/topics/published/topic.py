"""The published table as a topic: set-ups above, beside and diagonal to a plate, with bounds and four digits for every value. The table and its checks are CSV
files, kept with the project; TABLE.md tells how they were made."""

import csv
import hashlib
import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.pipeline.set_up_stages import Whole
from analysis.report import page, set_ups_page
from analysis.report.plot import Panel, axis, by_family, figure, log_axis
from analysis.results.answers import Estimate
from analysis.results.set_up import Rectangle
from analysis.results.store import Document
from analysis.results.study_results import Failure
from analysis.results.units import CENTIMETRE, in_words
from analysis.topics.topic import Topic
from geometries.common.measured import measured
from geometries.studies import study

MUTUAL, SENSOR, TARGET, DELTA_SELF = "mutual", "self_sensor", "self_target", "delta_self"
QUANTITIES = (MUTUAL, SENSOR, TARGET, DELTA_SELF)


@dataclass(frozen=True)
class Value:
    """Picofarad: the best value with its stated error, and the bounds."""

    best: float
    error: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the width of the interval, relative to the best value."""
        return (self.high - self.low) / (2 * self.best)


@dataclass(frozen=True, eq=False)
class Row:
    """One set-up. `parameters` are those of its family, in metres and degrees; `target` is the plate in the sensor's frame."""

    case: str
    family: str
    parameters: dict[str, float]
    target: Rectangle
    values: dict[str, Value]


PLACE = Path(__file__).parent
"""The folder of the published table."""
TABLE, CHECKS, PAGE = "reference_table.csv", "checks.csv", "TABLE.md"
STUDY = "published"

_LENGTHS = ("target_x", "target_y", "gap", "height")
_ANGLES = ("tilt_degrees", "turn_degrees")
_VECTORS = ("corner", "edge_u", "edge_v")
_PARTS = {"": "best", "_error": "error", "_low": "low", "_high": "high"}


@dataclass(frozen=True)
class Check:
    """A value of the field solver and of the table (pF), each with its error."""

    case: str
    quantity: str
    value: Estimate
    best: Estimate

    @property
    def difference(self) -> float:
        """The difference relative to the table's value."""
        return self.value.value / self.best.value - 1


def load() -> tuple[list[Row], list[Check]]:
    """Returns the table and its checks."""
    texts = ((PLACE / name).read_text(encoding="utf-8") for name in (TABLE, CHECKS))
    rows, checks = (csv.DictReader(io.StringIO(text)) for text in texts)
    return list(map(_row, rows)), list(map(_check, checks))


def digest() -> str:
    """Returns a hash of the table and of its checks."""
    contents = [(PLACE / name).read_bytes() for name in (TABLE, CHECKS)]
    return hashlib.sha256(b"".join(contents)).hexdigest()


def cases() -> list[study.Case]:
    """Returns the set-ups in the order of the table."""
    return [case for case in study.load(study.find(STUDY)).cases() if case.family != study.EMPTY]


def _check(record: dict[str, str]) -> Check:
    numbers = (float(record[name]) for name in ("value", "error", "best", "best_error"))
    value, error, best, best_error = numbers
    return Check(record["case"], record["quantity"], Estimate(value, error), Estimate(best, best_error))


def _row(record: dict[str, str]) -> Row:
    parameters = {name: float(record[f"{name}_m"]) for name in _LENGTHS if record[f"{name}_m"]}
    parameters |= {name: float(record[name]) for name in _ANGLES if record[name]}
    vectors = [np.array([float(record[f"{vector}_{axis}_m"]) for axis in "xyz"]) for vector in _VECTORS]
    values = {
        quantity: Value(*(float(record[f"{quantity}{suffix}_pF"]) for suffix in _PARTS))
        for quantity in QUANTITIES
    }
    return Row(record["case"], record["family"], parameters, Rectangle(*vectors), values)


TITLE = "A reference table of capacitances around a plate"
Published = tuple[list[Row], list[Check]]
"""The rows of the table, and what the field solver finds of some."""
_PERCENT = 100.0
_CHECKED_EACH = 60
"""Every so many set-ups, the field solver computed one as in any study."""
STRICTEST = 1e-5
"""The smallest relative accuracy that was asked of boundary elements."""


def section(published: Published, set_ups: str) -> Markup:
    """Tells what the table holds and how sure it is; `set_ups` is the file of the page of its set-ups, as seen from the page."""
    found, checks = published
    gaps, widths = log_axis("gap (cm)"), axis("half width (%)", rangemode="tozero")

    def mutual(row: Row) -> float:
        return row.values[MUTUAL].best

    values = _points(found, lambda row: row.parameters["gap"] / CENTIMETRE, mutual)
    halves = _points(found, mutual, lambda row: _PERCENT * row.values[MUTUAL].half_width)
    half = "half the width of the interval that mutual is proven to lie in"
    panels = [Panel("mutual, best values", figure(values, gaps, log_axis("mutual (pF)")))]
    panels.append(Panel(half, figure(halves, log_axis("mutual (pF)"), widths)))
    place = PLACE.relative_to(PLACE.parent.parent)
    return page.section(
        TITLE,
        page.finding(headline(found)),
        page.figures(panels, set_ups=set_ups),
        page.soft(
            f"A click on a point opens its set-up. {check_finding(checks).replace('`', '')} The table is {place / TABLE}, explained in "
            f"{PAGE} beside it."
        ),
    )


def headline(found: list[Row]) -> str:
    """Tells the number of set-ups and values, and their accuracy."""
    values = [value for row in found for value in row.values.values()]
    worst = max(value.error / value.best for value in values)
    return (
        f"{len(found)} set-ups of a plate above, beside and diagonal to a square plate, {len(values)} values: mutual, both own capacitances and "
        f"delta_self of each, every one enclosed and with a best value whose stated error is at most {worst:.1e}."
    )


def check_finding(checks: list[Check]) -> str:
    """Tells how far the field solver's own best values are from the table's."""
    agreeing = sum(check.value.agrees_with(check.best) for check in checks)
    differences = [abs(check.difference) for check in checks]
    cases = len({check.case for check in checks})
    return (
        f"In every {_CHECKED_EACH}th set-up, {cases} of them, the field solver computed its best values with estimated errors "
        f"(`{CHECKS}`): {agreeing} of {len(checks)} agree within the sum of both errors; the difference is {float(np.median(differences)):.1e} in "
        f"the median and {max(differences):.1e} at most."
    )


def set_ups_document(published: Published, back: str, back_title: str, inputs: str, script: str) -> str:
    """Returns the page of the table's set-ups; `back` is the file of the page that leads to it, `inputs` the hash of what it is made from."""
    found, _ = published
    texts = {case.id: case for case in cases()}
    around = set_ups_page.Around(
        "Set-ups of the published table",
        back,
        back_title,
        ("quantity (pF)", "best value", "proven: low", "high"),
        "mutual = −M[sensor, target], self = M[s,s] or M[t,t], delta_self = M[s,s] − M0[s,s], M0 without the target.",
        (f"--method boundary-elements --rtol {STRICTEST:g} --entries",),
    )
    return set_ups_page.document(around, [_shown(row, texts[row.case]) for row in found], inputs, script)


def _points(found: list[Row], x: Callable[[Row], float], y: Callable[[Row], float]) -> list[go.Scatter]:
    hover = "%{x:.4g}, %{y:.4g}"
    return by_family(found, lambda row: row.family, hover, size=6, x=x, y=y, customdata=lambda row: row.case)


def _shown(row: Row, case: study.Case) -> set_ups_page.Shown:
    numbers = tuple(
        (quantity, measured(value.best, value.error), f"{value.low:.7g}", f"{value.high:.7g}")
        for quantity, value in row.values.items()
    )
    _, best, low, high = numbers[QUANTITIES.index(MUTUAL)]
    finding = f"mutual: {best} pF, proven to lie in [{low}, {high}]."
    (plate,) = case.scene.sensors[0].plates
    sides = (f"{np.linalg.norm(edge) / CENTIMETRE:g}" for edge in (plate.edge_u, plate.edge_v))
    description = f"Sensor {' × '.join(sides)} cm, {in_words(dict(row.parameters))}."
    return set_ups_page.Shown(row.case, row.family, description, (finding,), numbers, case.scene, case.text)


@dataclass(frozen=True)
class Kept:
    """The table that is kept with the project, whatever answers there are."""

    name: str = STUDY

    def run(self, folder: Path, _: Iterable[Whole], workers: int | None = None) -> list[Failure]:
        """Returns no failures: there is nothing to compute."""
        return []

    def load(self, _: Path, __: Iterable[Whole]) -> dict[str, Document]:
        """Returns the hash of the table."""
        return {Whole().id: {"digest": digest()}}


PUBLISHED = Topic[Whole, Published](
    stages=Kept(),
    set_ups=lambda: (Whole(),),
    entry=lambda _, __: load(),
    sections=lambda found, _, set_ups: [section(found[0], set_ups)],
    finding=lambda found: headline(found[0][0]),
    absent="",
    title=TITLE,
    question="Which values can others be held against?",
    short="published table",
    set_ups_page=lambda found, *around: set_ups_document(found[0], *around),
)
