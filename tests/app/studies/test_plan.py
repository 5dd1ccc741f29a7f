from typing import Any

import numpy as np
import pytest

from app.files.checked import BadInput
from app.studies.plan import Plan, changed_field, described, session_of
from tests.app.studies.study_fakes import base, plan, study


def test_every_point_meets_every_sample_and_every_seed() -> None:
    made = plan()
    cases = list(made.cases())
    assert made.size == len(cases) == 2 * 2 * 2 * 2
    assert [case.number for case in cases] == list(range(16))
    assert len({case.id for case in cases}) == 16
    assert len({(case.factors, case.seed) for case in cases}) == 16
    assert {case.seed for case in cases} == {0, 1}
    assert {case.factors[0] for case in cases} == {0.0, 1.0}
    assert len({case.factors[1] for case in cases}) == 2


def test_a_run_is_named_by_its_content() -> None:
    same, ids = plan(), [case.id for case in plan().cases()]
    assert [case.id for case in same.cases()] == ids
    other = Plan(study(), base(duration=0.2), "study.yaml")
    assert not {case.id for case in other.cases()} & set(ids)
    measured = plan(measures=[*study().measures[:1]], show=[])
    assert not {case.id for case in measured.cases()} & set(ids)


@pytest.mark.parametrize("sampling", ["random", "sobol", "latin_hypercube"])
def test_samples_fill_their_range_and_are_the_same_for_a_seed(sampling: str) -> None:
    fields: dict[str, Any] = {"sampling": sampling, "samples": 32, "seeds": 1, "show": []}
    drawn = np.array([case.factors[1] for case in plan(**fields).cases()][:32])
    assert -1.4 <= drawn.min() < -1.35
    assert -1.05 < drawn.max() <= -1.0
    assert [case.factors[1] for case in plan(**fields).cases()][:32] == drawn.tolist()
    other = Plan(study(**fields), base(seed=5), "study.yaml")
    assert next(other.cases()).factors[1] != drawn[0]
    if sampling != "random":  # one in each of as many slices
        assert sorted(np.floor((drawn + 1.4) / 0.4 * 32).astype(int).tolist()) == list(range(32))


def test_a_case_makes_its_session() -> None:
    made = plan()
    case = made.case(13)
    session = session_of(made.raw, case.values, case.seed, "s")
    mass, height, sequence = case.factors
    assert (session.payload_true.mass, session.settings["sequence.on"]) == (mass, sequence)
    assert session.posture is not None
    assert session.posture[1] == height
    assert session.seed == case.seed
    assert made.raw["payload_true"]["mass"] == 0.0  # the base is as it was


@pytest.mark.parametrize(
    ("factor", "said"),
    [
        ({"field": "payload_true.weight"}, "payload_true.weight"),
        ({"field": "weight"}, "there is no weight|weight"),
        ({"field": "timeline[3].at"}, r"timeline\[3\].at"),
        ({"field": "settings.sequence.length"}, "sequence.length"),
        ({"field": "duration", "values": [-1.0]}, "duration = '-1.0'|duration = -1"),
        ({"field": "robot", "values": ["ur6"]}, "ur6"),
    ],
)
def test_a_factor_that_does_not_fit_the_session_is_one_line(factor: dict[str, Any], said: str) -> None:
    fields = {"name": "mass", "kind": "list", "values": [1.0], **factor}
    with pytest.raises(BadInput, match=said) as refused:
        plan(factors=[fields], show=[], worst=None)
    assert str(refused.value).startswith("study.yaml")
    assert "\n" not in str(refused.value)


def test_a_changed_study_says_where() -> None:
    ours = described(plan())
    assert changed_field(ours, described(plan())) is None
    assert changed_field(ours, described(plan(samples=4))) == "runs"
    assert changed_field(ours["study"], described(plan(samples=4))["study"]) == "samples"
    moved = described(Plan(study(), base(duration=0.2), "s"))
    assert changed_field(ours, moved) == "study.session.duration"
    assert changed_field({"a": [1, {"b": 2}]}, {"a": [1, {"b": 3}]}) == "a[1].b"
    assert changed_field({"a": 1}, {}) == changed_field({}, {"a": 1}) == "a"


def test_a_hundred_thousand_runs_are_numbers_until_they_are_asked_for() -> None:
    made = plan(samples=12_500, show=[])
    assert made.size == 100_000
    assert made.case(99_999).number == 99_999
