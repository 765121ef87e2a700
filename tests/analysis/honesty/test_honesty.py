"""How stated errors are judged, on answers that are made up. Two small scenes asked in earnest, what is kept of them, and what the
command makes of its options.

Random scenes: every kind can be read, a seed stands for one scene; closed forms against ten digits of other formulas, in 30 digits."""

from __future__ import annotations

import math
import os
import random
from pathlib import Path

import numpy as np
import pytest

from analysis import __main__ as command_line
from analysis.honesty import judging, kinds, run, scenes
from analysis.honesty.asking import (
    ANSWERED,
    ENDED,
    FIELD_SOLVER,
    FINER,
    LATE,
    METHODS,
    REFUSED,
    Answer,
    Stated,
    Worker,
)
from analysis.honesty.judging import CLOSED_FORM, ITSELF, Judged, Record, Unjudged, judged
from analysis.honesty.kinds import KINDS, Drawn, drawn
from analysis.results.answers import Estimate
from geometries.scene import reader
from geometries.scene.scene import Scene


EACH = 6


def all_drawn(kind: str, folder: Path) -> list[Drawn]:
    first, step = list(KINDS).index(kind), len(KINDS)
    return [kinds.drawn(seed, folder) for seed in range(first, first + EACH * step, step)]


def scenes_of(kind: str, folder: Path) -> list[Scene]:
    return [reader.loads(each.text) for each in all_drawn(kind, folder)]


@pytest.mark.parametrize("kind", KINDS)
def test_a_seed_stands_for_a_scene_that_can_be_read(kind: str, tmp_path: Path) -> None:
    for made in all_drawn(kind, tmp_path):
        assert made.kind == kind and made == kinds.drawn(made.seed, tmp_path)
        scene = reader.loads(made.text)
        assert bool(made.truths) == (kind == "closed-forms")
        assert made.has_readings == bool(scene.sensors or scene.readings)
        finer = reader.loads(made.finer)
        assert [body.name for body in finer.objects] == [body.name for body in scene.objects]


def test_seeds_are_those_of_the_kinds() -> None:
    chosen = kinds.seeds(20, frozenset({"plates", "robots"}))
    found = [next(chosen) for _ in range(4)]
    assert min(found) >= 20 and {kinds.kind_of(seed) for seed in found} == {"plates", "robots"}


def test_kinds_have_what_they_are_named_for(tmp_path: Path) -> None:
    permittivities = [
        body.relative_permittivity
        for scene in scenes_of("insulators", tmp_path)
        for body in scene.objects
        if body.relative_permittivity is not None
    ]
    assert len(permittivities) == EACH and max(permittivities) > 1e3
    assert all(scene.links and scene.sensors for scene in scenes_of("robots", tmp_path))
    assert not any(scene.sensors for scene in scenes_of("no-sensors", tmp_path))
    assert all(
        any(body.potential == "floating" for body in scene.objects)
        for scene in scenes_of("floating", tmp_path)
    )
    assert all(
        any(reading.sense not in reading.drive for reading in scene.readings)
        for kind in ("guards", "transmit")
        for scene in scenes_of(kind, tmp_path)
    )
    assert all(
        any(body.conductor in ("front", "beside") for body in scene.objects)
        for scene in scenes_of("covers", tmp_path)
    )


def test_every_closed_form_is_drawn(tmp_path: Path) -> None:
    for form in kinds.FORMS:
        known = form(random.Random(3), tmp_path)
        assert known.truths and all(each.error < 1e-2 * abs(each.value) for each in known.truths.values())


def test_what_is_revolved_is_closed_and_faces_outwards() -> None:
    triangles = scenes.revolved([(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)], 96)
    a, b, c = (triangles[:, corner] for corner in range(3))
    volume = float(np.sum(np.cross(a, b) * c) / 6)
    assert volume == pytest.approx(2 * np.pi, rel=1e-2)


