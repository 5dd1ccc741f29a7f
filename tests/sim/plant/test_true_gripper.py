"""Parts in a true gripper: gripped, carried, lost, put down (GR-1, GR-2). The arm is the real one, held by its controller."""

import numpy as np
import pytest

from app.files.library import load_tool
from pendant.program.steps import JointMove
from sim.arm.scenario import AnyPart, BoxObject, FreeBox, FreeCylinder, Load, Scenario
from sim.plant.changes import AttachPayload, DriveGripper, DropPayload, MoveObject
from tests.sim.bench import IDLE, Bench

LOW = [-0.0073, -1.2614, 2.2369, -2.5463, -1.5708, -0.0073]  # a two-finger gripper looks down, 3 cm above the table
HIGH = [-0.0073, -1.5361, 2.085, -2.1197, -1.5708, -0.0073]  # 14 cm above that
CUP = [-0.0073, -1.1495, 2.2563, -2.6776, -1.5708, -0.0073]  # as LOW, with a vacuum cup
TABLE = BoxObject(name="table", position=[-0.5, 0.0, -0.075], size=[0.6, 0.9, 0.05])
FULL = DriveGripper(command="close", force=100.0)


def box(mass: float = 1.0, y: float = -0.13, **values: float) -> FreeBox:
    return FreeBox(name="part", position=[-0.45, y, -0.02], size=[0.06, 0.05, 0.06], mass=mass, **values)


def bench(part: AnyPart | None = None, tool: str = "two-finger", posture: list[float] = LOW) -> Bench:
    world = [TABLE] if part is None else [TABLE, part]
    made = Bench(Scenario(mismatch="nominal", tool=load_tool(tool), posture=posture, world=world))
    made.run(0.1)
    return made


def state(made: Bench) -> tuple[str, bool, float]:
    assert made.plant.gripper is not None
    now = made.plant.gripper.state
    return now.held, now.moving, now.opening


def place(made: Bench) -> np.ndarray:
    return made.plant.object_poses()[1, :3].copy()


def test_a_free_part_lies_where_it_is_put() -> None:
    made = bench(FreeCylinder(name="part", position=[-0.45, 0.2, -0.02], radius=0.03, height=0.06, mass=0.1))
    made.run(2.0)
    assert np.allclose(place(made), [-0.45, 0.2, -0.02], atol=1e-4)
    assert not made.plant.touched, "it lies on the table, and touches no arm"


def test_without_parts_nothing_is_added_to_the_model() -> None:
    made = bench()
    assert made.plant.model.nv == made.plant.model.njnt
    assert not any("nowhere" in made.plant.model.geom(k).name for k in range(made.plant.model.ngeom))


def test_fingers_that_close_on_a_part_hold_it_in_their_middle() -> None:
    made = bench(box(y=-0.12))
    made.change(FULL)
    made.run(0.6)
    held, moving, opening = state(made)
    assert (held, moving) == ("part", False)
    assert opening == pytest.approx(0.05, abs=1e-4)
    assert place(made)[1] == pytest.approx(-0.13, abs=1e-3), "pushed there"
    assert made.plant.payload.load.mass == pytest.approx(1.0)


def test_fingers_without_a_part_close_all_the_way() -> None:
    made = bench(box(y=0.2))
    made.change(FULL)
    made.run(0.8)
    assert state(made) == ("", False, 0.0)


def test_a_carried_part_goes_along_and_is_put_down() -> None:
    made = bench(box())
    made.change(FULL, AttachPayload(load=Load(mass=0.0)))
    made.run(0.5)
    before = place(made)
    made.start(JointMove(q=tuple(HIGH), speed=0.4, acceleration=0.4))
    made.run(2.0)
    assert place(made)[2] - before[2] == pytest.approx(0.14, abs=0.01)
    made.start(JointMove(q=tuple(LOW), speed=0.2, acceleration=0.2))
    made.run(3.0)
    made.change(DriveGripper(command="open"))
    made.run(0.7)
    assert state(made) == ("", False, 0.085)
    assert np.allclose(place(made), before, atol=1e-3)
    assert made.plant.payload.load.mass == 0.0


def test_a_grip_that_becomes_too_weak_lets_the_part_fall() -> None:
    made = bench(box(3.0, friction=0.5))
    made.change(FULL)
    made.run(0.5)
    made.start(JointMove(q=tuple(HIGH), speed=0.3, acceleration=0.3))
    made.run(2.5)
    made.change(DriveGripper(force=31.0))
    made.run(0.3)
    assert state(made)[0] == "part", "2 · 0.5 · 31 N are 5 % more than 29.4 N"
    made.change(DriveGripper(force=28.0))
    made.run(0.05)
    assert state(made)[0] == "", "5 % less"
    made.run(1.5)
    assert abs(place(made)[2] + 0.02) < 0.01, "on the table"


