"""The force on a link as the joints feel it: never more than is there, of the right link, none where nothing touches (RL-3)."""

import numpy as np
import pytest

from app.files.library import load_arm
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING
from pendant.tick.estimate import NO_LINK_FORCE
from sim.arm.scenario import Scenario
from sim.collisions.link_force import LEAST
from sim.exchange.desk import Wishes
from sim.plant.changes import SensorFault
from sim.plant.touch import Push
from sim.simulation import Simulation

OFF = apply(Settings(), {"collision.on": False, "following.on": False})
POSTURE = [0.4, -1.0, 1.2, -1.8, -1.57, 0.3]
"""Elbow up, upper arm and forearm well off the vertical."""
DOWN = 100.0  # [N]


def pushed(part: str, seed: int, *, robot: str = "ur5e", down: float = DOWN, sensed: bool = True) -> Simulation:
    """A standing arm, after the link of a joint was pushed down at that joint's origin for 0.4 s."""
    device = Simulation(load_arm(robot), Scenario(seed=seed, posture=POSTURE), OFF)
    fault = () if sensed else (SensorFault(sensor="force_torque", outage=True),)
    for k in range(350):
        touches = (Push(part, (0.0, 0.0, 0.0), (0.0, 0.0, -down)),) if k >= 150 and down else ()
        device.tick(Wishes(NOTHING, touches, fault if k == 0 else ()))
    return device


@pytest.mark.parametrize("seed", [2, 3])
@pytest.mark.parametrize("robot", ["ur5e", "ur16e"])
@pytest.mark.parametrize(("part", "joint"), [("elbow", 1), ("wrist_1", 2)])
def test_the_link_is_named_and_the_force_is_never_more_than_it_is(robot: str, part: str, joint: int, seed: int) -> None:
    link = pushed(part, seed, robot=robot).estimate.link_force
    assert link.joint == joint
    assert LEAST < link.force <= DOWN
    assert link.twisted <= joint
    assert link.torque != 0.0


def test_a_force_that_needs_one_torque_alone_is_told_as_large_as_that_torque_over_its_lever() -> None:
    """At the elbow, straight down, joint 2 bears it all: tau = F r, of which the model's deviations are taken off."""
    device = pushed("elbow", 2)
    link = device.estimate.link_force
    elbow, shoulder = device.estimate.elbow[:3], device.dynamics.recursion.origins[1]
    across = float(np.hypot(*(elbow - shoulder)[:2]))
    lever = float(np.linalg.norm(elbow - shoulder))
    assert link.twisted == 1
    assert abs(link.torque) <= DOWN * across
    assert link.force == pytest.approx(abs(link.torque) / lever, rel=0.1)


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_an_arm_that_nothing_touches_feels_none(seed: int) -> None:
    assert pushed("elbow", seed, down=0.0).estimate.link_force is NO_LINK_FORCE


def test_a_force_on_the_tool_is_the_flange_sensors_while_it_is_there() -> None:
    with_sensor, without = pushed("tool", 2).estimate, pushed("tool", 2, sensed=False).estimate
    assert with_sensor.link_force is NO_LINK_FORCE
    assert without.link_force.force > LEAST
    assert without.link_force.joint > 2


def test_the_end_of_the_sensors_range_is_told() -> None:
    assert not pushed("tool", 2, down=60.0).estimate.clipped
    assert pushed("tool", 2, down=150.0).estimate.clipped
