"""The verification of the field reference as a topic: known capacitances, its errors, compared with its stated ones, and its orders of convergence."""

import functools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.pipeline import keys
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import NoAnswer, Processes, Stage, outdated, parsed
from analysis.report import page
from analysis.report.plot import Panel, figure, guide, joined, marks, power_axis, series_colour
from analysis.results.statistics import grouped
from analysis.results.store import Document, read_json
from analysis.results.study_results import Failure
from analysis.topics.topic import Topic
from geometries.common.installation import ROOT

ROUNDING = 2.0**-52
CLEAR_OF_TRUTH = 3.0
"""A level's error is used for the order of convergence if it is this many times the error of the truth."""


@dataclass(frozen=True)
class Compared:
    """One quantity whose truth is known; all errors are relative to it. `level_errors` have their sign."""

    case: str
    quantity: str
    source: str
    truth_error: float
    off: float
    stated: float
    half_width: float | None
    enclosed: bool | None
    edge_sizes: tuple[float, ...]
    level_errors: tuple[float, ...]
    seconds: float

    @property
    def within(self) -> bool:
        """Whether the truth is within the stated error, as far as it is known."""
        return self.off <= self.stated + self.truth_error

    @property
    def known_off(self) -> float:
        """The true error, or the error of the truth if that is larger."""
        return max(self.off, self.truth_error, ROUNDING)

    @property
    def effectivity(self) -> float:
        """The stated error over the true one: below 1 it is wrong, far above 1 it wastes time."""
        return self.stated / self.known_off

    @property
    def enclosure_effectivity(self) -> float | None:
        """Half the width of the enclosure over the best value's true error."""
        return None if self.half_width is None else self.half_width / self.known_off

    @property
    def clear_levels(self) -> list[tuple[float, float]]:
        """Element size and error of the levels whose error is well above that of the truth."""
        pairs = zip(self.edge_sizes, self.level_errors)
        return [(size, abs(error)) for size, error in pairs if abs(error) > CLEAR_OF_TRUTH * self.truth_error]

    @property
    def order(self) -> float | None:
        """The order of convergence: the power of the element size by which the errors fall; None with fewer than three levels."""
        if len(self.clear_levels) < 3:
            return None
        sizes, errors = zip(*self.clear_levels)
        return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def compared(rows: Mapping[str, Document]) -> list[Compared]:
    """Returns every quantity of the rows, in their order."""
    return [_compared(name, row, quantity) for name, row in rows.items() for quantity in row["quantities"]]


def _compared(case: str, row: Document, quantity: Document) -> Compared:
    truth, slack = quantity["truth"], quantity["truth_error"]
    size = abs(truth)
    half = enclosed = None
    if "lower" in quantity:
        half = (quantity["upper"] - quantity["lower"]) / 2 / size
        enclosed = quantity["lower"] <= truth + slack * size and truth - slack * size <= quantity["upper"]
    off, stated = abs(quantity["value"] - truth) / size, quantity["error"] / size
    levels = tuple((value - truth) / size for value in quantity["levels"])
    described, sizes = (case, quantity["name"], row["source"]), tuple(row["edge_sizes"])
    return Compared(*described, slack, off, stated, half, enclosed, sizes, levels, row["seconds"])


def worst_of_each_case(found: Iterable[Compared]) -> list[Compared]:
    """Returns, for each case, the quantity whose true error is the largest fraction of the stated one."""
    cases = grouped(found, lambda row: row.case).values()
    return [max(own, key=lambda row: row.off / row.stated) for own in cases]


TITLE = "The reference against known capacitances"
ABSENT = (
    "This version of the reference has not been verified yet: python3 -m analysis verify does it in minutes, and ./run "
    "nightly with the nightly study."
)
_WHAT = (
    "Effectivity is the stated error over the true one: below 1 it is wrong. The true error is taken as at least the error of the "
    "truth. The enclosure is that of the same answer; strips and delta_self have an estimate only. Strips are the limit of "
    "plates of one, two and three times a length."
)
_ORDER = (
    "The error of a mesh is proportional to the edge size at edges (order 1), and falls faster on round bodies, which have none. "
    "The fit fails where all levels share an error, or where the error changes its sign."
)
_SMALLEST = 1e-7


def chapter(found: list[Compared], missing: list[str]) -> Markup:
    """Returns the chapter; one sentence when there is nothing."""
    if not found:
        return page.section(TITLE, page.paragraph(ABSENT))
    words = f"{len(missing)} rows failed or are not solved yet; the numbers below do not include them: {'; '.join(missing)}."
    return page.section(
        TITLE,
        *([page.paragraph(words)] if missing else []),
        page.finding(finding(found)),
        page.figures([_stated_against_true(found)]),
        page.paragraph(
            "For each set-up, the quantity whose true error is the largest fraction of the stated one."
        ),
        page.table_of(worst_of_each_case(found), *_COLUMNS, text_columns=2),
        page.folded(
            f"All {len(found)} quantities", page.table_of(found, *_COLUMNS, *_OF_ALL, text_columns=2)
        ),
        page.soft(_WHAT),
        *_orders(found),
        page.soft("Again, from the project's folder: python3 -m analysis verify"),
    )


