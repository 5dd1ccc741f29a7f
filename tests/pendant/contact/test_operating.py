"""Thresholds that follow what the robot does (CD-11)."""

import pytest

from pendant.all_settings import Settings, apply
from pendant.contact.operating import OperatingSensitivity, Operation, follows
from pendant.contact.settings import ContactUse
from pendant.inputs import Command, Inputs
from pendant.program.steps import AnyStep, ApplyForce, LinearMove, Program, Wait
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

SHARES = {"commanded_share": 0.5, "target_share": 0.1, "torque_share": 0.02, "current_share": 2.0, "program_factor": 3.0}
DOES = {
    "commanded_share": Operation(acceleration=2.0),
    "target_share": Operation(force=10.0),
    "torque_share": Operation(torque=50.0),
    "current_share": Operation(current=0.5),
    "program_factor": Operation(running=True),
}
"""What doubles the thresholds, and trebles them in RUN."""


def made(**values: float) -> ContactUse:
    return apply(Settings(), {f"contact.{name}": value for name, value in values.items()}).contact


@pytest.mark.parametrize("name", SHARES)
@pytest.mark.parametrize("other", SHARES)
def test_each_share_counts_for_what_it_is_of(name: str, other: str) -> None:
    use = made(**{name: SHARES[name]})
    assert follows(use)
    given = OperatingSensitivity().step(use, DOES[other])
    factor = (3.0 if name == "program_factor" else 2.0) if name == other else 1.0
    assert given.sensitivity == pytest.approx(1.0 / factor)
    assert (given is use) is (factor == 1.0)


def test_they_multiply_and_lie_on_what_the_user_has_set() -> None:
    every = Operation(2.0, 10.0, 50.0, 0.5, True)
    given = OperatingSensitivity().step(made(**SHARES, sensitivity=2.0), every)
    assert given.sensitivity == pytest.approx(2.0 / 48.0)


def test_the_same_settings_are_given_while_nothing_changes() -> None:
    """A detector makes new thresholds for other settings: every percent of the factor."""
    use, sensitivity = made(**SHARES), OperatingSensitivity()
    first = sensitivity.step(use, Operation(force=10.0))
    assert sensitivity.step(use, Operation(force=10.04)) is first
    assert sensitivity.step(use, Operation(force=10.06)) is not first
    assert sensitivity.step(use, Operation()) is use
    assert sensitivity.step(made(**SHARES, sensitivity=2.0), Operation()).sensitivity == 2.0


def test_as_shipped_nothing_follows() -> None:
    assert not follows(ContactUse())


LINE = LinearMove(position=(0.0, 0.0, 0.1), quaternion=(1.0, 0.0, 0.0, 0.0), acceleration=4.0)


@pytest.mark.parametrize(
    ("name", "step", "factor"),
    [
        ("commanded_share", LINE, 3.0),
        ("commanded_share", Wait(duration=9.0), 1.0),
        ("target_share", ApplyForce(force=(0.0, 6.0, -8.0)), 2.0),
        ("target_share", LINE, 1.0),
        ("torque_share", LINE, 1.5),
        ("current_share", LINE, 1.8),
        ("program_factor", LINE, 3.0),
    ],
)
def test_a_program_says_what_the_robot_does(name: str, step: AnyStep, factor: float) -> None:
    """Torque and current are those of the joint that bears most, to either side."""
    bench = Bench(**{f"contact__{name}": SHARES[name]})
    bench.run(60)
    use = bench.supervisor.settings.contact
    bench.step(Inputs(program=Program(steps=(step,))))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    value = estimate(tau_J=[5.0, -25.0, 0.0, 0.0, 0.0, 0.0]).copy()
    value.current[:] = [0.1, 0.2, -0.4, 0.0, 0.0, 0.0]
    bench.step(value=value)
    assert bench.supervisor._run.contact_use(use, value).sensitivity == pytest.approx(1.0 / factor, rel=0.01)
