"""The arm of a script: what it wants is said to the pendant in every tick, and read back from what that decides."""

from collections.abc import Generator

from msgspec.structs import replace

from app.urscript.functions.sensing_values import HISTORY
from app.urscript.language.trouble import Misuse
from app.urscript.robot.path_offsets import PathOffsets
from app.urscript.robot.robot_side import Axes
from pendant.contact.contact_change import Change, Contact
from pendant.decision import Decision
from pendant.events.event import Kind, Values
from pendant.inputs import NOTHING, Command, Inputs
from pendant.limits.nearness import Nearness
from pendant.motion.script_requests import ForceMode, GentleStop, Guided, PathOffset, Scripted, ScriptedMove
from pendant.program.steps import ProgramState, script_program
from pendant.settings.schema import ticks
from pendant.tick.modes import Mode, Phase

NAME = "script"
"""Of the program that the pendant runs for it."""

PATIENCE = ticks(3.0)
"""A motion waits so long for the arm to come to rest before the program begins."""

AGAIN = ticks(0.1)
"""Between attempts to begin or to go on."""

STOOD = ticks(1.2)
"""The arm has to stand so long before its sensor can be zeroed."""

ZEROING = ticks(5.0)
"""A script that zeroes its forces has the sensor zeroed too, for free-drive, if the arm stands within this time."""

STATUS = {Nearness.OK: 0, Nearness.NEAR: 1, Nearness.TOO_NEAR: 2}

OWN_STOP = 4.0
"""Deceleration of a motion that nobody waits for any more [rad/s²]."""

REFUSED = frozenset({Kind.PROGRAM_REFUSED, Kind.PROGRAM_FAILED})


