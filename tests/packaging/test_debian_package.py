"""The Debian package: what it says of itself and what is in it. `clean_root`, beside this file, installs and uses it."""

import subprocess
from pathlib import Path

import pytest

from tests.packaging.test_install import BUILD, ROOT
from tests.waiting import DEADLINE

pytestmark = pytest.mark.night


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("package")
    subprocess.run(["cpack", "-B", folder], cwd=BUILD, check=True, capture_output=True, timeout=DEADLINE)
    return next(folder.glob("fringe_*_*.deb"))


@pytest.fixture(scope="module")
def fields(package: Path) -> dict[str, str]:
    """The fields of the package's control file; descriptions by their first line."""
    said = subprocess.run(["dpkg-deb", "-f", package], capture_output=True, text=True, check=True).stdout
    return dict(
        line.split(": ", 1) for line in said.splitlines() if ": " in line and not line.startswith(" ")
    )


@pytest.fixture(scope="module")
def files(package: Path) -> dict[str, str]:
    """Path → permissions and owner of every file."""
    said = subprocess.run(["dpkg-deb", "-c", package], capture_output=True, text=True, check=True).stdout
    lines = [line.split() for line in said.splitlines()]
    return {line[5].removeprefix("."): f"{line[0]} {line[1]}" for line in lines}


def test_it_depends_on_the_libraries_and_the_python_it_was_built_with(fields: dict[str, str]) -> None:
    for needed in (
        "libfmt9",
        "libmeshoptimizer2d",
        "libsleef3",
        "libtbb12",
        "libtomlplusplus3",
        "libc6",
        "libassimp5",
    ):
        assert needed in fields["Depends"]
    for needed in ("libocct-data-exchange-7.6", "libpugixml1v5", "liburdfdom-model3.0", "zlib1g"):
        assert needed in fields["Depends"]
    assert "python3 (>= 3.11), python3 (<< 3.12~), python3-numpy" in fields["Depends"]
    assert "python3-dolfinx" in fields["Recommends"]


def test_it_says_what_it_is(fields: dict[str, str]) -> None:
    assert fields["Package"] == "fringe"
    assert fields["Section"] == "science"
    assert fields["Maintainer"] and fields["Description"]


def test_its_copyright_is_the_licence_of_the_repository() -> None:
    """Paragraph by paragraph: Debian's format indents them and marks empty lines by a point."""
    copyright_file = (ROOT / "model/package/copyright").read_text(encoding="utf-8")
    stated = " ".join(word for word in copyright_file.split() if word != ".")
    title, owner, *paragraphs = (ROOT / "LICENSE").read_text(encoding="utf-8").split("\n\n")
    assert title == "BSD 3-Clause License" and "License: BSD-3-Clause" in stated
    assert (
        owner == "Copyright (c) 2026, the fringe authors" and "Copyright: 2026 the fringe authors" in stated
    )
    assert all(" ".join(paragraph.split()) in stated for paragraph in paragraphs)


@pytest.mark.parametrize(
    "path",
    [
        "/usr/bin/fringe",
        "/usr/bin/fringe-analysis",
        "/usr/bin/fringe-geometries",
        "/usr/bin/fringe-reference",
        "/usr/include/fringe/scene_reader.hpp",
        "/usr/lib/cmake/fringe/fringe-config.cmake",
        "/usr/lib/libfringe.a",
        "/usr/lib/pkgconfig/fringe.pc",
        "/usr/libexec/fringe/fringe-import",
        "/usr/share/bash-completion/completions/fringe",
        "/usr/share/doc/fringe/copyright",
        "/usr/share/fringe/analysis/__main__.py",
        "/usr/share/fringe/analysis/report/static/page.css",
        "/usr/share/fringe/analysis/report/templates/page.html",
        "/usr/share/fringe/fem_reference/__main__.py",
        "/usr/share/fringe/geometries/studies/default.toml",
        "/usr/share/man/man1/fringe.1.gz",
        "/usr/share/zsh/vendor-completions/_fringe",
    ],
)
def test_it_holds(files: dict[str, str], path: str) -> None:
    assert path in files


def test_the_python_module_is_where_every_python_of_debian_looks(files: dict[str, str]) -> None:
    assert [path for path in files if path.startswith("/usr/lib/python3/dist-packages/fringe.cpython-311")]


def test_everything_is_roots_and_in_usr_and_nothing_is_compiled_or_left_over(files: dict[str, str]) -> None:
    for path, kind in files.items():
        assert kind.endswith("root/root")
        assert path.startswith("/usr/")
        assert "__pycache__" not in path and ".mypy_cache" not in path