def test_a_dropped_payload_takes_the_part_along() -> None:
    made = bench(box())
    made.change(FULL)
    made.run(0.5)
    made.change(DropPayload())
    assert state(made)[0] == ""
    made.run(0.2)
    assert state(made)[0] == "", "it is gripped again only after the gripper has opened"


def test_a_held_part_that_is_put_elsewhere_is_held_no_more() -> None:
    made = bench(box())
    made.change(FULL)
    made.run(0.5)
    made.change(MoveObject(name="part", position=[-0.4, 0.3, -0.02]))
    made.run(0.2)
    assert state(made)[0] == ""
    assert np.allclose(place(made), [-0.4, 0.3, -0.02], atol=1e-3)


def test_a_held_part_that_is_pressed_on_the_table_slides() -> None:
    made = bench(box(friction=0.3))
    made.change(DriveGripper(command="close", force=20.0))
    made.run(0.5)
    lower = [LOW[0], LOW[1] + 0.02, *LOW[2:]]  # a centimetre
    made.start(JointMove(q=tuple(lower), speed=0.05, acceleration=0.1))
    made.run(1.5)
    assert state(made)[0] == "part"
    force = -made.plant.data.xmat[made.plant.flange_body].reshape(3, 3) @ made.plant.flange[:3]
    assert force[2] - 9.81 * 0.925 < 20.0, "friction holds 12 N"


def test_a_cup_lifts_a_part_and_lets_it_go() -> None:
    made = bench(FreeBox(name="part", position=[-0.45, -0.13, -0.035], size=[0.06, 0.06, 0.03], mass=1.0), "vacuum-cup", CUP)
    assert state(made)[0] == ""
    made.change(DriveGripper(command="close"))
    made.run(0.1)
    assert made.plant.gripper is not None
    assert made.plant.gripper.state.held == "part"
    assert made.plant.gripper.state.force == pytest.approx(75.4, abs=0.1), "60 kPa on a disc of 4 cm"
    made.change(DriveGripper(command="open"))
    made.run(0.1)
    assert state(made)[0] == ""


def test_a_cup_that_is_told_to_stop_stays_as_it_is() -> None:
    made = bench(FreeBox(name="part", position=[-0.45, -0.13, -0.035], size=[0.06, 0.06, 0.03], mass=1.0), "vacuum-cup", CUP)
    made.change(DriveGripper(command="stop"))
    made.run(0.1)
    assert state(made)[0] == "", "it did not draw"
    made.change(DriveGripper(command="close"))
    made.run(0.1)
    made.change(DriveGripper(command="stop"))
    made.run(0.1)
    assert state(made)[0] == "part"


def test_fingers_stop_where_they_are_with_the_force_and_speed_that_are_told() -> None:
    made = bench(box(y=0.2))
    made.change(FULL)
    made.run(0.2)
    made.change(DriveGripper(command="stop", force=28.0, speed_share=0.0))
    made.run(0.2)
    _, moving, opening = state(made)
    assert made.plant.gripper is not None
    assert not moving
    assert made.plant.gripper.state.force == 28.0
    made.change(DriveGripper(command="open"))
    made.run(0.1)
    assert state(made)[2] - opening == pytest.approx(0.002, abs=1e-4), "0.1 s at the least speed, 0.02 m/s"


def test_outputs_drive_it_where_only_one_is_on() -> None:
    made = bench(box())
    gripper = made.plant.gripper
    assert gripper is not None
    gripper.wired(0b01)
    made.run(0.5)
    assert state(made)[0] == "part"
    gripper.wired(0b11)
    made.run(0.3)
    assert state(made)[0] == "part", "both on say nothing"
    gripper.wired(0b10)
    made.run(0.3)
    assert state(made)[0] == ""


def test_a_tool_without_a_gripper_cannot_be_driven() -> None:
    made = Bench()
    with pytest.raises(KeyError, match="a gripper"):
        made.change(FULL)


def test_same_ticks_bit_for_bit() -> None:
    one, other = bench(box()), bench(box())
    for made in (one, other):
        made.change(FULL)
        made.run(0.6)
    assert (one.plant.data.qpos == other.plant.data.qpos).all()
    assert one.tick(IDLE).mode is other.tick(IDLE).mode
