"""The sequencer: runs the steps of a program in mode RUN, one after the other."""

import math
from collections.abc import Callable

from msgspec.structs import replace

from pendant.contact.contact_change import ArmPose, Contact
from pendant.program.reaction import REACTION_SPEED, Until, goal
from pendant.program.steps import (
    UNFELT,
    ApplyForce,
    ContactMove,
    GentleStop,
    HandGuide,
    JointMove,
    LinearMove,
    Move,
    Program,
    ProgramState,
    RunScript,
    SetOutput,
    SwitchTool,
    Tell,
    Wait,
    WaitForContact,
    WaitForInput,
    ZeroSensor,
)
from pendant.settings.schema import ticks
from pendant.tick.pose import UNTURNED, Vector

PATIENCE = ticks(3.0)
"""A step that zeroes the sensor waits so long for the arm to come to rest, and for whoever touches it to let go."""


class Sequencer:
    """Runs the loaded program step by step. A step paused half-way is begun again, with a new id, when resumed."""

    __slots__ = (
        "R_FT",
        "_begun",
        "_from",
        "_left",
        "_line",
        "_runs",
        "_untouched",
        "contact",
        "guided",
        "high",
        "index",
        "move",
        "outputs",
        "program",
        "state",
        "telling",
        "tool_on",
    )

    def __init__(self) -> None:
        self.program: Program | None = None
        self.state = ProgramState.NONE
        self.index = 0
        self.move: Move | None = None  # the step being done, None unless RUNNING
        self._begun = 0  # how many moves were begun so far: the last id
        self._left = 0  # ticks left of a wait, or of the patience of a step that zeroes the sensor
        self._from: ArmPose | None = None  # where the present move began
        self._line: LinearMove | None = None  # what the present step, a `ContactMove`, became where it began
        self.contact: Contact | None = None  # that ended the present move, until the arm has come to rest
        self.guided = False  # the arm was guided by hand, until it has come to rest
        self._untouched: Vector = UNFELT  # F_user when the arm last began to move [N]
        self._runs = 0  # of the steps from first to last, done since the start
        self.tool_on = False
        self.telling: Tell | None = None  # what this tick's step says
        self.high: frozenset[int] = frozenset()  # digital inputs that are high now
        self.outputs: frozenset[int] = frozenset()  # digital outputs that are on
        self.R_FT = UNTURNED  # orientation of the tool centre point in the flange

    def load(self, program: Program) -> None:
        """Take a program; allowed unless one is RUNNING or PAUSED."""
        self.program = program
        self.stop()

    def start(self, felt: Vector = UNFELT) -> None:
        """Begin the first step; `felt` is the force of F_user now [N]."""
        self.index = self._runs = self._left = 0
        self._line = None
        self._untouched = felt
        self.resume()

    def pause(self) -> None:
        """Give up the present step for now; what is left of a wait is kept."""
        self.state = ProgramState.PAUSED
        self._drop()

    def resume(self) -> None:
        """Begin the present step again."""
        self.state = ProgramState.RUNNING
        self._begin()

    def stop(self) -> None:
        """Give the program up, and keep it loaded."""
        self.state = ProgramState.NONE if self.program is None else ProgramState.STOPPED
        self.index = 0
        self._line = None
        self._drop()

    @property
    def until(self) -> Until | None:
        """The contact that the present step waits for."""
        return getattr(self.move, "until", None)

    def missed(self, move_done: int) -> str:
        """Why the present move has failed: it has ended without the contact that it should have gone on until; else ""."""
        move = self.move
        if not isinstance(move, JointMove | LinearMove) or move.until is None or move.id != move_done:
            return ""
        assert self.program is not None
        step = self.program.steps[self.index]
        return (
            f"no contact within {1000.0 * step.distance:.0f} mm"
            if isinstance(step, ContactMove)
            else "it ended without a contact"
        )

    def touch(self, contact: Contact, speed: float = 0.0) -> bool:
        """A contact changes while a step runs, the tool at this speed [m/s]: True when it ends the step, and the arm brakes."""
        until = self.until
        if until is None or not until.meets(contact):
            return False
        self.contact, self.move = contact, None
        if (deceleration := until.deceleration(speed)) < math.inf:
            self._begun += 1
            self.move = GentleStop(id=self._begun, of="tool", deceleration=deceleration)
        return True

    @property
    def scripted(self) -> bool:
        """A script says what the arm shall do."""
        program = self.program
        return program is not None and self.state is _RUNNING and isinstance(program.steps[self.index], RunScript)

    def ask(self, move: Move) -> None:
        """The script wants this motion, in place of what is done."""
        self._drop()
        self._begun += 1
        self.move = replace(move, id=self._begun)

    @property
    def guiding(self) -> bool:
        """The present step has the arm guided by hand."""
        return isinstance(self.move, HandGuide)

    def let_go(self) -> None:
        """Guiding by hand has ended."""
        self.guided, self.move = True, None

    def zeroed(self) -> bool:
        """The present step, `ZeroSensor`, is done. Returns as `step`."""
        self._left = 0
        return self._next()

    def impatient(self) -> bool:
        """One tick in which the present step, `ZeroSensor`, cannot zero the sensor. Returns whether it waits no longer."""
        self._left -= 1
        return self._left <= 0

    def shift(self, gone: Vector) -> None:
        """The sensor was zeroed: F_user is less by so much from the next tick on, axes of B [N]."""
        x, y, z = (a - b for a, b in zip(self._untouched, gone, strict=True))
        self._untouched = (x, y, z)

    @property
    def braked(self) -> bool:
        """The present step goes on when the arm has come to rest."""
        return self.guided or self.contact is not None

    def rest(self, now: ArmPose) -> bool:
        """The arm has come to rest after `touch` or `let_go`: do what the step asks for. Returns as `step`."""
        assert self.program is not None
        if self.guided:
            return self._next()
        contact, self.contact = self.contact, None
        until: Until | None = getattr(self.program.steps[self.index], "until", None)
        assert contact is not None
        assert until is not None
        there = goal(until, contact, begun=self._from or now, now=now, R_FT=self.R_FT)
        if there is None:
            return self._next()
        self._begun += 1
        if there.position is None:
            self.move = JointMove(id=self._begun, q=there.q)
        else:
            self.move = LinearMove(id=self._begun, position=there.position, quaternion=there.quaternion, speed=REACTION_SPEED)
        return False

    def step(
        self, move_done: int, where: Callable[[], ArmPose | None] = lambda: None, felt: Callable[[], Vector] = lambda: UNFELT
    ) -> bool:
        """One tick of a RUNNING program.

        Args:
            move_done: id of the last move that the FOLLOW law finished.
            where: tells where the arm is.
            felt: tells the mean force of F_user [N].

        Returns:
            True when this tick ended the program.
        """
        if self._from is None:
            self._from = where()
            if isinstance(self.move, JointMove | LinearMove | ContactMove):
                self._untouched = felt()
        if self.scripted:
            return False
        if isinstance(self.move, ContactMove):
            if self._from is not None:
                self._begun += 1
                self.move = self._line = self.move.line(self._from, self.R_FT, self._begun)
            return False
        return self._done(move_done) and self._next()

    def _done(self, move_done: int) -> bool:
        """One tick of the present step, which begins and ends by what the sequencer knows itself. Returns whether it is done."""
        move = self.move
        if isinstance(move, WaitForContact | HandGuide | ZeroSensor):
            return False
        if isinstance(move, WaitForInput):
            return move.level.holds(self.high)
        if isinstance(move, SwitchTool):
            self.tool_on = move.on
        elif isinstance(move, Tell):
            self.telling = move
        elif isinstance(move, SetOutput):
            self.outputs = self.outputs | {move.output} if move.on else self.outputs - {move.output}
        elif isinstance(move, Wait):
            self._left = max(self._left - 1, 0)
            return self._left == 0
        else:
            return move is not None and move_done == move.id
        return True

    def _next(self) -> bool:
        if self.scripted:
            self.ask(RunScript())
            return False
        self.index += 1
        self._line = None
        assert self.program is not None
        if self.index == len(self.program.steps):
            self._runs += 1
            if self._runs == self.program.repeat:
                self.stop()
                return True
            self.index = 0
        self._begin()
        return False

    def _drop(self) -> None:
        self.move, self.contact, self.guided = None, None, False

    def _begin(self) -> None:
        assert self.program is not None
        self._drop()
        self._begun += 1
        self._from = None
        step = self.program.steps[self.index]
        if self._line is None and step.when is not None and not step.when.holds(self.high):
            self.move, self._left = Wait(id=self._begun, duration=0.0), 0
            return
        self.move = replace(self._line or step, id=self._begun)
        if isinstance(self.move, ApplyForce):
            self.move = replace(self.move, untouched=self._untouched)
        if isinstance(step, ZeroSensor):
            self._left = PATIENCE
        elif isinstance(step, Wait) and self._left == 0:
            self._left = ticks(step.duration)


_RUNNING = ProgramState.RUNNING  # looked up in every tick