DIGITS = 1e-10
KNOWN = {
    "a ball": (kinds.of_ellipsoid(1, 1, 1), 1.0),
    "a disc": (kinds.of_ellipsoid(1, 1, 0), 2 / math.pi),
    "a flat ellipsoid": (kinds.of_ellipsoid(1, 1, 0.01), 0.6406666189),
    "a long ellipsoid": (kinds.of_ellipsoid(1, 0.01, 0.01), 0.1887306192),
    "an ellipsoid of three axes": (kinds.of_ellipsoid(3, 2, 1), 1.9660092007),
    "two balls, nearly touching": (kinds.of_two_spheres(1, 1, 0.01), (2.1366708264, 2.1366708264, -1.4427860423)),
    "two balls, one larger": (kinds.of_two_spheres(1, 2, 0.5), (1.3448794651, 2.5029295041, -0.7963687577)),
    "two balls, one smaller": (kinds.of_two_spheres(1, 0.25, 0.03), (1.3270916837, 0.4670894056, -0.3861651604)),
    "two discs": (kinds.of_coaxial_discs(1, 0.5), (1.0503333101, -0.6555369923)),
    "two near discs": (kinds.of_coaxial_discs(1, 0.1), (3.1095575189, -2.7684040781)),
    "two larger discs": (kinds.of_coaxial_discs(2, 0.2), tuple(2 * c for c in kinds.of_coaxial_discs(1, 0.1))),
    "a bowl": (kinds.of_bowl(1, math.pi / 3), 0.6089977810),
    "a bowl that is closed": (kinds.of_bowl(1, math.pi), 1.0),
    "a bowl that is flat": (kinds.of_bowl(1e5, 1e-5), 2 / math.pi),
    "a layer": (kinds.of_coated_sphere(1, 1.1, 3), 1.0645161290),
    "a layer of no thickness": (kinds.of_coated_sphere(1, 1, 3), 1.0),
    "a layer of the medium": (kinds.of_coated_sphere(1, 2, 1), 1.0),
    "a layer as good as metal": (kinds.of_coated_sphere(1, 2, 1e12), 2.0),
    "two balls that cross": (kinds.of_crossing_spheres(1, 1), 2 - 1 / math.sqrt(2)),
    "a ball with a speck": (kinds.of_crossing_spheres(1, 1e-11), 1.0),
}  # fmt: skip


@pytest.mark.parametrize("name", KNOWN)
def test_closed_forms_have_the_digits_of_other_formulas_and_the_limits_that_are_known(name: str) -> None:
    found, expected = KNOWN[name]
    assert found == pytest.approx(expected, abs=DIGITS)


@pytest.mark.parametrize(("a", "b", "gap"), [(1, 1, 0.5), (1, 0.3, 0.1), (1, 3, 1)])
def test_an_insulator_is_nothing_or_floats_at_the_ends_of_permittivity(
    a: float, b: float, gap: float
) -> None:
    own, other, between = kinds.of_two_spheres(a, b, gap)
    assert kinds.beside_insulator(a, b, gap, 1) == pytest.approx(a, abs=DIGITS)
    floating = own - between**2 / other
    assert kinds.beside_insulator(a, b, gap, 1e15) == pytest.approx(floating, abs=1e-9)


CHANGE, VALUE = "front: change", "front: value"


def record(
    value: float | None,
    error: float | None,
    method: str = "formula",
    truth: tuple[float, float] | None = None,
    field: tuple[float, float] | None = None,
    finer: tuple[float, float] | None = None,
    quantity: str = CHANGE,
    by: str = "",
) -> Record:
    """One answer, in F, and what it is held against."""
    answers = {method: Answer(ANSWERED, 1.0, values={quantity: Stated(value, error, by)})}
    for name, known in ((FIELD_SOLVER, field), (FINER, finer)):
        if known is not None:
            answers[name] = Answer(ANSWERED, 1.0, values={quantity: Stated(*known)})
    return Record(7, "plates", {quantity: Estimate(*truth)} if truth else {}, answers)


def only(made: Record, method: str = "formula") -> Judged | Unjudged:
    (found,) = judged(made, method)
    return found


@pytest.mark.parametrize(
    ("error", "truth", "ratio", "width"),
    [
        pytest.param(0.1, (1.05, 0.0), 0.5, 2, id="it holds"),
        pytest.param(0.1, (1.22, 0.02), 2, None, id="the error of the reference is forgiven"),
        pytest.param(0.1, (1.5, 0.09), 4.1, None, id="a contradiction is judged by any reference"),
        pytest.param(0.0, (1.1, 0.0), math.inf, None, id="an error of nothing has to be right"),
    ],
)
def test_an_error_is_held_against_the_true_one(
    error: float, truth: tuple[float, float], ratio: float, width: float | None
) -> None:
    found = only(record(1.0, error, truth=truth))
    assert isinstance(found, Judged) and found.by == CLOSED_FORM
    assert found.ratio == pytest.approx(ratio) and found.is_held == (ratio <= 1)
    assert found.width == (None if width is None else pytest.approx(width))


