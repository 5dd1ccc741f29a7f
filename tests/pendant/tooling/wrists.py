"""An arm with a wrist for tests: its shape, and estimates of it in a posture."""

import math

import numpy as np

from pendant.tick.estimate import Estimate
from pendant.tick.pose import Pose, flat
from pendant.tooling.arm_shape import ArmShape, Rod
from tests.pendant.estimates import estimate

G = 9.81
A = (0.0, -0.425, -0.392, 0.0, 0.0, 0.0)
D = (0.16, 0.0, 0.0, 0.13, 0.1, 0.1)
ALPHA = (math.pi / 2, 0.0, 0.0, math.pi / 2, -math.pi / 2, 0.0)
NAMES = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
HOME = (0.0, -1.2, 1.5, -1.87, -1.57, 0.0)
RODS = (
    Rod(-1, (0.0, 0.0, 0.05), (0.0, 0.0, 0.07), 0.06),
    Rod(1, (0.0, 0.0, 0.14), (-0.425, 0.0, 0.14), 0.05),
    Rod(2, (0.0, 0.0, 0.01), (-0.392, 0.0, 0.01), 0.04),
    Rod(3, (0.0, 0.0, 0.1), (0.0, 0.0, 0.14), 0.04),
    Rod(4, (0.0, 0.0, 0.07), (0.0, 0.0, 0.11), 0.04),
    Rod(5, (0.0, 0.0, 0.08), (0.0, 0.0, 0.1), 0.03),
)


def behind(k: int) -> Pose:
    """What comes behind joint k: Tz(d) Tx(a) Rx(alpha)."""
    c, s = math.cos(ALPHA[k]), math.sin(ALPHA[k])
    return Pose((A[k], 0.0, D[k]), flat(np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])))


def wrist_arm(*, ranges: float = 6.28, rods: tuple[Rod, ...] = RODS) -> ArmShape:
    """Six joints like those of a UR5e."""
    joints = [Pose(), *(behind(k) for k in range(5))]
    return ArmShape(NAMES, joints, behind(5), rods=rods, ranges=((-ranges, ranges),) * 6, elbow=2)


def placed(
    shape: ArmShape,
    q: np.ndarray,
    *,
    mass: float = 2.0,
    centre: tuple[float, float, float] = (0.0, 0.0, 0.1),
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Estimate:
    """The arm stands in a posture with a load that the controller does not know of, and a sensor with an offset [N]."""
    origins, turns = shape.places(q[None])
    R = turns[0, -1]
    value = estimate(position=origins[0, -1].tolist(), q=q.tolist()).copy()
    value.R_BF = R
    a = R.T @ [0.0, 0.0, G]
    value.w_sensor = np.concatenate([mass * a + offset, np.cross(centre, mass * a)])
    value.F_user = np.concatenate([-(R @ value.w_sensor[:3]), -(R @ value.w_sensor[3:])])
    return value
