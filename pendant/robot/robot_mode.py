"""The robot mode and the safety mode: what events do to them, and the control law that follows from them (FD-1)."""

from pendant.all_settings import Settings
from pendant.event_table import TABLE
from pendant.events.event import Event, Kind, Values
from pendant.events.event_row import Effect
from pendant.freedrive.state_machine import ASKED_FOR, FreeDrive
from pendant.inputs import Command
from pendant.limits.validity import Stillness
from pendant.program.jog_move import Jogged
from pendant.program.sequencer import Sequencer
from pendant.program.steps import JointMove, Move, ProgramState
from pendant.robot.stopping import Stopping
from pendant.signals.enabling_device import Grip, enables
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety

STOPPING = {
    Effect.LEAVE_TO_STOP: Safety.NORMAL,
    Effect.SAFEGUARD_STOP: Safety.SAFEGUARD_STOP,
    Effect.PROTECTIVE_STOP: Safety.PROTECTIVE_STOP,
    Effect.EMERGENCY_STOP: Safety.EMERGENCY_STOP,
}

DONE_GUIDING = ASKED_FOR | {Kind.LEFT_PERIOD, Kind.LEFT_RESTART}
"""Endings of free-drive with which a program goes on; after any other one somebody must look first."""


class Robot:
    """What the parts of the supervisor share.

    Attributes:
        free: free-drive.
        sequencer: of the program.
        stopping: the stop that lasts, or is measured.
        still: for how long the arm has been slow.
        mode: robot mode.
        safety: safety mode.
        braking: since free-drive or a motion was ended, until static.
        static: the arm stands, in this tick.
        grip: of the enabling device in this tick, None where none is needed.
        jog: the motion that is jogged, None for none.
        turn: the motion of the wrist that the payload wizard wants, None for none.
    """

    __slots__ = (
        "_freed",
        "_moves",
        "_remembered",
        "braking",
        "free",
        "grip",
        "jog",
        "mode",
        "safety",
        "sequencer",
        "static",
        "still",
        "stopping",
        "turn",
    )

    def __init__(self, free: FreeDrive, sequencer: Sequencer) -> None:
        self.free = free
        self.sequencer = sequencer
        self.stopping = Stopping()
        self.still = Stillness()
        self.mode = Mode.TEACH
        self.safety = Safety.NORMAL
        self.braking = False
        self.static = False
        self.grip: Grip | None = None
        self.jog: Jogged | None = None
        self.turn: JointMove | None = None
        self._remembered = Mode.TEACH  # where free-drive was entered from
        self._freed = False  # the law was FREE in the last tick
        self._moves = 0  # jogged, or turns of the wrist, so far

    @property
    def enabled(self) -> bool:
        """No enabling device forbids motion."""
        return enables(self.grip)

    @property
    def move(self) -> Move | None:
        """That the arm follows: of the program, jogged, or of the payload wizard."""
        return self.sequencer.move or self.jog or self.turn

    def number(self) -> int:
        """Id of the next motion that no program asks for: negative, for those of a program's steps are positive."""
        self._moves += 1
        return -self._moves

    @property
    def program_name(self) -> str:
        """Of the loaded program."""
        program = self.sequencer.program
        return program.name if program else ""

    def happen(self, event: Event, settings: Settings, events: list[Event]) -> None:
        """Something outside of free-drive happens that ends it, too."""
        if self.free.phase is not Phase.OFF:
            self.free.stop(event.kind, settings)
        self.follow(event, events)

    def follow(self, event: Event, events: list[Event]) -> None:
        """Tell an event, and become what the table says of it."""
        events.append(event)
        effect = TABLE[event.kind].effect
        if effect in (Effect.TRY, Effect.ENTER):
            if self.sequencer.state is ProgramState.RUNNING and not self.sequencer.guiding:
                self.pause_program(event.tick, events)
            if effect is Effect.ENTER:
                self._remembered, self.mode = self.mode, Mode.FREE_DRIVE
        elif effect is Effect.TO_TEACH:
            self._to_teach(event.tick, events)
        elif effect is Effect.LEAVE:
            self._leave(event, events)
        elif effect in STOPPING:
            self._stop(event.kind, STOPPING[effect])

    def _to_teach(self, tick: int, events: list[Event]) -> None:
        """TEACH, before free-drive begins; a program that was begun is stopped (FD-1)."""
        sequencer = self.sequencer
        if sequencer.state in (ProgramState.RUNNING, ProgramState.PAUSED):
            values: Values = {"name": self.program_name, "step": sequencer.index + 1}
            events.append(Event(Kind.PROGRAM_STOPPED, tick, values))
            sequencer.stop()
        self.mode = Mode.TEACH

    def _leave(self, event: Event, events: list[Event]) -> None:
        """Free-drive is left, back to the mode that it was entered from."""
        if self.mode is Mode.FREE_DRIVE:
            self.mode = self._remembered
        if self.sequencer.guiding and event.kind in DONE_GUIDING:
            self.sequencer.let_go()
        elif self.sequencer.guiding:
            self.pause_program(event.tick, events)
        if event.kind is Kind.LEFT_ENABLING:
            self.begin_stop(event.kind)

    def _stop(self, kind: Kind, safety: Safety) -> None:
        """STOP, in `safety` at least, and the program is given up."""
        self.mode = Mode.STOP
        self.safety = max(self.safety, safety)
        self.braking = True
        self.sequencer.stop()
        self.begin_stop(kind)

    def begin_stop(self, kind: Kind) -> None:
        """An event of `kind` stops the arm."""
        self.stopping.begin(kind, TABLE[kind].category, self.static)

    def reset(self, safety: Safety) -> None:
        """Out of STOP, into `safety`. The arm stands, so that `law` ends the braking."""
        self.mode = Mode.TEACH
        self.safety = safety
        self.stopping.end()

    def pause_program(self, tick: int, events: list[Event]) -> None:
        """The running program pauses, and the arm comes to rest."""
        self.sequencer.pause()
        self.braking = True
        values: Values = {"name": self.program_name, "step": self.sequencer.index + 1}
        events.append(Event(Kind.PROGRAM_PAUSED, tick, values))

    def refuse(self, command: Command, estimate: Estimate, reason: str, events: list[Event]) -> None:
        """Say why a command is not possible."""
        values: Values = {"command": command, "mode": self.mode, "reason": reason}
        events.append(Event(Kind.COMMAND_REFUSED, estimate.tick, values))

    def law(self) -> Law:
        """Of this tick, after everything that happens in it."""
        free, mode = self.free, self.mode
        if mode is _FREE_DRIVE or free.phase is Phase.SEQUENCE:
            self._freed = True
            return Law.HOLD if free.caught else _FREE
        if self._freed:
            self._freed, self.braking = False, True
        if mode is Mode.STOP:
            return Law.OFF if self.stopping.off else Law.BRAKE
        if self.move is not None:
            self.braking = False
            return Law.FOLLOW
        if self.static:
            self.braking = False
        return Law.BRAKE if self.braking else Law.HOLD


_FREE_DRIVE, _FREE = Mode.FREE_DRIVE, Law.FREE  # looked up in every tick
