"""Which part a contact meets: the one whose shapes explain the torques of all joints, two where both do (RL-3)."""

import numpy as np
import pytest

from app.files.library import load_arm
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING
from pendant.safety.collision import SURE
from sim.arm.scenario import Scenario
from sim.collisions.hit_parts import PARTS, hit_parts, hit_shapes
from sim.exchange.desk import Wishes
from sim.simulation import Simulation

OFF = apply(Settings(), {"collision.on": False, "following.on": False})
POSTURE = [0.4, -1.0, 1.2, -1.8, -1.57, 0.3]
"""Elbow up, upper arm and forearm well off the vertical."""
ELBOW, FOREARM, WRIST = range(PARTS)
FORCE = 80.0  # [N]


class Felt:
    """A standing arm whose joints are made to feel the torques of a force."""

    def __init__(self, robot: str = "ur5e") -> None:
        self.arm = load_arm(robot)
        self.device = Simulation(self.arm, Scenario(seed=2, posture=POSTURE), OFF)
        for _ in range(100):
            self.device.tick(Wishes(NOTHING, (), ()))
        self.rigid, self.momentum = self.device.dynamics.recursion, self.device.estimator.momentum
        self.still = self.momentum.residual.copy()

    def odds(self, shape: int, share: float, direction: np.ndarray, error: float = 0.0) -> tuple[float, float, float]:
        """Of a force in this direction (3,), in axes of the link, at a place of a shape's segment, with so many deviations."""
        hull = self.arm.shapes[shape]
        own = self.rigid.record[0]
        R, start, end = own["turns"][hull.link], np.array(hull.start), np.array(hull.end)
        p, f = own["origins"][hull.link] + R @ (start + share * (end - start)), FORCE * (R @ direction)
        self.momentum.residual[:] = self.still
        for i in range(hull.link + 1):
            self.momentum.residual[i] += own["jacobian"][3:, i] @ np.cross(p - own["origins"][i], f)
        self.momentum.residual[:] += error * self.momentum.doubt
        models = self.rigid.record, self.momentum.record, self.momentum.errors.record
        return hit_parts(models, hit_shapes(self.arm), FORCE)


def test_the_probabilities_are_of_one_part() -> None:
    odds = Felt().odds(7, 0.5, np.array([0.0, 1.0, 0.0]))
    assert sum(odds) == pytest.approx(1.0)


@pytest.mark.parametrize("error", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("robot", ["ur3e", "ur5e", "ur10e", "ur16e"])
def test_a_force_across_the_middle_of_a_link_is_most_likely_that_links(robot: str, error: float) -> None:
    """Shapes 4 and 7 are the tubes of upper arm and forearm, across which is the link's y; a force on 12 turns wrist 1."""
    felt = Felt(robot)
    assert felt.odds(4, 0.8, np.array([0.0, 1.0, 0.0]), error)[ELBOW] > SURE
    forearm = felt.odds(7, 0.5, np.array([0.0, 1.0, 0.0]), error)
    assert forearm[ELBOW] < 1.0 - SURE
    assert forearm[WRIST] < forearm[FOREARM]
    assert felt.odds(12, 0.5, np.array([0.0, 0.0, 1.0]), error)[WRIST] > SURE


@pytest.mark.parametrize("around", [0.0, 1.0, 2.0, 4.0])
def test_the_housing_of_wrist_1_is_never_ruled_out_although_no_joint_beyond_the_elbow_feels_it(around: float) -> None:
    """A force through the axis of wrist 1 turns base, shoulder and elbow alone, as one on the forearm does."""
    odds = Felt().odds(9, 0.5, np.array([np.cos(around), np.sin(around), 0.0]))
    assert odds[WRIST] > 0.05
    assert odds[ELBOW] < 0.5


def test_a_shape_may_be_a_ball() -> None:
    felt = Felt()
    felt.odds(9, 0.5, np.array([0.0, 1.0, 0.0]))
    models = felt.rigid.record, felt.momentum.record, felt.momentum.errors.record
    shapes = hit_shapes(felt.arm)
    shapes["way"] = 0.0
    odds = hit_parts(models, shapes, FORCE)
    assert sum(odds) == pytest.approx(1.0)
    assert min(odds) >= 0.0


def test_an_arm_without_shapes_tells_no_part() -> None:
    felt = Felt()
    felt.odds(4, 0.8, np.array([0.0, 1.0, 0.0]))
    models = felt.rigid.record, felt.momentum.record, felt.momentum.errors.record
    shapes = hit_shapes(felt.arm)
    shapes["count"] = 0
    assert hit_parts(models, shapes, FORCE) == (0.0, 0.0, 0.0)
