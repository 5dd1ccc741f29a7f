"""A small part of benchmarks/script_hostile.py: nothing that a script says or does is a surprise."""

import pytest

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
