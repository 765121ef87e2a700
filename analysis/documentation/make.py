"""`python3 -m analysis documentation`: makes one site of the notes, the algorithms' pages and the references of Python and C++."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from geometries.common.children import ending_with_this, temporary_folder
from geometries.common.installation import ROOT, is_installed

HERE = Path(__file__).parent
_MADE_BY_SPHINX = ".buildinfo"


class DocumentationError(Exception):
    """A tool refused a page; the message is the tool's."""


def build(folder: Path) -> Path:
    """Makes the site in a folder, which is replaced as a whole if it holds one; returns its first page. Raises DocumentationError
    for any warning, and for a folder that holds something else."""
    if is_installed():
        raise DocumentationError("the notes are not installed: make the site in the repository")
    if folder.exists() and not (folder / _MADE_BY_SPHINX).is_file():
        raise DocumentationError(f"{folder} exists and is not a site that could be replaced")
    folder.parent.mkdir(parents=True, exist_ok=True)
    with temporary_folder(folder.parent) as unfinished:
        site = unfinished / "site"
        _run(
            [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"]
            + ["-d", str(unfinished / "doctrees"), "-c", str(HERE), str(ROOT), str(site)]
        )
        own = site / "analysis" / "documentation"
        _run(["doxygen", str(HERE / "Doxyfile")], FRINGE_DOCUMENTATION=str(own))
        shutil.rmtree(folder, ignore_errors=True)
        site.rename(folder)
    return folder / "analysis" / "documentation" / "index.html"


def _run(command: list[str], **variables: str) -> None:
    done = subprocess.run(
        ending_with_this(command), cwd=ROOT, capture_output=True, text=True, env={**os.environ, **variables}
    )
    if done.returncode != 0:
        raise DocumentationError(f"{Path(command[0]).name}: {done.stderr.strip() or done.stdout.strip()}")