@pytest.mark.parametrize(("error", "truth"), [(0.1, (1.0, 0.09)), (0.0, (1.0, 0.0))])
def test_a_reference_that_is_not_accurate_enough_judges_nothing(
    error: float, truth: tuple[float, float]
) -> None:
    assert only(record(1.0, error, truth=truth)) == Unjudged("plates", "formula", False)


def test_the_most_independent_reference_that_is_accurate_enough_judges() -> None:
    known = {"truth": (1.0, 0.0), "field": (1.01, 0.001), "finer": (1.02, 0.001)}
    by = []
    while known:
        found = only(record(1.0, 0.1, **known))  # type: ignore[arg-type]
        assert isinstance(found, Judged)
        by.append(found.by)
        known.pop(next(iter(known)))
    assert by == [CLOSED_FORM, FIELD_SOLVER, FINER]
    found = only(record(1.0, 0.1, field=(1.0, 0.08), finer=(1.0, 0.01)))
    assert isinstance(found, Judged) and found.by == FINER


@pytest.mark.parametrize(
    ("method", "by"), [("boundary-elements:1e-2", ""), ("auto:1e-2", "boundary-elements")]
)
def test_boundary_elements_that_judge_themselves_are_called_so(method: str, by: str) -> None:
    found = only(record(1.0, 0.1, method, finer=(1.0, 0.01), by=by), method)
    assert isinstance(found, Judged) and found.by == ITSELF


def test_the_field_solver_is_not_held_against_itself() -> None:
    assert isinstance(only(record(1.0, 0.1, FIELD_SOLVER), FIELD_SOLVER), Unjudged)


def test_what_is_not_known_is_no_answer_and_what_a_method_never_knows_is_nothing() -> None:
    unknown = Unjudged("plates", "formula", True)
    assert only(record(1.0, None, truth=(1.0, 0.0))) == unknown
    assert only(record(None, None, truth=(1.0, 0.0))) == unknown
    assert list(judged(record(None, None, quantity=VALUE), "formula")) == []


def test_rows_count_and_tell_what_misses_the_target() -> None:
    made = [record(1.0, 0.1, truth=(1.05, 0.0)) for _ in range(18)]
    (row, _) = judging.rows(made, ["formula"])
    assert row.held == 1 and judging.misses([row]) == []
    made += [record(1.0, 0.1, truth=(1.15, 0.0)) for _ in range(2)]
    (row, whole) = judging.rows(made, ["formula"])
    assert row.held == pytest.approx(0.9) and row.worst == pytest.approx(1.5)
    assert judging.misses([row, whole]) == [row]


def test_one_error_of_many_that_is_exceeded_too_much_misses_the_target() -> None:
    made = [record(1.0, 0.1, truth=(1.05, 0.0)) for _ in range(99)] + [record(1.0, 0.1, truth=(1.4, 0.0))]
    found = judging.rows(made, ["formula"])
    assert judging.misses(found) == [found[0]]
    text = judging.text(found, "show")
    assert "| formula | plates | 100 | 100 | 100 | 99.0 % | 4 | 2 | 0 | 0 | 0 | 0 |  | missed |" in text
    assert "seed 7, plates, formula: front: change" in text and "is missed by 1 of 1" in text


def test_guesses_of_the_time_are_right_within_a_factor_of_two() -> None:
    guesses = (0.4, 0.6, 1.9, 2.1, None)
    made = [Record(k, "plates", {}, {"auto:1e-2": Answer(ANSWERED, guess=g)}) for k, g in enumerate(guesses)]
    found = judging.rows(made, ["auto:1e-2"])
    assert found[0].guessed == 0.5 and "| 0 | 0 | 0 | 50 % |  |" in judging.text(found, "show")


def test_refusals_are_told_with_their_most_frequent_reason() -> None:
    reasons = (REFUSED, "gap of 3 mm"), (REFUSED, "gap of 4 mm"), (REFUSED, "has a room"), (LATE, "")
    made = [
        Record(k, "plates", {}, {"formula": Answer(*outcome[:1], 1.0, outcome[1])})
        for k, outcome in enumerate(reasons)
    ]
    text = judging.text(judging.rows(made, ["formula"]), "show")
    assert "* formula, 2: gap of # mm" in text
    assert "| formula | plates | 4 | 0 | 0 |  |  |  | 0 | 3 | 1 | 0 |  |  |" in text
    assert "target is met" in text


