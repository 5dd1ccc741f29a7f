"""What was done to a list, in words."""

import msgspec

from pendant.equipment.tools import BARE
from pendant.tick.words import difference

GRIPPER = msgspec.structs.replace(BARE, name="gripper", mass=0.9)


def test_what_was_done_to_a_list_is_said_in_words() -> None:
    heavier = msgspec.structs.replace(GRIPPER, mass=1.0)
    probe = msgspec.structs.replace(GRIPPER, name="probe")
    assert difference([BARE], [BARE, GRIPPER]) == "gripper added"
    assert difference([BARE, GRIPPER], [BARE, heavier]) == "gripper changed"
    assert difference([BARE, GRIPPER], [BARE]) == "gripper deleted"
    assert difference([BARE, GRIPPER], [heavier, probe]) == "1 added, 1 changed, 1 deleted"
    assert difference([BARE, GRIPPER], [GRIPPER, BARE]) == "in another order"
