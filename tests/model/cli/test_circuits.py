"""The netlist of a Maxwell matrix is the circuit that the matrix describes: ngspice finds the voltages and charges of the elimination."""

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[3]
# rad/s. Capacitors alone have the same voltages at every frequency; at this one a picofarad has 0.01 S, far above what ngspice takes for 0.
FREQUENCY = 1e10


@dataclass
class Conductor:
    """A row of the matrix, and what it is connected to."""

    name: str
    grounded: bool = False
    driven: float | None = None  # V, by a source
    series: float | None = None  # F, between the source and it: a sensor behind its coupling capacitance
    to_ground: float = 0  # F

    @property
    def is_known(self) -> bool:
        return self.grounded or (self.driven is not None and self.series is None)


@dataclass
class Circuit:
    name: str
    matrix: Any  # F, (n, n)
    conductors: list[Conductor]

    @property
    def nodes(self) -> list[int]:
        return [k for k, conductor in enumerate(self.conductors) if not conductor.grounded]

    def text(self) -> str:
        """The input of the program that writes the netlist."""
        rows = [
            f"{conductor.name} {int(conductor.grounded)} {' '.join(repr(float(entry)) for entry in row)}"
            for conductor, row in zip(self.conductors, self.matrix)
        ]
        return "\n".join([f"{self.name} {len(rows)}", *rows, ""])

    def voltages(self) -> Any:
        """The voltages of all conductors, by exact elimination of those that no source sets."""
        known = np.array([conductor.is_known for conductor in self.conductors])
        voltages = np.array([(conductor.driven or 0.0) * conductor.is_known for conductor in self.conductors])
        series = np.array([conductor.series or 0.0 for conductor in self.conductors])
        sources = np.array([conductor.driven or 0.0 for conductor in self.conductors])
        added = series + [conductor.to_ground for conductor in self.conductors]
        if not known.all():
            own = (self.matrix + np.diag(added))[np.ix_(~known, ~known)]
            rest = (series * sources)[~known] - self.matrix[np.ix_(~known, known)] @ voltages[known]
            voltages[~known] = np.linalg.solve(own, rest)
        return voltages

    def source_charges(self) -> dict[int, float]:
        """The charge that each source gives, by conductor (C)."""
        voltages = self.voltages()
        charges = self.matrix @ voltages
        return {
            k: (
                charges[k] + conductor.to_ground * voltages[k]
                if conductor.series is None
                else conductor.series * (conductor.driven - voltages[k])
            )
            for k, conductor in enumerate(self.conductors)
            if conductor.driven is not None
        }


def random_circuit(number: int) -> Circuit:
    """Sensors, guards and floating conductors, some of them shielded from each other, and grounded ones."""
    chance = np.random.default_rng(number)
    size = int(chance.integers(2, 8))
    couplings = 10 ** chance.uniform(-15, -11, (size, size)) * (chance.random((size, size)) < 0.8)
    couplings = np.triu(couplings, 1) + np.triu(couplings, 1).T
    # To infinity; none from inside a housing.
    outward = 10 ** chance.uniform(-14, -11, size) * (chance.random(size) < 0.8)
    # One that cannot lose its charge would have no voltage of its own.
    outward[0] += 1e-13
    couplings[0, 1:] += 1e-14
    couplings[1:, 0] += 1e-14
    matrix = np.diag(couplings.sum(axis=1) + outward) - couplings
    conductors = []
    for k in range(size):
        conductor = Conductor(f"c-{k}", grounded=k > 0 and bool(chance.random() < 0.25))
        if not conductor.grounded and chance.random() < 0.75:
            conductor.driven = float(chance.choice([1.0, 2.5, -0.3]))
            conductor.series = float(10 ** chance.uniform(-13, -10)) if chance.random() < 0.5 else None
        if chance.random() < 0.3:
            conductor.to_ground = float(10 ** chance.uniform(-14, -11))
        conductors.append(conductor)
    return Circuit(f"random{number}", matrix, conductors)


def netlists(text: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [ROOT / "build/bin/circuit_netlists"], input=text, capture_output=True, text=True, check=False
    )


