"""The times that a check prints are those of its steps and of its slowest tests."""

from pathlib import Path

from tests import times

PYTEST = """<testsuites><testsuite>
<testcase classname="tests.a.test_b" name="test_slow" time="12.25"/>
<testcase classname="tests.a.test_b" name="test_quick" time="0.5"/>
</testsuite></testsuites>"""
CTEST = '<testsuite><testcase classname="Gjk" name="Gjk" time="3.5"/></testsuite>'


def test_steps_add_up_and_tests_of_all_files_are_ordered(tmp_path: Path) -> None:
    (tmp_path / "steps.tsv").write_text("70\tBuild\n5\tForm: black\n")
    (tmp_path / "pytest.xml").write_text(PYTEST)
    (tmp_path / "ctest.xml").write_text(CTEST)
    assert times.text(tmp_path).splitlines() == [
        "",
        "Seconds of each step",
        "      70  Build",
        "       5  Form: black",
        "      75  together",
        "",
        "Seconds of the 3 slowest tests",
        "    12.2  pytest: tests.a.test_b.test_slow",
        "     3.5  ctest: Gjk",
        "     0.5  pytest: tests.a.test_b.test_quick",
    ]


def test_a_check_that_ended_early_tells_what_there_is(tmp_path: Path) -> None:
    assert times.text(tmp_path).splitlines() == ["", "Seconds of each step", "       0  together"]
    (tmp_path / "pytest.xml").write_text(PYTEST[:40])
    assert times.slowest(tmp_path, 40) == []
