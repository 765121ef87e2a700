"""The sensor's voltage divider and its delta output (thesis 5.3.5 and chapter 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.results.answers import Estimate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Divider:
    """`coupling` is the upper capacitor and `own` the sensor's capacitance without objects (F); `voltage` is the input (V)."""

    coupling: float
    own: float
    voltage: float

    def output(self, capacitance: Array) -> Array:
        """Returns V_in·C_c/(C_c + C_own + C), in V, for the capacitances C that nearby objects add (F)."""
        return np.asarray(self.voltage * self.coupling / (self.coupling + self.own + capacitance))

    def delta_output(self, capacitance: Array) -> Array:
        """Returns the output without objects minus the output with the objects (V), which the thesis plots."""
        base = self.coupling + self.own
        return np.asarray(self.voltage * self.coupling * capacitance / (base * (base + capacitance)))


def reference_delta_output(own: Estimate, delta_self: Estimate, coupling: float, voltage: float) -> Estimate:
    """Returns the delta output (V) of a sensor whose own capacitance and whose change are known with errors (F).

    The absolute contributions of the two errors are added, to first order.
    """
    divider = Divider(coupling, own.value, voltage)
    base = coupling + own.value
    near = base + delta_self.value
    by_change = voltage * coupling / near**2
    by_own = voltage * coupling * abs(1 / near**2 - 1 / base**2)
    value = float(divider.delta_output(np.array([delta_self.value]))[0])
    return Estimate(value, by_change * delta_self.error + by_own * own.error)
