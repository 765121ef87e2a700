"""The tables and phrases that the experiments' sections share."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from analysis.report import page
from analysis.results.units import CENTIMETRE, PICOFARAD, signed_percent
from analysis.topics.experiments.calibration import Calibration, Summary, summary
from analysis.topics.experiments.curves import DISTANCE, Curve


def calibrations(found: Sequence[Calibration], curve: Curve) -> Markup:
    """Returns a table of the calibrated constants and of the residuals of each calibration."""
    header = [
        "tuned",
        "coupling (pF)",
        "ε",
        "misfit",
        "rms (mV)",
        "worst",
        "at",
        "worst while observable",
        "at",
    ]
    rows = [
        [
            each.form.name,
            _coupling(each),
            _constant(each, each.permittivity.value, each.permittivity.error),
        ]
        + [_misfit(each), *figures(summary(curve, each.predict(curve), curve), DISTANCE)]
        for each in found
    ]
    return page.table(header, rows)


def predictions(
    labelled: Sequence[tuple[str, Curve]], tunings: Sequence[Calibration], flat: Curve, swept: str
) -> Markup:
    """Returns a table of the deviations of each calibration on each curve."""
    header = ["curve", "tuned", "rms (mV)", "worst", "at", "worst while observable", "at"]
    rows = [
        [name, each.form.name, *figures(summary(curve, each.predict(curve), flat), swept)]
        for name, curve in labelled
        for each in tunings
    ]
    return page.table(header, rows, text_columns=2)


def figures(found: Summary, swept: str) -> list[str]:
    """Returns the cells: rms, worst, where, worst while observable, where."""
    return [
        f"{1000 * found.rms:.3g}",
        signed_percent(found.worst),
        place(found.worst_at, swept),
        signed_percent(found.observable) if found.is_observable else "",
        place(found.observable_at, swept) if found.is_observable else "",
    ]


def place(at: float, swept: str) -> str:
    """Writes a distance in cm or an angle in degrees."""
    return f"{at / CENTIMETRE:.3g} cm" if swept == DISTANCE else f"{at:.3g}°"


def plate(curve: Curve) -> str:
    """Writes the target's size."""
    return size(curve.target_size)


def size(lengths: tuple[float, float]) -> str:
    """Writes lengths in metres as centimetres."""
    x, y = lengths
    return f"{x / CENTIMETRE:.3g} cm × {y / CENTIMETRE:.3g} cm"


def constants(found: Calibration) -> str:
    """Writes the calibrated constants as part of a sentence."""
    if not found.determined:
        return "constants that the curve does not determine"
    coupling, permittivity = found.coupling, found.permittivity
    text = f"ε = {permittivity.value:.3g} ± {permittivity.error:.1g}"
    if not found.form.counts_own:
        return text
    return f"a coupling capacitance of {coupling.value / PICOFARAD:.3g} ± {coupling.error / PICOFARAD:.1g} pF and {text}"


def _coupling(found: Calibration) -> str:
    if not found.form.counts_own:
        return f"{found.coupling.value / PICOFARAD:.3g} (held)"
    return _constant(found, found.coupling.value / PICOFARAD, found.coupling.error / PICOFARAD)


def _constant(found: Calibration, value: float, error: float) -> str:
    return f"{value:.3g} ± {error:.2g}" if found.determined else "not determined"


def _misfit(found: Calibration) -> str:
    return f"{found.misfit:.3g} error bars" if found.form.by_error_bars else f"{1000 * found.misfit:.3g} mV"
