"""What the supervisor takes for a hand or a contact, and what it knows to be the arm's own doing (FD-5, FD-19, CD-1, CD-11)."""

from collections.abc import Callable

import numpy as np
import pytest

from pendant.equipment.load import Load
from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.tick.modes import Law, Mode
from pendant.tick.source_signal import ContactSignals
from tests.pendant.contacts import ramp, signals
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import LET_GO, Bench
from tests.pendant.program.test_contact_programs import NEXT
from tests.pendant.program.test_hand_guide_step import guided

AT_ONCE = {"activation__period": 0.0, "free_drive__cool_down": 0.0}
LEAVE = Inputs(commands=(Command.LEAVE_FREE_DRIVE,))


def resting(**changes: float | bool) -> Bench:
    bench = Bench(**AT_ONCE, **changes)
    bench.run(60)
    return bench


def reloading(**changes: float | bool) -> Bench:
    """The payload is led over for a second."""
    bench = resting(**changes)
    bench.step(Inputs(load=Load(mass=2.0)))
    return bench


def shaken(**changes: float | bool) -> Bench:
    """Free-drive was just left, which is felt for half a second."""
    bench = Bench(haptics__on=True, **AT_ONCE, **changes).in_period()
    bench.step(LEAVE)
    assert (bench.last.law, bench.last.shake is not None) == (Law.HOLD, True)
    return bench


def free(**changes: float | bool) -> Bench:
    bench = Bench(**AT_ONCE, **changes).entered()
    bench.step(LET_GO)
    return bench


def following(**changes: float | bool) -> Bench:
    bench = guided(NEXT, **AT_ONCE, **changes)
    assert bench.last.law is Law.FOLLOW
    return bench


def paused(**changes: float | bool) -> Bench:
    bench = following(**changes)
    bench.step(Inputs(commands=(Command.PAUSE_PROGRAM,)))
    assert (bench.last.law, bench.last.mode) == (Law.HOLD, Mode.RUN)
    return bench


@pytest.mark.parametrize(
    ("build", "felt"), [(resting, True), (paused, True), (following, False), (reloading, False), (shaken, False)]
)
def test_a_tap_is_a_signal_while_the_arm_is_held_and_nothing_else_moves_it(build: Callable[..., Bench], felt: bool) -> None:
    """FD-5 (i), FD-19: a program, a payload that is led over and a pattern move an arm without any hand."""
    bench = build(signals__tap__on=True, free_drive__allowed_from__run=True)
    bench.events.clear()
    bench.run(2, value=estimate(acceleration=20.0))
    bench.run(60)
    assert (Kind.SIGNAL_SEEN in [event.kind for event in bench.events]) is felt


@pytest.mark.parametrize(
    ("build", "factor", "told"),
    [(resting, 10.0, True), (free, 1.0, True), (free, 10.0, False), (reloading, 1.0, False), (shaken, 1.0, False)],
)
def test_a_contact_is_told_beyond_the_limits_of_the_mode_while_nothing_else_moves_the_arm(
    build: Callable[..., Bench], factor: float, told: bool
) -> None:
    """CD-11, FD-19: 12 N; in free-drive, and there only, limits are `factor` times as high."""
    bench = build(contact__on=True, contact__free_drive_factor=factor)
    bench.events.clear()
    for signal in signals(90, push=ramp(90, 40, 4.0, top=12.0)):
        value = estimate()
        value.signals = ContactSignals(np.array(signal), (True,))
        bench.step(value=value)
    assert (Kind.CONTACT_GAINED in [event.kind for event in bench.events]) is told
