"""Manipulation, densely around every limit (FD-13)."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from pendant.estimate import Estimate
from pendant.maintain import ZEROS, Excess, Reference, manipulation, reference
from pendant.settings import Maintain
from tests.pendant.estimates import estimate

REST = Reference(ZEROS, (0.0,) * 6)
LIMITS = Maintain()

# parameter: limit, unit, how an estimate gets a value of it at component k, number of components
PARAMETERS: dict[str, tuple[float, str, Callable[[float, int], Estimate], int]] = {
    "user force": (8.0, "N", lambda value, k: estimate(force=at(value, k, 3)), 3),
    "user torque": (1.5, "N·m", lambda value, k: estimate(torque=at(value, k, 3)), 3),
    "joint external torque": (8.0, "N·m", lambda value, k: estimate(tau_ext=at(value, k, 6)), 6),
    "joint speed": (0.05, "rad/s", lambda value, k: estimate(qd=at(value, k, 6)), 6),
    "flange speed": (0.02, "m/s", lambda value, k: estimate(speed=at(value, k, 3)), 3),
}


def at(value: float, index: int, length: int) -> list[float]:
    return [value if k == index else 0.0 for k in range(length)]


@pytest.mark.parametrize("name", PARAMETERS)
def test_beyond_the_limit_and_not_at_it(name: str) -> None:
    limit, unit, make, count = PARAMETERS[name]
    near = [limit * (1 + step * 1e-12) for step in range(-5, 6)] + [limit * share for share in np.linspace(0, 3, 61)]
    for component in range(count):
        for value in near:
            for sign in (1.0, -1.0):
                excess = manipulation(make(sign * value, component), REST, LIMITS, use_wrench=True)
                expected = Excess(name, value, limit, unit) if value > limit else None
                assert excess == expected, (value, component)


@pytest.mark.parametrize(("name", "share"), [("user force", 0.6), ("user torque", 0.6), ("flange speed", 0.6)])
def test_vectors_count_by_their_length(name: str, share: float) -> None:
    limit, _, make, _ = PARAMETERS[name]
    together = make(share * limit, 0)
    for index, array in ((1, together.F_user), (4, together.F_user), (1, together.v_F)):
        if array[index - 1] != 0.0:
            array[index] = share * limit
            array[index + 1] = share * limit
    excess = manipulation(together, REST, LIMITS, use_wrench=True)
    assert excess is not None
    assert excess.parameter == name
    assert excess.value == pytest.approx(share * limit * math.sqrt(3.0))


def test_forces_count_from_what_they_were_when_the_period_began() -> None:
    leaning = estimate(force=[30.0, -12.0, 7.0], torque=[2.0, 1.0, -3.0], tau_ext=[9.0, -20.0, 3.0, 1.0, 0.5, 0.2])
    since = reference(leaning, use_wrench=True)
    assert since == Reference((30.0, -12.0, 7.0, 2.0, 1.0, -3.0), (9.0, -20.0, 3.0, 1.0, 0.5, 0.2))
    assert manipulation(leaning, since, LIMITS, use_wrench=True) is None
    let_go = manipulation(estimate(tau_ext=[9.0, -20.0, 3.0, 1.0, 0.5, 0.2]), since, LIMITS, use_wrench=True)
    assert let_go == Excess("user force", math.sqrt(900 + 144 + 49), 8.0, "N")
    joints = manipulation(estimate(), Reference(ZEROS, since.torques), LIMITS, use_wrench=True)
    assert joints == Excess("joint external torque", 9.0, 8.0, "N·m")


def test_without_the_flange_sensor_the_joints_judge_alone() -> None:
    """FD-3a."""
    pushed = estimate(force=100.0, torque=20.0)
    pushed.F_user[:] = math.nan
    assert reference(pushed, use_wrench=False) == REST
    assert manipulation(pushed, REST, LIMITS, use_wrench=False) is None
    pushed.qd[3] = 0.3
    assert manipulation(pushed, REST, LIMITS, use_wrench=False) == Excess("joint speed", 0.3, 0.05, "rad/s")


def test_any_number_of_joints() -> None:
    seven = estimate(n=7, tau_ext=at(12.0, 6, 7))
    excess = manipulation(seven, Reference(ZEROS, (0.0,) * 7), LIMITS, use_wrench=True)
    assert excess == Excess("joint external torque", 12.0, 8.0, "N·m")
