"""A copy of the project in which the reference and the model answer at once: the commands are the real ones, in processes of
their own, every solve is written down, and two solves of a case at the same time."""

import os
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from tests import scenes
from tests.analysis.synthetic import HEAD
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[3]
REFERENCE = """
import fcntl, json, os, sys, time, tomllib
from pathlib import Path
from tests.analysis.documents import empty_document, reference_document
case = Path(sys.argv[1]).parent.name
Path("locks").mkdir(exist_ok=True)
lock = open(f"locks/{case}{'.slice' if '--slice' in sys.argv else ''}", "w")
try:
    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
except BlockingIOError:
    with open("twice_at_once.txt", "a") as log:
        log.write(case + "\\n")
if "TOY_SECONDS" in os.environ:
    time.sleep(float(os.environ["TOY_SECONDS"]))
scene = tomllib.loads(Path(sys.argv[1]).read_text())
height = scene["object"][0]["translation"][2] if "object" in scene else None
if "--slice" in sys.argv:
    if "TOY_SLICES_FAIL" in os.environ:
        sys.exit(1)
    plane = {"origin": [0, 0], "direction": [1, 0], "along": [-0.1, 0.1], "z": [-0.1, 0.1], "potential": [[0, 1], [1, 0]]}
    Path(sys.argv[sys.argv.index("--slice") + 1]).write_text(json.dumps(plane))
    sys.exit(0)
if height == float(os.environ.get("TOY_FAILS_AT", "nan")):
    sys.exit("cannot mesh this")
mutual = 2 if height is None else 1e-2 / height + float(os.environ.get("TOY_SHIFT", "0"))
document = empty_document() if height is None else reference_document(mutual, mutual / 2)
with open("solved.txt", "a") as log:
    log.write(case + "\\n")
if height == float(os.environ.get("TOY_SHORT_AT", "nan")):
    document["reached"] = False
print(json.dumps(document))
sys.exit(0 if document["reached"] else 3)
"""
"""Stands in for the reference's module: it answers at once, unless the environment says that it fails or falls short of what was asked where the
target is at a height, and writes down which cases it has solved."""
MODEL = """
import os
import numpy as np
from tests.analysis.documents import boundary_document, model_document
from contextlib import nullcontext as InterruptionScope
__version__ = "toy"
def plate_integral(triangles, corner, edge_u, edge_v):
    return np.ones(len(triangles))
class Scene:
    @staticmethod
    def load(path):
        return Scene()
    def capacitance(self, method):
        return {"readings": [], **model_document(1.8)["methods"][method]}
    def maxwell(self, rtol):
        mutual = os.environ.get("TOY_BOUNDARY")
        if mutual is None:
            raise ValueError("a toy knows no boundary elements")
        answer = boundary_document(float(mutual), float(mutual) / 2)
        return answer | {name: np.array(answer[name]) for name in ("maxwell", "error")}
"""
"""Stands in for the model's module."""


class ToyRepository:
    """`folder` may hold spaces; `count` cases of parallel plates."""

    def __init__(self, folder: Path, count: int) -> None:
        self.folder = folder
        self.results = folder / "results" / "synthetic"
        for name in ("analysis", "fem_reference", "geometries"):
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", "*.png"))
        for name, text in {
            "fem_reference/__init__.py": "",
            "fem_reference/__main__.py": REFERENCE,
            "build/python/fringe.py": MODEL,
            "tests/analysis/documents.py": (ROOT / "tests/analysis/documents.py").read_text(),
        }.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text)
        self.ask(count)

    def ask(self, count: int) -> None:
        """Have so many cases in the study."""
        sweep = scenes.sweep("parallel", gap={"linspace": [0.01, 0.08, count]})
        (self.folder / "study.toml").write_text(HEAD + sweep)

    def make_writing_slower(self) -> None:
        """Has each write take longer between its end and its renaming: a killed writer's file is seldom met by chance."""
        files = self.folder / "geometries" / "common" / "files.py"
        written = files.read_text()
        # Not time.sleep, which libfaketime breaks.
        pause = '        __import__("select").select([], [], [], 0.02)\n'
        slower = written.replace("        os.replace(", f"{pause}        os.replace(")
        assert slower != written
        files.write_text(slower)

    def start(
        self,
        command: str,
        *options: str,
        prefix: tuple[str, ...] = (),
        before: Callable[[], None] | None = None,
        **variables: str,
    ) -> subprocess.Popen[str]:
        """`python3 -m analysis COMMAND` with the study, in a session of its own, after a prefix and what the process is to do before."""
        return subprocess.Popen(
            [*prefix, sys.executable, "-m", "analysis", command, "study.toml", *options],
            cwd=self.folder,
            env=os.environ | {"CI": "true"} | variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            preexec_fn=before,
        )

    def run(self, command: str, *options: str, **variables: str) -> subprocess.CompletedProcess[str]:
        process = self.start(command, *options, **variables)
        output, errors = process.communicate(timeout=DEADLINE)
        return subprocess.CompletedProcess(process.args, process.returncode, output, errors)

    def table(self) -> str:
        return (self.results / "table.csv").read_text()

    def answers(self) -> set[str]:
        """The cases that have an answer of the reference."""
        return {path.parent.name for path in self.results.glob("cases/*/fem.json")}

    def solved(self) -> Counter[str]:
        """How often each case was solved to its end."""
        log = self.folder / "solved.txt"
        return Counter(log.read_text().split()) if log.is_file() else Counter()

    def solved_twice_at_once(self) -> list[str]:
        """The cases that one solve was begun of while another was not at its end."""
        log = self.folder / "twice_at_once.txt"
        return log.read_text().split() if log.is_file() else []
