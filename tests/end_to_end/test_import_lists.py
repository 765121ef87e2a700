"""`fringe import` of lists of FastCap and FasterCap: conductors by name become electrodes; what is damaged is refused with file and line."""

from pathlib import Path

import numpy as np
import pytest

from geometries.scene import reader
from tests.end_to_end.importing import area, assert_refused, fringe_import, imported

# A unit square in z = 0, as one quadrilateral and as two triangles.
SQUARE = "0 A unit square\n* of one panel\nQ 1  0 0 0  1 0 0  1 1 0  0 1 0\n"
HALVES = "0 the same\nT 1  0 0 0  1 0 0  1 1 0\nT 1  0 0 0  1 1 0  0 1 0\n"
TRIANGLES = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)


def written(folder: Path, text: str, **files: str) -> Path:
    """A list, and files of panels by their names."""
    for name, content in {"square": SQUARE, "halves": HALVES, **files}.items():
        (folder / f"{name}.qui").write_text(content)
    path = folder / "x.lst"
    path.write_text(text)
    return path


def test_every_file_is_a_group_of_conductors_moved_by_its_offset(tmp_path: Path) -> None:
    scene = imported(written(tmp_path, "* two squares\nC square.qui 1 0 0 0\n\nC halves.qui 1.0 2 0 -1e-1\n"))
    found = scene.conductors()
    # As FastCap names what has one name in two groups.
    assert list(found) == ["1%GROUP1", "1%GROUP2"]
    assert found["1%GROUP1"] == pytest.approx(TRIANGLES)
    assert found["1%GROUP2"] == pytest.approx(TRIANGLES + [2, 0, -0.1])
    assert [body.potential for body in scene.objects] == ["electrode", "electrode"]
    assert scene.medium.relative_permittivity == 1


def test_files_joined_by_a_plus_are_one_group_in_their_medium(tmp_path: Path) -> None:
    scene = imported(written(tmp_path, "C square.qui 2.5 0 0 0 +\nc halves.qui 2.5 0 0 1\n"))
    found = scene.conductors()
    assert list(found) == ["1"]
    assert found["1"] == pytest.approx(np.concatenate([TRIANGLES, TRIANGLES + [0, 0, 1]]))
    assert scene.medium.relative_permittivity == 2.5


def test_conductors_have_the_names_that_they_are_given(tmp_path: Path) -> None:
    """By N in a file of panels, and by G for a group; a name that only one group has stands alone."""
    renamed = SQUARE + "Q 2  0 0 1  1 0 1  1 1 1  0 1 1\nN 1 plate\nN 2 plate%\n"
    merged = SQUARE + "Q 2  0 0 1  1 0 1  1 1 1  0 1 1\nn 1 2\n"
    path = written(
        tmp_path,
        "* names\nG left\nC square.qui 1 0 0 0\nG right\nC square.qui 1 3 0 0 +\nC square.qui 1 6 0 0\n"
        "C renamed.qui 1 0 0 9\nC merged.qui 1 0 0 12\n",
        renamed=renamed,
        merged=merged,
    )
    counts = {name: len(triangles) for name, triangles in imported(path).conductors().items()}
    assert counts == {"1%left": 2, "1%right": 4, "plate": 2, "plate%": 2, "2": 4}


def test_files_may_be_nested_and_stand_in_the_list_itself(tmp_path: Path) -> None:
    """As FasterCap has them; what follows End and is not in a file within the file does not count."""
    path = written(
        tmp_path,
        "* one file\nC pair 1 0 0 5\nEnd\nT 1 no panel\nFile pair\n* two\nC inner 1 1 0 0\nC square.qui 1 0 1 0\nEnd\n"
        "F inner\nT 7  0 0 0  1 0 0  0 1 0\n",
    )
    found = imported(path).conductors()
    assert found["7"] == pytest.approx(np.array([[[1, 0, 5], [2, 0, 5], [1, 1, 5]]]))
    assert found["1"] == pytest.approx(TRIANGLES + [0, 1, 5])


def test_a_file_of_panels_is_a_list_of_its_own(tmp_path: Path) -> None:
    """Panels may be followed by a reference point or a charge, and the first line is a title or a statement."""
    path = tmp_path / "panels.qui"
    path.write_text(
        "T a  0 0 0  1 0 0  0 1 0  5 5 5\n# a comment\nQ b 0 0 1 1 0 1 1 1 1 0 1 1 1.5e-12\n% another\n"
    )
    assert {name: len(triangles) for name, triangles in imported(path).conductors().items()} == {
        "a": 1,
        "b": 2,
    }


def test_a_quadrilateral_is_divided_inside_it(tmp_path: Path) -> None:
    """The diagonal from the second corner to the fourth one is the one inside this arrowhead."""
    path = written(tmp_path, "C arrow.qui 1 0 0 0\n", arrow="0\nQ 1  0 0 0  2 1 0  0 2 0  1 1 0\n")
    assert area(imported(path).conductors()["1"]) == pytest.approx(1)


