"""The language as its manual and clients' programs show it: each row of conformance.yaml is a program with its result."""

import re
from pathlib import Path

import pytest
import yaml

from tests.app.urscript.script_bench import ScriptBench

ROWS = yaml.safe_load((Path(__file__).parent / "conformance.yaml").read_text(encoding="utf-8"))
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


@pytest.fixture(scope="module")
def bench() -> ScriptBench:
    return ScriptBench()


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['source']}: {row['run'][:40]}".replace("\n", "|"))
def test_a_program_does_what_its_source_says(bench: ScriptBench, row: dict) -> None:
    told, error = bench.run(row["run"])
    assert error == row.get("error", "")
    expected = row.get("tells", told)
    assert [NUMBER.sub("#", text) for text in told] == [NUMBER.sub("#", text) for text in expected]
    numbers = [float(n) for text in told for n in NUMBER.findall(text)]
    wanted = [float(n) for text in expected for n in NUMBER.findall(text)]
    assert numbers == pytest.approx(wanted, abs=row.get("within", 1e-6))


def test_most_programs_have_a_source() -> None:
    assert len(ROWS) >= 150
    assert sum(row["source"] != "ours" for row in ROWS) >= 100
