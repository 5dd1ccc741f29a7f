"""Whose force it is, as the flange sensor tells: the bank of hypotheses, and what follows a suspicion (FD-19)."""

import math
from typing import NamedTuple

from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.flange.external_wrench import ExternalWrench, compare
from sim.flange.flange_forces import FlangeForces
from sim.flange.step_answer import StepAnswer, answer


class Odds(NamedTuple):
    """Of a tick: logs of odds against all else [nats], minus infinity where nothing is suspected."""

    lost: float  # that the payload changed
    share: float  # of the payload that is gone then
    stepped: float  # that the sensor stepped
    step: float  # size of that step [N]


NOTHING = Odds(-math.inf, 0.0, -math.inf, 0.0)


class WhoseForce:
    """All that is asked of the flange sensor in free-drive. One kernel: to call two takes as long as all that they do.

    Args:
        arm: the noise of its flange sensor, accelerometer and gyro.
        forces: run in the same tick before.
    """

    def __init__(self, arm: Arm, forces: FlangeForces) -> None:
        self.bank, self._step = ExternalWrench(arm, forces), StepAnswer(arm.n, arm.accuracy.stiffness)
        self._records = self.bank.record, self._step.record
        self._known = forces.record, forces.model
        self._begun = False

    def update(self, bias: tuple[float, ...] | None, unsure: float = 0.0, *, accelerations: bool) -> Odds:
        """One tick.

        Args:
            bias: of the sensor (6,), axes of F [N, N·m]; None: it is not used, and what was before counts no more.
            unsure: standard deviation of each axis of the bias [N], beside its noise.
            accelerations: the flange's accelerometer is valid.
        """
        if bias is None:
            if self._begun:
                self._begun = False
                for each in (self.bank, self._step):
                    each.forget()
            return NOTHING
        self._begun = True
        return Odds(*_update(self._records, self._known, (bias, unsure), accelerations))


@kernel
def _update(records, known, bias, accelerations) -> tuple[float, float, float, float]:
    bank, step = records
    compare(bank, known, bias, accelerations)
    answer(step, known, bank)
    return bank[0].lost, bank[0].share, step[0].odds, step[0].size
