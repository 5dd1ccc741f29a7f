"""The virtual hand's damper on light parts: what it takes away within a tick, and no more."""

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from app.files.library import load_arm
from pendant.tick.modes import TICK
from sim.arm.scenario import Load, Scenario
from sim.plant.applied_touches import DAMPING, STIFFNESS, Hands
from sim.plant.touch import Pull
from sim.plant.true_arm import Plant
from tests.sim.plant.test_true_arm import gravity_torque

Array = NDArray[np.float64]


class Puck:
    """A mass that slides along x, and a hand that pulls it."""

    def __init__(self, mass: float) -> None:
        text = f"""<mujoco><option gravity="0 0 0" timestep="{TICK}" integrator="Euler"/><worldbody>
            <body name="puck"><joint type="slide" axis="1 0 0"/><geom size="0.01" mass="{mass}"/></body></worldbody></mujoco>"""
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.hands = Hands(self.model, self.data, {"puck": self.model.body("puck").id})

    def tick(self, target: float) -> float:
        """Force along x [N]."""
        self.hands.apply((Pull("puck", (0.0, 0.0, 0.0), (target, 0.0, 0.0), 50.0),))
        mujoco.mj_step(self.model, self.data)
        mujoco.mj_forward(self.model, self.data)  # the hand feels where the mass is now, as in the plant
        return self.hands.touched[0][2][0]


@pytest.mark.parametrize(
    ("mass", "damping"),
    [(1.0, DAMPING), (1.001 * DAMPING * TICK, DAMPING), (0.999 * DAMPING * TICK, 0.999 * DAMPING), (0.02, 0.02 / TICK)],
)
def test_the_damping_is_what_takes_a_light_masss_speed_away_within_a_tick(mass: float, damping: float) -> None:
    puck = Puck(mass)
    puck.data.qvel[0] = 0.1
    mujoco.mj_forward(puck.model, puck.data)
    assert puck.tick(0.0) == pytest.approx(-damping * 0.1)


@pytest.mark.parametrize("mass", [0.01, 0.03, 0.1, 1.0])
def test_a_light_mass_is_led_and_does_not_hum(mass: float) -> None:
    puck = Puck(mass)
    puck.data.qvel[0] = 0.1
    forces = [puck.tick(0.02) for _ in range(400)]
    assert puck.data.qpos[0] == pytest.approx(0.02, abs=1e-3)
    assert abs(forces[-1]) < 0.01 * STIFFNESS * 0.02


def test_a_bare_wrist_of_the_lightest_arm_does_not_hum() -> None:
    """At a tool's end, 0.1 m beyond the flange. With the whole damping its swing grew by 4 % a tick."""
    arm = load_arm("ur3e")
    plant = Plant(arm, Scenario(payload_true=Load(mass=0.0), posture=[-0.94, -0.11, 1.69, 1.78, 1.05, 2.49]))
    body = plant.model.body("flange").id
    hold, torque = (0.0, 0.0, 0.1), gravity_torque(plant)
    place = plant.data.xpos[body] + plant.data.xmat[body].reshape(3, 3) @ hold
    target = tuple((place + 0.005).tolist())
    speeds = []
    for _ in range(300):
        plant.advance(torque, (Pull("flange", hold, target, 50.0),))
        speeds.append(plant.qd[4])
    assert np.abs(np.diff(speeds[-100:])).max() < 0.01