def test_a_process_that_ends_misses_the_target() -> None:
    found = judging.rows([Record(1, "plates", {}, {"formula": Answer(ENDED, 1.0, "signal 11")})], ["formula"])
    assert judging.misses(found) == [found[0]]


QUICK = {"method": "reduced"}
PLATES = 0


def go_on() -> None:
    """Nothing stops the tests."""


class Ends:
    """Ends the process that reads it."""

    def __reduce__(self) -> tuple[object, tuple[int]]:
        return os._exit, (3,)


def test_a_worker_answers_refuses_and_survives_what_ends_its_process(tmp_path: Path) -> None:
    scene = drawn(PLATES, tmp_path)
    with Worker() as worker:
        answer = worker.ask(scene.text, scene.has_readings, QUICK, 60, go_on)
        assert answer.outcome == ANSWERED and answer.values["front: change"].error
        refused = worker.ask(scene.text, scene.has_readings, {"method": "none"}, 60, go_on)
        assert refused.outcome == REFUSED and "none" in refused.reason
        ended = worker.ask(scene.text, scene.has_readings, {"method": Ends()}, 60, go_on)
        assert ended.outcome == ENDED and "status 3" in ended.reason
        assert worker.ask(scene.text, scene.has_readings, QUICK, 60, go_on).outcome == ANSWERED


def test_what_takes_too_long_has_no_answer(tmp_path: Path) -> None:
    scene = drawn(list(KINDS).index("robots"), tmp_path)
    with Worker() as worker:
        assert worker.ask(scene.text, True, METHODS["boundary-elements:1e-2"], 1e-3, go_on).outcome == LATE


def test_two_scenes_are_asked_for_once(tmp_path: Path) -> None:
    asked = run.options("plates,closed-forms", "reduced:1e-2,auto:1e-2", scenes=2, jobs=1)
    league = run.run(tmp_path, asked)
    before = (tmp_path / judging.FILE).read_text()
    assert league.path.read_text() == league.text
    assert set(judging.load(tmp_path)) == {0, list(KINDS).index("closed-forms")}
    assert {row.method for row in league.rows if row.judged} == {"reduced:1e-2", "auto:1e-2"}
    assert {row.method for row in league.rows if row.guesses} == {"auto:1e-2"}
    assert run.run(tmp_path, asked).text == league.text
    assert (tmp_path / judging.FILE).read_text() == before


def test_an_unfinished_line_is_left_out(tmp_path: Path) -> None:
    (tmp_path / judging.FILE).write_text('{"seed": 1, "ki')
    assert judging.load(tmp_path) == {}


def test_every_option_of_the_command_acts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "field_answer", lambda *_: Answer(REFUSED, 0.0, "not today"))
    place = ["--results", str(tmp_path), "--methods", "reduced:1e-2", "--no-field-solver", "--seconds", "60"]
    few = ["--scenes", "1", "--first", "1", "--kinds", "plates", "--jobs", "1"]
    status = command_line.main(["honesty", *place, *few])
    told = capsys.readouterr().out
    assert f"table: {tmp_path / run.TABLE}" in told and "| reduced:1e-2 | plates | 1 |" in told
    assert status in (0, 1)
    assert set(judging.load(tmp_path)) == {len(KINDS)}
    field = ["--results", str(tmp_path), "--methods", "field-solver", "--field-solver", "1"]
    command_line.main(["honesty", *field, *few])
    assert "* field-solver, 1: not today" in capsys.readouterr().out
    assert command_line.main(["honesty", *place, "--only", "0"]) == 0
    told = capsys.readouterr().out
    assert "# seed 0: plates" in told and "[[sensor]]" in told and "reduced:1e-2: answered" in told


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--kinds", "plates,none"], "'none' is none of plates"),
        (["--methods", "exact"], "'exact' is none of formula"),
        (["--field-solver", "2"], "'2' is not a number between 0 and 1"),
        (["--field-solver", "1", "--no-field-solver"], "not allowed with"),
        (["--scenes", "0"], "'0' is not a whole number greater than 0"),
        (["--only", "-1"], "'-1' is not a whole number of at least 0"),
    ],
)
def test_a_wrong_option_is_refused(
    words: list[str], reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        status = command_line.main(["honesty", "--results", str(tmp_path), *words])
    except SystemExit as end:
        status = end.code  # type: ignore[assignment]
    assert status == 2 and reason in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
