"""Describes this machine: what determines run times and the instruction set that the model chooses."""

import platform
from pathlib import Path
from typing import Any

_CPUINFO = Path("/proc/cpuinfo")
# The instruction sets that the model has vector code for, from wide to narrow.
_INSTRUCTION_SETS = {"avx512f": "AVX-512", "avx2": "AVX2"}


def description() -> dict[str, str]:
    """Describes the machine for people."""
    models = _values("model name")
    return {
        "processor": models[0] if models else platform.machine(),
        "cores": str(len(models)),
        "system": platform.system() + " " + platform.release(),
        "python": platform.python_version(),
    }


def instruction_sets() -> str:
    """Returns the wide instruction sets that the processor has."""
    found = [name for flag, name in _INSTRUCTION_SETS.items() if flag in _flags()]
    return ", ".join(found) or "neither AVX-512 nor AVX2"


def identity() -> dict[str, str]:
    """Returns what makes two machines different where run times count: name, processor, instructions."""
    flags = " ".join(sorted(_flags()))
    return {"name": platform.node(), "processor": description()["processor"], "flags": flags}


def _flags() -> set[str]:
    return set(next(iter(_values("flags")), "").split())


def _values(name: str) -> list[str]:
    """Returns the values under a name, one for each core."""
    lines = _CPUINFO.read_text(encoding="utf-8").splitlines()
    return [line.split(":", 1)[1].strip() for line in lines if line.partition(":")[0].strip() == name]


def origin() -> dict[str, Any]:
    """Describes the machine that a stored measurement was made on."""
    return {"processor": description()["processor"], "instruction_sets": instruction_sets()}