def finding(found: list[Compared]) -> str:
    """Tells how many truths lie within the stated errors, how large the true errors are, and the effectivities."""
    cases = len({row.case for row in found})
    middle, worst = np.median([row.off for row in found]), max(found, key=lambda row: row.off)
    sentences = [
        f"{sum(row.within for row in found)} of {len(found)} known quantities of {cases} set-ups are within the stated error; the best value is off by "
        f"{middle:.1e} (median) and {worst.off:.1e} at most ({worst.case}, {worst.quantity}).",
        f"Stated over true error: {_spread([row.effectivity for row in found])}.",
    ]
    enclosed = [row for row in found if row.enclosed is not None]
    if enclosed:
        inside = sum(bool(row.enclosed) for row in enclosed)
        widths = [row.half_width for row in enclosed if row.half_width is not None]
        ratios = [row.enclosure_effectivity for row in enclosed if row.enclosure_effectivity is not None]
        sentences.append(
            f"{inside} of {len(enclosed)} enclosures hold the truth; half their width is {np.median(widths):.1e} (median) and "
            f"{_spread(ratios)} times the best value's true error."
        )
    outside = {f"{row.case}, {row.quantity}" for row in found if not row.within or row.enclosed is False}
    if outside:
        sentences.append(f"Outside: {'; '.join(sorted(outside))}.")
    return " ".join(sentences)


def _spread(values: Iterable[float]) -> str:
    known = list(values)
    return f"median {np.median(known):.2g}, from {min(known):.2g} to {max(known):.2g}"


def _stated_against_true(found: list[Compared]) -> Panel:
    ends = [max(min(row.known_off for row in found), _SMALLEST), max(row.stated for row in found)]
    traces = [
        guide("equal", ends, ends),
        _marks("stated error of the best value", [(row, row.stated) for row in found], 0, "circle"),
        _marks("half the enclosure's width", [(row, row.half_width) for row in found if row.half_width], 1, "square-open"),
    ]  # fmt: skip
    x, y = power_axis("true relative error of the best value"), power_axis("relative error as stated")
    caption = "stated against true error: below the line a stated error would be wrong"
    return Panel(caption, figure(traces, x, y, height=460))


def _marks(name: str, rows: list[tuple[Compared, float | None]], index: int, symbol: str) -> go.Scatter:
    return marks(
        name,
        [max(row.known_off, _SMALLEST) for row, _ in rows],
        [value for _, value in rows],
        {"color": series_colour(index), "symbol": symbol, "size": 8},
        "%{customdata}<br>off by %{x:.1e}, %{y:.1e}",
        customdata=[f"{row.case}, {row.quantity}" for row, _ in rows],
    )


_COLUMNS: tuple[tuple[str, Callable[[Compared], str]], ...] = (
    ("set-up", lambda row: row.case),
    ("quantity", lambda row: row.quantity),
    ("known to", lambda row: f"{row.truth_error:.0e}" if row.truth_error else "exact"),
    ("off by", lambda row: f"{row.off:.1e}"),
    ("stated", lambda row: f"{row.stated:.1e}"),
    ("effectivity", lambda row: f"{row.effectivity:.2g}"),
    ("within", lambda row: page.yes_or_no(row.within)),
    ("half width", lambda row: _known(row.half_width, ".1e")),
    ("effectivity", lambda row: _known(row.enclosure_effectivity, ".2g")),
    ("truth inside", lambda row: "" if row.enclosed is None else page.yes_or_no(row.enclosed)),
    ("order", lambda row: _known(row.order, ".2f")),
)

# The table of all answers also tells where each truth is from, and the run time.
_OF_ALL = (("seconds", lambda row: f"{row.seconds:.1f}"), ("truth from", lambda row: row.source))


