"""The examples of the gallery run as they stand, and show what they say."""

import ast
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tools import gallery


def numbers(said: str) -> list[float]:
    return [float(each) for each in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?", said)]


SHOWS: dict[str, Callable[[str, list[float]], bool]] = {
    "01": lambda said, found: found[0] == found[1] > 0,
    "02": lambda said, found: said.startswith("FREE_DRIVE") and found[0] > 10.0,
    "03": lambda said, found: 30.0 < found[0] < 70.0,  # it is pushed with 50 N
    "04": lambda said, found: found[1] - found[0] == pytest.approx(3.0, abs=0.02),  # the restart period
    "05": lambda said, found: found[1] == pytest.approx(2.0, abs=0.5),  # it carries 2 kg
    "06": lambda said, found: list(ast.literal_eval(said.partition(":")[2].strip()).values())[::3] == [100.0, 0.0, 100.0],
    "07": lambda said, found: found[0] < found[1],  # with, and without
    "08": lambda said, found: found[0] < 30.0,  # the push rises for 30 ms
    "09": lambda said, found: found[1] < 0.5 * found[0],
    "10": lambda said, found: said.endswith("True"),
    "11": lambda said, found: found[0] < found[2],  # with, and without; between them the 20 ms
    "12": lambda said, found: found[0] == pytest.approx(-3.0, abs=0.3),  # 3 kg were held
    "13": lambda said, found: {7.0, 0.8} <= set(found),  # joints, payload, reach
}
"""What an example is about, in what it said and the numbers therein."""


@pytest.mark.parametrize("example", gallery.EXAMPLES, ids=lambda path: path.stem)
def test_an_example_of_the_gallery_shows_what_it_says(example: Path, tmp_path: Path) -> None:
    shown = gallery.show(example, tmp_path)
    assert 0 < len(shown.title) <= 50
    assert shown.code.startswith("import")
    assert "<svg" in shown.picture.read_text()
    assert SHOWS[example.stem[:2]](shown.said, numbers(shown.said)), shown.said
    assert shown.code in gallery.page([shown]).replace("\n    ", "\n")


def test_the_examples_are_numbered_without_a_gap() -> None:
    assert [int(example.stem[:2]) for example in gallery.EXAMPLES] == list(range(1, len(gallery.EXAMPLES) + 1))


@pytest.mark.parametrize(
    ("code", "says"),
    [("raise SystemExit('no')", "no"), ("", "no picture"), ("import sys\nsys.stderr.write('late')", "late")],
)
def test_an_example_that_fails_is_named(tmp_path: Path, code: str, says: str) -> None:
    example = tmp_path / "99_fails.py"
    example.write_text(code)
    with pytest.raises(RuntimeError, match=f"99_fails.py: {says}"):
        gallery.show(example, tmp_path / "out")