def test_dielectric_interfaces_are_left_out_with_a_warning(tmp_path: Path) -> None:
    text = "C square.qui 1 0 0 0\nD missing.qui 1 3 0 0 0 0 0 9 -\nB halves.qui 1 3 0 0 1 0 0 9 +-\nC square.qui 1 0 0 2\n"
    path = written(tmp_path, text)
    done = fringe_import(path, tmp_path / "scene.toml")
    assert done.stderr.splitlines() == [
        f"fringe: warning: {path}:2: a dielectric interface is left out, as if the medium of the conductors were everywhere",
        f"fringe: warning: {path}:3: the dielectric interface on which a conductor lies is left out, as if its outer medium were everywhere",
    ]
    # FastCap numbers interfaces, too; B is joined with the last file.
    found = {
        name: len(triangles) for name, triangles in reader.load(tmp_path / "scene.toml").conductors().items()
    }
    assert found == {"1%GROUP1": 2, "1%GROUP3": 4}


C = "C square.qui 1 0 0 0\n"
# Nine files within the list, each of which includes the next one ten times.
_NESTED = (
    "C f0 1 0 0 0\n" + "".join(f"File f{n}\n" + f"C f{n + 1} 1 0 0 0\n" * 10 for n in range(9)) + "File f9\n"
)


WRONG = {
    "no z": ("C square.qui 1.0 0 0\n", "x.lst:1: has x and y only, as two-dimensional lists do"),
    "no z but a +": ("* t\nC square.qui 1.0 0 0 +\n", "x.lst:2: has x and y only, as two-dimensional lists do"),
    "no file": ("* t\nC nothing.qui 1 0 0 0\n", "x.lst:2: the file {folder}/nothing.qui does not exist"),
    "no number": ("* t\nC square.qui 1 0 0 zero\n", "x.lst:2: holds 'zero' instead of a finite number"),
    "not finite": ("* t\nC square.qui 1 0 0 nan\n", "x.lst:2: holds 'nan' instead of a finite number"),
    "beyond numbers": ("* t\nC square.qui 1 0 0 1e999\n", "x.lst:2: holds '1e999'"),
    "too short": ("C square.qui 1 0\n", "x.lst:1: ends too early; it must be C FILE PERMITTIVITY X Y Z"),
    "permittivity": ("* t\nC square.qui 0 0 0 0\n", "x.lst:2: has the permittivity 0"),
    "complex": ("* t\nC square.qui 3-j0.1 0 0 0\n", "x.lst:2: has the complex permittivity 3-j0.1"),
    "statement": (C + "Z 1 2 3\n", "x.lst:2: begins with 'Z', which is no statement"),
    "two-dimensional": ("* 2D\nS 1 0 0 1 1\n", "x.lst:2: is a segment of a two-dimensional list"),
    "two media": (C + "C halves.qui 2 0 0 1\n", "x.lst:2: the conductor is in a medium of permittivity 2, that of"),
    "itself": ("* t\nC x.lst 1 0 0 0\n", "x.lst:2: the file x.lst includes itself"),
    "a circle": ("* t\nC a 1 0 0 0\nFile a\nC b 1 0 0 0\nFile b\nC a 1 0 0 0\n", "x.lst:6: the file a includes itself"),
    "twice": ("* t\nC a 1 0 0 0\nFile a\nFile a\n", "x.lst:4: begins the file 'a' again"),
    "nothing": ("* t\n", "x.lst: holds no panels of conductors"),
    "dielectrics alone": ("* t\nD square.qui 1 3 0 0 0 0 0 9\n", "x.lst: holds no panels of conductors"),
    "multiplying": (_NESTED, "there are more than 100000 included files"),
    "deep": ("".join(f"* t\nC f{n} 1 0 0 0\nFile f{n}\n" for n in range(200)) + "C square.qui 1 0 0 0\n", "to a depth of"),
}  # fmt: skip
@pytest.mark.parametrize(("text", "told"), WRONG.values(), ids=WRONG)
def test_a_damaged_list_is_refused(tmp_path: Path, text: str, told: str) -> None:
    assert_refused(written(tmp_path, text), told.format(folder=tmp_path))


@pytest.mark.parametrize(
    ("panels", "told"),
    [
        ("0 title\nT 1 0 0 0 1 0 0 0 1 0\nT 1 0 0 0 1 0 0 0..1 1 0\n", "3: holds '0..1' instead of a finite number"),
        ("0 title\nQ 1 0 0 0 1 1 0 1 0 0 0 1 0\n", "2: has corners that do not follow each other"),
        ("0 title\nQ 1 0 0 0 1 1 0\n", "2: ends too early; it must be Q CONDUCTOR and the coordinates of four"),
        ("0 title\nN 9 8\n", "2: there is no conductor '9' to be renamed"),
        ("25 0 0 1\nPATRAN\n", "2: the file seems to be a neutral file of PATRAN, which is not read"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_file_of_panels_is_told_with_its_line(
    tmp_path: Path, panels: str, told: str
) -> None:
    path = written(tmp_path, "C panels.qui 1 0 0 0\n", panels=panels)
    done = fringe_import(path, tmp_path / "new" / "scene.toml")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"fringe: {tmp_path}/panels.qui:{told}") and not (tmp_path / "new").exists()
