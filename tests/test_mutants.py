"""The sum of a mutation run."""

import json
from pathlib import Path

import pytest

from tests.mutants import main, summary

CODES = {
    "pendant.a.x_f__mutmut_1": 1,
    "pendant.a.x_f__mutmut_2": 0,
    "pendant.b.x_g__mutmut_1": 33,
    "pendant.b.x_g__mutmut_2": None,
}


def test_survivors_are_those_that_pass_or_that_no_test_reaches() -> None:
    lines, share = summary(CODES)
    assert share == pytest.approx(2 / 3)
    assert [line.split() for line in lines[:2]] == [["1", "of", "2", "pendant.a"], ["1", "of", "1", "pendant.b"]]
    assert "2 of     3  in all: 66.7 %" in lines[-1]


def test_a_run_that_tried_nothing_is_no_success() -> None:
    with pytest.raises(ValueError, match="no mutant was tried"):
        summary({"pendant.a.x_f__mutmut_1": None})


@pytest.mark.parametrize(("alive", "code"), [(1, 0), (2, 1)])
def test_up_to_a_tenth_may_survive(alive: int, code: int, tmp_path: Path) -> None:
    codes = {f"pendant.a.x_f__mutmut_{k}": int(k >= alive) for k in range(10)}
    (tmp_path / "a.py.meta").write_text(json.dumps({"exit_code_by_key": codes}))
    assert main(tmp_path) == code
