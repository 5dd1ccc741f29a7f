from typing import Any

import numpy as np
import pytest

from app.files.checked import BadInput, convert
from app.studies.factors import AnyFactor, Gridded, Sampled, put


def factor(**fields: Any) -> Any:
    return convert({"name": "f", "field": "duration", **fields}, AnyFactor, "factor")  # type: ignore[arg-type]


def test_ranges_have_both_ends() -> None:
    assert factor(kind="range", **{"from": 0.0, "to": 1.0}, steps=5).points() == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert factor(kind="log_range", **{"from": 0.1, "to": 1000.0}, steps=5).points() == [0.1, 1.0, 10.0, 100.0, 1000.0]


def test_distributions_are_those_of_their_names() -> None:
    share = np.array([0.025, 0.5, 0.975])
    assert factor(kind="uniform", **{"from": 1.0, "to": 3.0}).at(share) == pytest.approx([1.05, 2.0, 2.95])
    assert factor(kind="log_uniform", **{"from": 1.0, "to": 100.0}).at(share)[1] == pytest.approx(10.0)
    assert factor(kind="normal", mean=5.0, deviation=2.0).at(share) == pytest.approx([1.08, 5.0, 8.92], abs=0.01)


def test_kinds_are_told_apart() -> None:
    assert isinstance(factor(kind="list", values=[1]), Gridded)
    assert not isinstance(factor(kind="uniform", **{"from": 0, "to": 1}), Gridded)
    assert isinstance(factor(kind="uniform", **{"from": 0, "to": 1}), Sampled)


@pytest.mark.parametrize(
    ("values", "labels", "shown"),
    [
        ([1, 2.5], None, [1.0, 2.5]),
        ([True, False], None, [True, False]),
        (["on", "off"], None, ["on", "off"]),
        ([True, 1.5], None, ["True", "1.5"]),
        ([{"shape": "ramp"}, [1, 2]], ["a", "b"], ["a", "b"]),
    ],
)
def test_rows_name_the_values_of_a_list(values: list[Any], labels: list[str] | None, shown: list[Any]) -> None:
    made = factor(kind="list", values=values, labels=labels)
    assert made.points() == values
    assert made.shown() == shown
    assert [type(each) for each in made.shown()] == [type(each) for each in shown]


@pytest.mark.parametrize(
    "fields",
    [
        {"kind": "list", "values": []},
        {"kind": "list", "values": [{"a": 1}]},
        {"kind": "list", "values": [1, 2], "labels": ["one"]},
        {"kind": "list", "values": [1, 1.0]},
        {"kind": "range", "from": 1.0, "to": 1.0, "steps": 3},
        {"kind": "range", "from": 0.0, "to": 1.0, "steps": 1},
        {"kind": "log_range", "from": 0.0, "to": 1.0, "steps": 3},
        {"kind": "log_uniform", "from": -1.0, "to": 1.0},
        {"kind": "normal", "mean": 0.0, "deviation": 0.0},
        {"kind": "dice"},
        {"kind": "uniform", "from": 0.0, "to": 1.0, "name": "Not a column"},
    ],
)
def test_what_makes_no_factor_is_refused(fields: dict[str, Any]) -> None:
    with pytest.raises(BadInput):
        factor(**fields)


def test_a_path_leads_into_a_session() -> None:
    raw: dict[str, Any] = {
        "duration": 1.0,
        "payload_true": {"mass": 0.0},
        "timeline": [{"force": [0, 0]}],
        "settings": {"a.b": 1},
    }
    for path, value in {
        "duration": 2.0,
        "payload_true.mass": 3.0,
        "timeline[0].force[1]": 4.0,
        "settings.sequence.period": 5.0,
        "settings.a.b": 6.0,
        "features.FD-9": "off",
    }.items():
        put(raw, path, value)
    assert raw == {
        "duration": 2.0,
        "payload_true": {"mass": 3.0},
        "timeline": [{"force": [0, 4.0]}],
        "settings": {"a.b": 6.0, "sequence.period": 5.0},
        "features": {"FD-9": "off"},
    }


@pytest.mark.parametrize(
    "path",
    ["weight.x", "payload_true.weight.x", "timeline[1].force", "timeline.force", "duration.x", "timeline[0]..x", ""],
)
def test_a_path_that_leads_nowhere_is_refused(path: str) -> None:
    raw: dict[str, Any] = {"duration": 1.0, "payload_true": {"mass": 0.0}, "timeline": [{"force": [0, 0]}]}
    with pytest.raises(KeyError):
        put(raw, path, 1.0)
