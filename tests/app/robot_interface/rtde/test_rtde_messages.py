"""RTDE's packages: bytes of the documentation, and whatever else comes."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.robot_interface.rtde.rtde_messages import (
    MOST,
    Level,
    Malformed,
    Package,
    Reader,
    heard_text,
    names,
    packed,
    text_message,
)


def test_packages_are_those_of_the_guide() -> None:
    assert packed(Package.REQUEST_PROTOCOL_VERSION, struct.pack(">H", 2)) == bytes.fromhex("0005560002")
    assert packed(Package.GET_URCONTROL_VERSION) == bytes.fromhex("000376")
    assert packed(Package.START) == bytes.fromhex("000353")
    assert packed(Package.DATA_PACKAGE, b"\1" + struct.pack(">d", 1.0)) == bytes.fromhex("000c5501") + struct.pack(">d", 1.0)


@given(st.lists(st.tuples(st.integers(0, 255), st.binary(max_size=300)), max_size=8), st.integers(1, 7))
def test_packages_come_out_as_they_went_in_however_they_are_cut(packages: list[tuple[int, bytes]], cut: int) -> None:
    data = b"".join(packed(kind, payload) for kind, payload in packages)
    reader, seen = Reader(), []
    for i in range(0, len(data), cut):
        seen += list(reader.feed(data[i : i + cut]))
    assert seen == packages


@pytest.mark.parametrize("size", [0, 1, 2, MOST + 1, 65535])
def test_a_size_that_no_package_has_is_told(size: int) -> None:
    with pytest.raises(Malformed, match=str(size)):
        list(Reader().feed(struct.pack(">HB", size, Package.START)))


@pytest.mark.parametrize("size", [3, MOST])
def test_the_least_and_the_largest_size_are_taken(size: int) -> None:
    assert len(list(Reader().feed(struct.pack(">HB", size, 0) + bytes(size - 3)))) == 1


@pytest.mark.parametrize(
    ("payload", "wanted"),
    [(b"a,b", ["a", "b"]), (b"a,b,", ["a", "b"]), (b" a , ,b", ["a", "b"]), (b"", []), (b",,,", []), (b"a" * 2048, ["a" * 2048])],
)
def test_empty_names_do_not_count(payload: bytes, wanted: list[str]) -> None:
    assert names(payload) == wanted


@pytest.mark.parametrize("payload", [b"a" * 2049, b"\xff"])
def test_a_recipe_that_is_too_long_or_no_text_is_malformed(payload: bytes) -> None:
    with pytest.raises(Malformed):
        names(payload)


def test_text_messages_of_both_versions() -> None:
    assert text_message("hi", Level.WARNING, 2) == packed(ord("M"), b"\2hi\7pendant\2")
    assert text_message("hi", Level.ERROR, 1) == packed(ord("M"), b"\1hi")
    assert len(text_message("x" * 999, Level.INFO, 2)) == 3 + 1 + 255 + 1 + 7 + 1
    assert heard_text(b"\2hi\3abc\1", 2) == "hi"
    assert heard_text(b"\1hi", 1) == "hi"
    assert heard_text(b"", 2) == ""
