"""What a hand, the pendant's button (FD-5a) and digital inputs (FD-5b, FD-17) call for in a tick: activation signal, commands."""

import math

from pendant.all_settings import Settings
from pendant.events.event import Event, Kind
from pendant.inputs import Command, Inputs
from pendant.limits.validity import joints_ok
from pendant.program.steps import ProgramState
from pendant.signals.gestures import PatternSignal
from pendant.signals.settings import PressedControl, PushSettings
from pendant.signals.sources import BUTTON, DIGITAL, NONE, PRESSES, REMOTE_CONTROLLER, Sources
from pendant.tick.estimate import Estimate


class Calls:
    """One tick at a time; nothing is computed for sources that are off."""

    __slots__ = ("_leaving", "_presses", "_sources", "commands", "feeling", "force", "hand_off", "signal", "touched")

    def __init__(self, n: int) -> None:
        """`n` joints."""
        self._sources = Sources(n)
        self._presses = PatternSignal()  # of the button, or of the input
        self._leaving = False  # the digital input that leaves was high in the last tick
        self.feeling = False  # a source by hand is on
        self.signal = NONE
        self.commands: tuple[Command, ...] = ()
        self.hand_off = True  # no hand is felt on the arm (FD-8a)
        self.touched = False  # one is in this tick, be it less than a signal
        self.force = 0.0  # change of the force at the flange from the untouched state [N]

    def refresh(self, settings: Settings) -> None:
        """The settings are new."""
        use = settings.signals
        by_hand = (use.push.on, use.push.reported, use.twist.on, use.joints.on, use.pattern.on, use.turn.on, use.posture.on)
        self.feeling = any((*by_hand, use.force_step.on, use.tap.on))
        if not use.presses.on:
            self._presses = PatternSignal()
        self._sources.refresh(use)
        if not self.feeling:
            self.hand_off, self.touched, self.force = True, False, 0.0

    def step(
        self,
        estimate: Estimate,
        inputs: Inputs,
        settings: Settings,
        *,
        wrench: bool,
        holding: bool,
        state: ProgramState,
        button: bool,
    ) -> list[Event]:
        """Find `signal` and `commands` of this tick.

        Args:
            estimate: of this tick.
            inputs: of this tick.
            settings: as they are.
            wrench: the user's wrench is valid and finite.
            holding: the arm is held in its posture.
            state: of the program.
            button: the pendant's button is held.
        """
        use = settings.signals
        events: list[Event] = []
        self.commands = ()
        self.signal = NONE
        if self.feeling:
            joints, running = joints_ok(estimate), state is ProgramState.RUNNING
            self.signal = self._sources.step(estimate, use, wrench_ok=wrench, joints_ok=joints, holding=holding, running=running)
            self.hand_off = self._sources.hand_off(settings.let_go, wrench)
            self.touched = self._sources.touched
            self.force = self._sources.force()
            push = self._sources.pushed()
            if push is not None:
                events.append(_told(push, estimate.tick))
                self.commands = _steered(use.push, state)
        leaving = use.leaving and use.leaving_input in inputs.high
        if leaving and not self._leaving:
            self.commands += (Command.LEAVE_FREE_DRIVE,)
        self._leaving = leaving
        if use.button and button:
            self.signal = BUTTON
        elif use.digital and use.digital_input in inputs.high:
            self.signal = DIGITAL
        elif inputs.remote_signal:
            self.signal = REMOTE_CONTROLLER
        if use.presses.on:
            pressed = button if use.presses.of is PressedControl.BUTTON else use.digital_input in inputs.high
            if self._presses.step(pressed, use.presses):
                self.signal = PRESSES
        return events

    def relearn(self) -> None:
        """What the sensors feel of the untouched arm changes without anybody's hand."""
        self._sources.relearn()


def _told(push: tuple[float, float, float], tick: int) -> Event:
    """The event of a push at the flange (FD-6a)."""
    size = math.hypot(*push)
    x, y, z = (value / size for value in push)
    return Event(Kind.PUSHED, tick, {"part": "flange", "force": size, "x": x, "y": y, "z": z})


def _steered(use: PushSettings, state: ProgramState) -> tuple[Command, ...]:
    """What a push does to the program (FD-6a)."""
    if state is ProgramState.RUNNING and use.pauses:
        return (Command.PAUSE_PROGRAM,)
    if state is ProgramState.PAUSED and use.resumes:
        return (Command.RESUME_PROGRAM,)
    if state in (ProgramState.RUNNING, ProgramState.PAUSED) and use.stops:
        return (Command.STOP_PROGRAM,)
    return ()
