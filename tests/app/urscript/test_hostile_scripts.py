"""A small part of benchmarks/script_hostile.py: nothing that a script says or does is a surprise."""

import gc

import pytest

from app.urscript.language import tree
from app.urscript.language.reading import read_script
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running import script_runner
from benchmarks.script_hostile import Course, damaged, hostile


@pytest.fixture(scope="module")
def course() -> Course:
    return Course()


def test_damaged_programs_end_with_a_place_or_run(course: Course) -> None:
    for text in damaged(150, seed=1):
        ended = course.run(text, 5)
        assert ended.surprise == "", text
        assert not ended.error or ended.error.startswith("line "), text


@pytest.mark.parametrize("text", list(hostile(12)), ids=lambda text: text[:30].replace("\n", "|"))
def test_programs_that_ask_for_all_there_is_are_ended_with_a_message(course: Course, text: str) -> None:
    ended = course.run(text, 560)
    assert ended.surprise == ""
    assert ended.error.startswith("line ") or not ended.over


@pytest.mark.parametrize("text", ["x = 1", "x = ("])
def test_no_garbage_is_looked_for_while_a_script_is_read(course: Course, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each look would stop every thread, and a long script makes many objects to be looked at."""
    seen: list[bool] = []

    def read(offered: str) -> list[tree.Node]:
        seen.append(gc.isenabled())
        return read_script(offered)

    monkeypatch.setattr(script_runner, "read_script", read)
    try:
        course.runner.offer(text)
    except ScriptTrouble:
        assert text.endswith("(")
    assert seen == [False]
    assert gc.isenabled()