def _known(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _orders(found: list[Compared]) -> list[Markup]:
    shown = [row for row in worst_of_each_case(found) if row.order is not None]
    if not shown:
        return []
    orders = [row.order for row in shown if row.order is not None]
    near = sum(0.7 <= order <= 1.4 for order in orders)
    says = page.finding(
        f"Over three and more meshes the error falls with the power {np.median(orders):.2f} of the edge size (median of "
        f"{len(orders)} set-ups; {near} of them between 0.7 and 1.4, in theory 1 at edges)."
    )
    figures = page.figures([_error_over_size(shown)])
    return [page.heading("Orders of convergence"), says, figures, page.soft(_ORDER)]


def _error_over_size(shown: list[Compared]) -> Panel:
    traces, look = [], {"line": {"color": series_colour(0), "width": 1}, "marker": {"size": 5}}
    for row in shown:
        largest, known = max(row.edge_sizes), row.clear_levels
        sizes, errors = [size / largest for size, _ in known], [error for _, error in known]
        hover = f"{escape(row.case)}<br>%{{y:.1e}}<extra></extra>"
        traces.append(joined(row.case, sizes, errors, series_colour(0), hover, showlegend=False, **look))
    middle = math.exp(float(np.mean([math.log(row.clear_levels[0][1]) for row in shown])))
    sizes = [1.0, 0.25]
    traces.append(guide("order 1", sizes, [middle * size for size in sizes], width=2))
    x = power_axis("edge size over that of the first mesh", tickvals=[1, 0.5, 0.25, 0.125, 0.0625])
    drawn = figure(traces, x | {"exponentformat": "none"}, power_axis("relative error of a mesh"), height=420)
    return Panel("error of each mesh against the size of its elements at edges", drawn)


_SOURCES = ("truths.py", "boundary_elements.json", "rooms.json", "set_ups.py")
# Expected seconds of a row on one core, for the order and the progress bar.
_SECONDS, _SECONDS_OF_STRIPS = 8.0, 30.0
_COMPILES_FORMS = "cube"


@dataclass(frozen=True)
class Row:
    """A row by its name."""

    id: str


def all_rows() -> Iterator[Row]:
    """Gives all rows in their order."""
    # Imported when the first one is asked for: loading the solver takes a second, and a report that is up to date does not need it.
    from analysis.topics.verification import set_ups

    yield from map(Row, set_ups.true_cases())


def code(repository: Path = ROOT) -> str:
    """Returns the version of the code that computes rows: the reference, and the set-ups and comparisons of this package."""
    place = repository / "analysis" / "topics" / "verification"
    own = keys.hash_of_files([place / name for name in _SOURCES], repository)
    return f"{keys.reference_code(repository)} {own}"


def key(name: str, code: str) -> str:
    """Returns the key of a row."""
    return keys.measurement_key(name, code, {})


def path_of(folder: Path, name: str) -> Path:
    return folder / "rows" / f"{name.replace('/', '-').replace(' ', '_')}.json"


@dataclass(frozen=True)
class Rows:
    """The stages of all rows."""

    name: str = "verification"

    def run(self, folder: Path, rows: Iterable[Row], workers: int | None = None) -> list[Failure]:
        """Solves the rows that are missing or out of date, `workers` at a time; returns those that failed."""
        current = code()
        missing = outdated([stage(folder, row.id, current) for row in rows])
        failures: list[Failure] = []
        # The others would wait for the forms that the first solve compiles.
        for is_first in (True, False):
            group = [each for each in missing if (each.name == _COMPILES_FORMS) == is_first]
            failures += run_all(group, workers or parallel_jobs(), "rows of the verification")
        return failures

    def load(self, folder: Path, _: Iterable[Row]) -> dict[str, Document]:
        """Returns the rows in a folder that are up to date, by name; rows of another version of the code are left out."""
        stored = [read_json(path) for path in sorted((folder / "rows").glob("*.json"))]
        current = code() if stored else ""
        return {row["row"]: row for row in stored if row and row["key"] == key(row["row"], current)}


def stage(folder: Path, name: str, code: str) -> Stage:
    """Returns the stage of one row."""
    seconds = _SECONDS_OF_STRIPS if name.startswith("facing strips") else _SECONDS
    return Stage(name, "", path_of(folder, name), key(name, code), seconds, functools.partial(answer, name))


def answer(name: str, processes: Processes) -> Document:
    """Solves one row."""
    finished = processes.run_module("analysis.topics.verification.set_ups", name)
    if finished.exit_code != 0:
        raise NoAnswer(finished.reason)
    return {"row": name, **parsed(finished.output)}


Entry = tuple[str, Document]
"""The name of a row and its answer."""


def truths(found: list[Entry]) -> Markup:
    """Returns the chapter on known capacitances; one sentence without rows."""
    rows = dict(found)
    missing = [row.id for row in all_rows() if row.id not in rows] if rows else []
    return chapter(compared(rows), missing)


VERIFICATION = Topic[Row, Entry](
    stages=Rows(),
    set_ups=all_rows,
    entry=lambda row, answer: (row.id, answer),
    sections=lambda found, _, __: [truths(found)],
    finding=lambda found: finding(compared(dict(found))),
    absent=ABSENT,
    title="Is the field solver right, and are its stated errors?",
    command="verify",
)
