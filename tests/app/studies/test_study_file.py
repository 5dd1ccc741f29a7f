import re
from pathlib import Path
from typing import Any

import msgspec
import pytest

from app.files.checked import BadInput
from app.studies.plan import Plan
from app.studies.study_file import open_study, studies
from tests.app.studies.study_fakes import FIELDS, study

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("quick", [True, False])
@pytest.mark.parametrize("name", studies())
def test_a_bundled_study_makes_a_plan(name: str, quick: bool) -> None:
    made, base = open_study(name, quick=quick)
    size = Plan(made, base, name).size
    assert 20 <= size <= (400 if quick else 5000)
    assert made.show
    assert made.worst is not None


def test_the_study_of_the_guide_makes_a_plan(tmp_path: Path) -> None:
    block = re.search(r"```yaml\n(.*?)```", (ROOT / "docs" / "guide" / "studies.md").read_text(), re.DOTALL)
    assert block is not None
    (tmp_path / "mine.yaml").write_text(block[1])
    made, base = open_study(str(tmp_path / "mine.yaml"))
    assert Plan(made, base, "mine.yaml").size == 7 * 2 * 32 * 2


def test_there_are_four() -> None:
    assert studies() == ["contact-delay", "friction-temperature", "letting-go", "sequence-limit"]


def test_quick_takes_what_the_file_says(tmp_path: Path) -> None:
    fewer = {"seeds": 1, "factors": {"mass": {**FIELDS["factors"][0], "values": [3.0]}}}
    (tmp_path / "s.yaml").write_bytes(msgspec.yaml.encode({**FIELDS, "quick": fewer}))
    (whole, base), (quick, _) = (open_study(str(tmp_path / "s.yaml"), quick=each) for each in (False, True))
    assert (whole.seeds, quick.seeds, quick.samples) == (2, 1, 2)
    assert msgspec.to_builtins(quick.factors[0])["values"] == [3.0]
    assert (base.title, base.seed) == ("t", 0)
    assert open_study(str(tmp_path / "s.yaml"), seed=7)[1].seed == 7


def test_a_session_is_a_bundled_one_or_a_file_beside_the_study(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text("title: own\nduration: 1.0\n")
    for name, title in (("own.yaml", "own"), ("hold", None)):
        (tmp_path / "s.yaml").write_bytes(msgspec.yaml.encode({**FIELDS, "session": name}))
        found = open_study(str(tmp_path / "s.yaml"))[1].title
        assert found == title or (title is None and found)


def test_a_name_that_is_no_study_is_one_line() -> None:
    with pytest.raises(BadInput, match="bundled studies: contact-delay"):
        open_study("no-such-study")


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"measures": []}, "measures"),
        ({"factors": [FIELDS["factors"][0], FIELDS["factors"][0]]}, "the name mass is there twice"),
        ({"measures": [{"name": "seed", "measure": "passed"}], "show": [], "worst": None}, "seed"),
        ({"show": [{"show": "curve", "of": "weight", "over": "mass"}]}, "no measure is called weight"),
        ({"show": [{"show": "curve", "of": "way", "over": "weight"}]}, "no factor is called weight"),
        ({"worst": {"of": "weight"}}, "no measure is called weight"),
        ({"quick": {"factors": {"weight": FIELDS["factors"][0]}}}, "no factor is called weight"),
        ({"show": [{"show": "roc", "of": "way", "over": "mass", "right": "mass", "at_least": 1.0, "at_most": 1.0}]}, "at_most"),
        ({"measures": [{"name": "way", "measure": "happens", "kinds": ["explosion"]}]}, "no event is called explosion"),
        ({"measures": [{"name": "way", "measure": "value", "of": "friction_error"}]}, "joint goes with"),
        ({"measures": [{"name": "way", "measure": "log", "of": "state.weight"}]}, "no state.weight"),
        ({"samples": 0}, "samples"),
    ],
)
def test_what_makes_no_study_is_one_line(fields: dict[str, Any], said: str) -> None:
    with pytest.raises(BadInput, match=said) as refused:
        study(**fields)
    assert "\n" not in str(refused.value)