class ScriptArm:
    """See `app.urscript.robot.robot_side.ArmSide`.

    Attributes:
        refusal: why the arm cannot do what was asked for, until somebody takes it; "".
        gone: somebody else ended the script's motion.
        at_work: the program that the pendant runs, or ended in this tick, is the script's.
    """

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """The simulation starts over: nothing is wished, and nothing was."""
        self._count = 0  # motions so far, of all scripts
        self._wish = Scripted()
        self._wanted = False  # the script wants something of the arm
        self._state = ProgramState.NONE  # of the script's program in the pendant
        self._over = False  # the script is, and its program is to end
        self._ending: Command | None = None  # not at its own end, but by this
        self._commands: tuple[Command, ...] = ()  # of the next tick
        self._waited = 0  # ticks for the program to begin, or to go on
        self._resuming = False
        self._taken = False  # a thread moves the arm
        self._done = 0
        self._mode, self._phase, self._static = Mode.TEACH, Phase.OFF, False
        self._nearness = Nearness.OK
        self._contact: tuple[int, Contact] | None = None  # that lasts, and the tick in which it began
        self._tick = self._stood = 0  # ticks, and those in which the arm has stood
        self._zero = 0  # ticks for which the wish to zero the sensor is kept
        self._unread = ""  # why the forces were not zeroed in the tick done last
        self.refusal = ""
        self.gone = self.at_work = False
        self.offsets = PathOffsets(self._go_beside, lambda: self._wish.force is not None)

    # of the script

    def ask(self, move: ScriptedMove) -> int:
        """Ask for a motion or a stop, in place of what is done; its number. Who is guided by hand, and asks again, goes on so."""
        before = self._wish.move
        if isinstance(before, Guided):
            being = before.id > self._done or self._phase is not Phase.OFF
            if being and before == replace(move, id=before.id):
                return before.id
            self.leave()
        self._count += 1
        self._want(replace(self._wish, move=replace(move, id=self._count)))
        return self._count

    def take(self) -> None:
        """A thread begins to move the arm. Raises Misuse: another one does."""
        if self._taken:
            raise Misuse("another thread is controlling the robot")
        self._taken = True

    def give(self) -> None:
        """It moves it no more."""
        self._taken = False

    def done(self, number: int) -> bool:
        """Whether a request is done, or another took its place."""
        if number == self._count and self.refusal:
            refusal, self.refusal = self.refusal, ""
            raise Misuse(refusal)
        return number != self._count or self._done >= number

    def drop(self, number: int) -> None:
        """Nobody waits any more."""
        if number == self._count and self._done < number:
            self.ask(GentleStop(deceleration=OWN_STOP))

    def push(self, force: ForceMode | None) -> None:
        """Push while the motion goes on; None: no more."""
        if force is not None:
            if self.offsets.used:
                raise Misuse("the tool goes beside its path: path_offset_disable() or stop_conveyor_tracking() first")
            self._want(replace(self._wish, force=force))
        elif self._wish.force is not None:
            self._wish = replace(self._wish, force=None)

    def _go_beside(self, offset: PathOffset | None) -> None:
        """Go at an offset from its motions; None: no more."""
        wish = replace(self._wish, offset=offset)
        if offset is None:
            self._wish = wish
        else:
            self._want(wish)

    def aim(self) -> ScriptedMove | None:
        """The motion that the arm does."""
        return self._wish.move if self._done < self._count else None

    def leave(self) -> None:
        """Be guided by hand no more."""
        if self._phase is not Phase.OFF and Command.LEAVE_FREE_DRIVE not in self._commands:
            self._commands += (Command.LEAVE_FREE_DRIVE,)
        if isinstance(self._wish.move, Guided):
            self._count += 1
            self._wish = replace(self._wish, move=GentleStop(id=self._count))

    def zero(self) -> Generator[None, None, None]:
        """Zero what is told of forces at once, and the flange's sensor if the arm stands for a while soon."""
        self._zero = ZEROING
        return self.zero_reading()

    def zero_reading(self) -> Generator[None, None, None]:
        """Zero what is told of forces: the first tick decides; with the second, forces are told against it."""
        self._commands += (Command.ZERO_READING,)
        yield
        if self._unread:
            reason, self._unread = self._unread, ""
            raise Misuse(reason)
        yield

    def steps_back(self, direction: Axes) -> int:
        """Ticks since the tool has been in contact against this direction."""
        if not self._wish.feeling:
            self._want(replace(self._wish, feeling=True))
        if self._contact is None:
            return 0
        began, contact = self._contact
        against = sum(a * b for a, b in zip(contact.force, direction, strict=False))
        return self._tick - began if against > 0.0 or not any(direction[:3]) else 0

    def free_drive_status(self) -> int:
        """How near a singularity is, in free-drive."""
        return STATUS[self._nearness]

    def _want(self, wish: Scripted) -> None:
        self._wish = wish
        if not self._wanted:
            self._wanted, self._waited, self.refusal = True, 0, ""

    # of who runs it

    def end(self, *, whole: bool) -> None:
        """The script is over; `whole`: it has come to its own end. The arm comes to rest."""
        self._taken = False
        self.offsets.reset()
        if self._state in ACTIVE:
            self._over = True
            guided = self._mode is Mode.FREE_DRIVE  # no command ends what a hand leads; its end does
            own = guided or (whole and self._state is ProgramState.RUNNING)
            self._ending = None if own else Command.STOP_PROGRAM
        self._wish, self._wanted, self._resuming, self.refusal, self.gone, self._contact = (
            Scripted(),
            False,
            False,
            "",
            False,
            None,
        )

    def pause(self) -> None:
        """The arm comes to rest, and what it does is begun again when it goes on."""
        self._resuming = False
        if self._state is ProgramState.RUNNING:
            self._commands += (Command.PAUSE_PROGRAM,)

    def resume(self) -> None:
        """Go on as soon as the arm stands."""
        self._resuming, self._waited = self._state is ProgramState.PAUSED, 0

    @property
    def halted(self) -> bool:
        """The pendant has paused the script's program."""
        return self._state is ProgramState.PAUSED

    def inputs(self, equips: bool) -> Inputs:
        """What the pendant gets for the tick that begins; `equips`: with tool or payload of the script."""
        commands, self._commands = self._commands, ()
        if self.offsets.used:
            self.offsets.step()
        if self._zero:
            self._zero -= 1
            if self._stood >= STOOD and self._wish.force is None:
                self._zero, commands = 0, (*commands, Command.ZERO_SENSOR)
        if self._over:
            if self._ending is not None:
                commands += (self._ending,)
            self._ending = None
            return Inputs(script=OVER, commands=commands)
        if self._state in ACTIVE:
            wish = replace(self._wish, equips=True) if equips else self._wish
            if self._resuming and self._again():
                commands += (Command.RESUME_PROGRAM,)
            return Inputs(script=wish, commands=commands)
        if self._wanted and not self.refusal and not equips and self._again():  # a running program would keep its tool
            start = Command.START_REMOTELY if self._mode is Mode.REMOTE else Command.START_PROGRAM
            return Inputs(script=self._wish, program=script_program(NAME), commands=(*commands, start))
        return Inputs(commands=commands) if commands else NOTHING

    def _again(self) -> bool:
        """Whether to try now to begin, or to go on: the arm stands, or will not within what is waited for."""
        self._waited += 1
        return (self._static and self._waited % AGAIN == 1) or self._waited >= PATIENCE

    def see(self, decision: Decision) -> None:
        """Take in a tick."""
        self._tick += 1
        self._stood = self._stood + 1 if decision.static else 0
        self._mode, self._phase, self._static = decision.mode, decision.phase, decision.static
        self._done = decision.script_done
        if decision.singularity is not None:
            self._nearness = decision.singularity
        for contact in decision.contacts:
            if contact.part == "tool":
                lost = contact.change is Change.LOST
                self._contact = None if lost else (self._tick - contact.steps, contact)
        if self._contact is not None and self._tick - self._contact[0] > HISTORY:
            self._contact = None
        before = self._state
        self._unread = ""
        for event in decision.events:
            self._take(event.kind, event.values)
        if self._state in ACTIVE:
            self._state = decision.program if decision.program in ACTIVE else ProgramState.STOPPED
        self.at_work = before in ACTIVE or self._state in ACTIVE
        if before in ACTIVE and self._state not in ACTIVE:
            if not self._over:
                self.gone, self._wish, self._wanted = True, Scripted(), False
            self._over = False

    def _take(self, kind: Kind, values: Values) -> None:
        waiting = self._wanted and self._state not in ACTIVE
        if kind is Kind.PROGRAM_STARTED and waiting and values["name"] == NAME:
            self._state, self._waited = ProgramState.RUNNING, 0
        elif kind is Kind.SENSOR_ZEROED:
            self._zero = 0
        elif kind is Kind.ZERO_REFUSED:
            self._unread = str(values["reason"])
        elif kind is Kind.PROGRAM_RESUMED:
            self._resuming = False
        elif (kind in REFUSED and self._wanted) or (kind is Kind.COMMAND_REFUSED and waiting and self._waited >= PATIENCE):
            self.refusal = str(values["reason"])


OVER = Scripted(over=True)

ACTIVE = frozenset({ProgramState.RUNNING, ProgramState.PAUSED})
