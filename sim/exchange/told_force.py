"""The user's force with what is known of its error: of the arm's own sensors, for pictures and recordings (FD-19)."""

from pendant.decision import Decision
from pendant.guided.force_covariance import UncertainForce, covariance
from pendant.tick.estimate import Estimate
from pendant.tick.pose import ORIGIN
from sim.arm.arm_file import Arm
from sim.flange.wrench_hypotheses import SURE
from sim.sensing.sensor_drift import sensor_spec


def told_force(arm: Arm, estimate: Estimate, decision: Decision) -> UncertainForce | None:
    """What free-drive took for the user's force in a tick; None while the arm is not free."""
    taken, fitting = decision.taken, decision.estimator.fitting
    if taken is None:
        return None
    x, y, z = ORIGIN if fitting is None else fitting.tool.tcp
    return UncertainForce(taken.force, covariance(taken, estimate, sensor_spec(arm), SURE), (x, y, z))
