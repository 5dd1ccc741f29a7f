"""True forces on tool and links: what a held part bears is borne by the tool."""

import numpy as np
import pytest

from app.files.library import load_tool
from pendant.program.steps import JointMove
from sim.arm.scenario import BoxObject, FreeBox, Scenario
from sim.exchange.true_forces import true_forces
from sim.plant.changes import DriveGripper
from tests.sim.bench import Bench

LOW = [-0.0073, -1.2614, 2.2369, -2.5463, -1.5708, -0.0073]  # the gripper looks down, 3 cm above the table
TABLE = BoxObject(name="table", position=[-0.5, 0.0, -0.075], size=[0.6, 0.9, 0.05], stiffness=2e4)
PART = FreeBox(name="part", position=[-0.45, -0.13, -0.02], size=[0.06, 0.05, 0.06], mass=1.0, friction=0.6)


def lowered(made: Bench, angle: float) -> np.ndarray:
    """What the flange bears (3,) in W [N], after the shoulder has gone to this angle beyond LOW [rad]."""
    made.start(JointMove(q=(LOW[0], LOW[1] + angle, *LOW[2:]), speed=0.05, acceleration=0.1))
    made.run(1.5)
    return made.plant.data.xmat[made.plant.flange_body].reshape(3, 3) @ made.plant.flange[:3]


def test_a_held_part_that_is_pressed_on_the_table_is_a_force_on_the_tool() -> None:
    made = Bench(Scenario(mismatch="nominal", tool=load_tool("two-finger"), posture=LOW, world=[TABLE, PART]))
    made.run(0.1)
    made.change(DriveGripper(command="close"))
    made.run(0.5)
    free = lowered(made, -0.02)
    assert true_forces(made.plant) == (0.0, 0.0), "in the air nothing touches it"
    pressed = lowered(made, 0.004)
    assert made.plant.gripper is not None
    assert made.plant.gripper.state.held == "part"
    on_tool, on_link = true_forces(made.plant)
    assert on_tool > 10.0
    assert on_tool == pytest.approx(float(np.linalg.norm(pressed - free)), rel=0.05), "what the true flange bears less"
    assert on_link == 0.0
