"""The force of a contact with a link, by the torques that the joints feel and the model does not explain (RL-3).

A force f at a point that is |l_i| away from joint i's axis makes the torque tau_i <= |l_i| |f| there, and none in the joints
beyond the link that it meets. So the last joint that feels a torque moves that link; and whatever the direction, the force is at
least max_i |tau_i| / |l_i|, over the joints up to that one and the lever of the link's far end.

Friction of a joint that stands may hold a part of a torque that the motor's current tells, up to its breakaway torque, and twice
that of a change: what is more than this is compared with the noise.

Before an arm has moved, its gears and encoders may make larger torques than a contact. They change little, so the change since
nothing was touched is looked at as well, and the larger of the two counts.

Source: Haddadin, De Luca, Albu-Schaeffer, Robot Collisions: A Survey on Detection, Isolation, and Identification, IEEE
Transactions on Robotics 33(6), 2017, sections IV and V.
"""

import numpy as np

from sim.compiled.kernel import kernel
from sim.estimation.joint_tracking import unheld
from sim.estimation.torque_errors import CAUSES, beyond, left_over, noise

SURE = 5.0
"""Deviations of a torque that no contact makes. It is looked at 3,000 times a second, over which errors stay alike for 0.2 s:
in five hours of motion fewer than 10^6 independent looks, of which 5 deviations are exceeded in less than one."""
LEAST_LEVER = 0.2
"""Of a force on a link [m]: through a shorter one a small error of a torque would seem a large force."""
LEAST = 10.0  # that is told [N]


@kernel
def link_force(models, elbow):
    """Last joint that feels a torque (-1: no force is told), the least force [N], the torque that needs it [N·m], its joint."""
    rigid, momentum, errors = models[0][0], models[1][0], models[2][0]
    n, last = momentum.residual.size, -1
    certain = np.zeros(n)
    change = np.empty(CAUSES)
    for i in range(n):
        residual, causes = momentum.residual[i], errors.causes[i]
        unexplained = noise(errors, momentum.doubt[i], causes[0])
        held = momentum.held[i]
        left = unheld(left_over(errors.shares[i], residual, causes), held)
        size = beyond(errors, i, (left, causes), (unexplained, SURE))
        left = unheld(since_rest(errors, i, residual, change), 2.0 * held)
        changed = beyond(errors, i, (left, change), (unexplained, SURE))
        if abs(changed) > abs(size):
            size = changed
        if size != 0.0:
            last, certain[i] = i, size
    force, at = 0.0, 0
    for i in range(last + 1):
        needed = abs(certain[i]) / max(LEAST_LEVER, _lever(rigid, i, last, elbow))
        if needed > force:
            force, at = needed, i
    return (last if force > LEAST else -1), force, certain[at], at


@kernel
def _lever(rigid, i, last, elbow):
    """Distance of the far end of the link that joint `last` moves from the axis of joint i [m]."""
    start = rigid.origins[i]
    x, y, z = rigid.tcp[0] - start[0], rigid.tcp[1] - start[1], rigid.tcp[2] - start[2]
    if last <= elbow:
        end = rigid.origins[elbow if last < elbow else elbow + 1]
        x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    a, b, c = rigid.jacobian[3, i], rigid.jacobian[4, i], rigid.jacobian[5, i]
    u, v, w = y * c - z * b, z * a - x * c, x * b - y * a
    return np.sqrt(u * u + v * v + w * w)


@kernel
def since_rest(errors, i, torque, change):
    """What the causes leave of the change of joint i's torque since nothing was touched [N·m]; `change` takes theirs."""
    for k in range(CAUSES):
        change[k] = errors.causes[i, k] - errors.rest[i, 1 + k]
    return left_over(errors.shares[i], torque - errors.rest[i, 0], change)