def deck(circuits: list[Circuit]) -> str:
    """A netlist of all circuits, each with its sources."""
    written = netlists("".join(circuit.text() for circuit in circuits))
    assert written.returncode == 0, written.stderr
    lines = ["* all circuits", written.stdout, ".options noopac"]
    for n, circuit in enumerate(circuits):
        lines.append(f"X{n} {' '.join(f'v{n}_{k}' for k in circuit.nodes)} {circuit.name}")
        for k in circuit.nodes:
            conductor = circuit.conductors[k]
            if conductor.driven is not None:
                at = f"v{n}_{k}" if conductor.series is None else f"s{n}_{k}"
                lines.append(f"Vs{n}_{k} {at} 0 dc 0 ac {conductor.driven}")
                if conductor.series is not None:
                    lines.append(f"Cs{n}_{k} {at} v{n}_{k} {conductor.series}")
            if conductor.to_ground:
                lines.append(f"Cg{n}_{k} v{n}_{k} 0 {conductor.to_ground}")
    hertz = FREQUENCY / (2 * np.pi)
    return "\n".join([*lines, f".ac lin 1 {hertz!r} {hertz!r}", ".end", ""])


def solved_by_ngspice(text: str, folder: Path) -> dict[str, complex]:
    """Voltages and currents by their names."""
    (folder / "all.cir").write_text(text)
    done = subprocess.run(
        ["ngspice", "-b", "-n", "-r", "all.raw", "all.cir"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=DEADLINE,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    head, _, values = (folder / "all.raw").read_bytes().partition(b"Binary:\n")
    names = re.findall(r"^\t\d+\t(\S+)\t", head.decode(), re.MULTILINE)
    found = np.frombuffer(values, dtype=np.complex128)
    assert len(found) == len(names), "one frequency"
    return dict(zip(names, map(complex, found)))


def test_ngspice_finds_the_voltages_and_charges_of_a_hundred_random_circuits(tmp_path: Path) -> None:
    circuits = [random_circuit(number) for number in range(100)]
    found = solved_by_ngspice(deck(circuits), tmp_path)
    for n, circuit in enumerate(circuits):
        voltages = circuit.voltages()
        for k in circuit.nodes:
            assert found[f"v({f'v{n}_{k}'})"].real == pytest.approx(voltages[k], rel=1e-6, abs=1e-12), circuit
        for k, charge in circuit.source_charges().items():
            # The current flows into the source; it is the derivative of the charge.
            current = -found[f"i(vs{n}_{k})"]
            assert current.imag / FREQUENCY == pytest.approx(charge, rel=1e-6, abs=1e-21), circuit


def test_couplings_that_are_zero_are_left_out() -> None:
    text = netlists(
        "shielded 3\na 0 2e-12 -0.0 -2e-12\nb 0 0.0 1e-12 -1e-12\nbox 1 -2e-12 -1e-12 3e-12\n"
    ).stdout
    capacitors = [line for line in text.splitlines() if line.startswith("C")]
    assert capacitors == ["C1 a 0 2e-12", "C2 b 0 1e-12"]


def test_names_are_those_that_spice_takes() -> None:
    """Node 0 has the name gnd, too, and the case of letters does not count."""
    rows = [f"{name} 0 " + " ".join("2e-12" if i == j else "0" for j in range(6)) for i, name in enumerate(("gnd", "0", "left-arm", "Left_Arm", "é", "sensor"))]  # fmt: skip
    text = netlists("\n".join(["9 6", *rows, ""])).stdout
    assert ".subckt n9 gnd_2 n0 left_arm Left_Arm_2 n__ sensor\n" in text
    assert "* node left_arm: left-arm\n" in text


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "x 2\na 0 1e-12 nan\nb 0 nan 1e-12\n",
            'the entry of "a" and "b" in the Maxwell matrix is not finite',
        ),
        ("x 1\na 0 inf\n", 'the entry of "a" and "a" in the Maxwell matrix is not finite'),
        ("x 1\na 1 1e-12\n", "all conductors are grounded"),
    ],
)
def test_what_is_no_circuit_is_refused(text: str, told: str) -> None:
    done = netlists(text)
    assert (done.returncode, done.stdout) == (2, "") and told in done.stderr
