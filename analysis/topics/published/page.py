"""The page beside the table: its contents, the proof of its bounds, and numbers computed from the files."""

from __future__ import annotations

import numpy as np

from analysis.results.units import percent
from analysis.topics.published import rows, stage
from analysis.topics.published.files import CHECKS, TABLE, Check
from analysis.topics.published.rows import QUANTITIES, Row

COMMAND = "python3 -m analysis table"

_TEXT = """# A reference table of capacitances around a plate

`{table}`: {headline}

## Geometry
The sensor is the square |x|, |y| ≤ 5 cm in the plane z = 0, the target another thin plate, both perfect conductors in free space with
ground at infinity. `corner`, `edge_u` and `edge_v` describe the target: it is the points corner + a·edge_u + b·edge_v, a and b from 0 to 1.
Capacitances are proportional to lengths: for a plate of side L multiply every length and every capacitance by L/10 cm.

| family | set-ups | target | `gap` | `height` | angles |
|---|---|---|---|---|---|
| inclined | {inclined} | pivots about its edge above the sensor's edge x = −5 cm, parallel to y | of that edge above the sensor | | `tilt`: 0 lying, 90 upright |
| edge | {edge} | beside the edge x = 5 cm, centred in y | from that edge to its near edge, along x | of the near edge | `tilt`: upwards about the near edge |
| corner | {corner} | diagonal to the corner (5 cm, 5 cm) | from that corner to the box around the target, along x and along y | of its lowest point | `tilt` about its y axis, then `turn` about z |

## Columns
`case` names the scene: the first digits of the hash of its canonical text. Lengths end in `_m`, metres; angles in `_degrees`;
capacitances in `_pF`, picofarad, ε₀ = 8.8541878128e-12 F/m. M is the Maxwell matrix, charge on a row's conductor per volt on a column's.

| quantity | meaning |
|---|---|
| mutual | −M[sensor, target]: charge on the grounded target per volt on the sensor |
| self_sensor, self_target | M[sensor, sensor] and M[target, target] |
| delta_self | M[sensor, sensor] less the sensor's own capacitance without the target |

Each has four columns: `_pF`, the best value; `_error_pF`, its stated error; `_low_pF` and `_high_pF`, bounds of the truth, rounded outwards.

## Best values
By boundary elements (model/BOUNDARY_ELEMENTS.md) at rtol = {strictest:g} to {loosest:g}, refined until no stated error is above {digits:g} of its
value. The largest stated error is {worst_error}. {checks}

## Bounds
- **Above.** The energy of a continuous potential that is 1 on one conductor and 0 on the other, integrated exactly and continued to
  infinity, is never less than that of the field (Dirichlet's principle): U − M is positive semidefinite, U the matrix of the energies
  of both potentials, found by finite elements on one mesh (fem_reference/NUMERICS.md, section 5).
- **Below.** Galerkin's method approximates the charges from below in energy: M − L is positive semidefinite, L its
  matrix. Its integrals are numerical. The stated errors, which include those of the integrals, are subtracted as a diagonal matrix of
  row sums, which exceeds every symmetric matrix with entries within them. That the errors are no larger than stated is an estimate; all
  else is proven, up to rounding.
- **Off the diagonal.** With D = U − L, M[i, j] is within ½√(D[i, i]·D[j, j]) of the middle of U[i, j] and L[i, j]
  (Cauchy and Schwarz for U − M and M − L).
- **delta_self** lies between the bounds of M[sensor, sensor] less those of the sensor alone. It is also at least
  mutual²/M[target, target], since a floating target only raises the sensor's capacitance, and at most mutual, since a
  grounded one lowers the potential everywhere, so that less charge faces infinity.

Half the width of the intervals, relative to the best value:

| quantity | median | worst |
|---|---|---|
{widths}

## How to reproduce it
    {command}

solves the set-ups whose answers are missing or out of date, a few seconds for each, into `results/published`, and writes `{table}`,
`{checks_file}` and this page. If it is interrupted, the same command continues. `geometries/studies/published.toml` is the list of set-ups. These commands solve one set-up alone, once the first has written the scenes:

    build/bin/fringe capacitance results/published/cases/CASE/scene.toml --method boundary-elements --rtol {strictest:g}
    python3 -m fem_reference results/published/cases/CASE/scene.toml

To cite it, name the project, the file and its sha256: `sha256sum {table}`.
"""


def headline(found: list[Row], checks: list[Check]) -> str:
    """Tells the number of set-ups and values, and their accuracy."""
    values = len(found) * len(QUANTITIES)
    return (
        f"{len(found)} set-ups of a plate above, beside and diagonal to a square plate, {values} values: mutual, both own capacitances and "
        f"delta_self of each, every one enclosed and with a best value whose stated error is at most {_scientific(rows.worst_error(found))}."
    )


def text(found: list[Row], checks: list[Check]) -> str:
    """Returns the page."""
    counts = {family: sum(row.family == family for row in found) for family in ("inclined", "edge", "corner")}
    return _TEXT.format(
        table=TABLE,
        checks_file=CHECKS,
        command=COMMAND,
        headline=headline(found, checks),
        worst_error=_scientific(rows.worst_error(found)),
        strictest=min(stage.RTOLS),
        loosest=max(stage.RTOLS),
        digits=stage.FOUR_DIGITS,
        checks=check_finding(checks),
        widths="\n".join(_widths(found, quantity) for quantity in QUANTITIES),
        **counts,
    )


def check_finding(checks: list[Check]) -> str:
    """Tells how far the field solver's own best values are from the table's."""
    agreeing = sum(check.agrees for check in checks)
    differences = [abs(check.difference) for check in checks]
    cases = len({check.case for check in checks})
    return (
        f"In every {stage.CHECKED_EACH}th set-up, {cases} of them, the field solver computed its best values with estimated errors "
        f"(`{CHECKS}`): {agreeing} of {len(checks)} agree within the sum of both errors; the difference is {_scientific(float(np.median(differences)))} in "
        f"the median and {_scientific(max(differences))} at most."
    )


def _widths(found: list[Row], quantity: str) -> str:
    widths = rows.half_widths(found, quantity)
    return f"| {quantity} | {percent(float(np.median(widths)))} | {percent(float(widths.max()))} |"


def _scientific(value: float) -> str:
    return f"{value:.1e}"
