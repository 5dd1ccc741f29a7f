"""The record of RTDE's fields: every field has its type and place, and recipes are choices of bytes."""

import struct

import pytest

from app.robot_interface.controller.field_record import BEGIN, FieldRecord
from app.robot_interface.controller.rtde_fields import CONSTANTS, FORMATS, INPUTS, OUTPUTS, SIZES
from tests.items import each_of

STRUCTS = {
    "BOOL": ">?", "UINT8": ">B", "UINT32": ">I", "UINT64": ">Q", "INT32": ">i", "DOUBLE": ">d",
    "VECTOR3D": ">3d", "VECTOR6D": ">6d", "VECTOR6INT32": ">6i", "VECTOR6UINT32": ">6I",
}  # fmt: skip


def test_every_type_has_the_size_of_the_protocol() -> None:
    assert SIZES.keys() == FORMATS.keys() == STRUCTS.keys()
    assert {kind: struct.calcsize(text) for kind, text in STRUCTS.items()} == SIZES


@each_of(OUTPUTS)
def test_a_field_is_told_as_it_was_put(name: str) -> None:
    record, layout = FieldRecord(), STRUCTS[OUTPUTS[name]]
    count = len(struct.unpack(layout, bytes(SIZES[OUTPUTS[name]])))
    values = [(k + 1) % 2 for k in range(count)] if OUTPUTS[name] == "BOOL" else [3 * k + 5 for k in range(count)]
    record.put(name, values if count > 1 else values[0])
    assert record.taken(record.where([name])) == struct.pack(layout, *values)
    assert record.get(name) == (values if count > 1 else values[0])


def test_a_recipe_has_its_fields_in_its_order_and_as_often_as_asked() -> None:
    record = FieldRecord()
    record.put("payload", 2.5)
    record.put("robot_mode", 7)
    names = ["robot_mode", "payload", "robot_mode"]
    assert record.taken(record.where(names)) == struct.pack(">idi", 7, 2.5, 7)
    assert record.taken(record.where([])) == b""


def test_what_the_arm_does_not_have_is_a_constant_and_the_clock_is_past_booting() -> None:
    record = FieldRecord()
    assert CONSTANTS.keys() <= OUTPUTS.keys()
    for name, value in CONSTANTS.items():
        assert record.get(name) == (list(value) if isinstance(value, tuple) else value)
    assert record.get("timestamp") == BEGIN >= 40.0


def test_the_lists_are_those_of_the_documentation() -> None:
    """RTDE guide, and data_package of the UR client library: counts by type."""
    assert len([name for name in OUTPUTS if "register" in name]) == 2 * (2 + 64 + 48 + 48)
    assert len([name for name in INPUTS if "register" in name]) == 2 + 64 + 48 + 48
    assert len([name for name in OUTPUTS if "register" not in name]) == 26 + 28 + 5 + 1 + 7 + 9 + 5 + 3
    assert len([name for name in INPUTS if "register" not in name]) == 13


def test_there_is_no_other_field() -> None:
    with pytest.raises(KeyError):
        FieldRecord().put("actual_r", 0.0)
