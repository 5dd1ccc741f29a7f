"""The spec's modes and phases said a second time: from time stamps and rows of rules, where pendant/ counts down.

A stream is a list of steps, one a tick. `follow` gives what the spec asks for in each tick: mode, safety, phase, law, program
and the kinds of events. `drive` gives the same of a supervisor.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf

from pendant.all_settings import Settings
from pendant.event_table import TABLE, render
from pendant.events.event import Kind
from pendant.inputs import Button, Command, Inputs
from pendant.program.jog_move import Jogged, JogMove, MoveStraight, MoveThere
from pendant.program.steps import JointMove, Program, ProgramState
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tick.motion_status import MotionStatus
from tests.pendant.estimates import estimate

PROGRAM = Program(name="two moves", steps=(JointMove(q=(0.0,) * 6), JointMove(q=(0.1,) * 6)))
JOG = JogMove(frame="joint", axis=0, sign=1)
THERE = MoveThere(q=(0.1,) * 6, name="home")
STRAIGHT = MoveStraight(position=(0.1, 0.2, 0.3), quaternion=(1.0, 0.0, 0.0, 0.0))
UNFIT = MoveThere(q=(0.0,) * 5)
WRONG = Program(name="five joints", steps=(JointMove(q=(0.0,) * 5),))

Seen = tuple[Mode, Safety, Phase, Law, ProgramState, int, tuple[Kind, ...]]


@dataclass(frozen=True)
class Step:
    """One tick of a stream."""

    held: bool = False
    released: bool = False
    commands: tuple[Command, ...] = ()
    joints: bool = True  # valid
    wrench: bool = True  # valid
    qd: float = 0.0
    force: float = 0.0
    tau: float = 0.0
    done: bool = False  # the FOLLOW law has finished the present move
    cannot: bool = False  # the FOLLOW law cannot do the move
    load: Program | None = None
    jog: Jogged | None = None  # what a button that is held moves
    jog_released: bool = False
    settings: dict[str, float | bool | str] = field(default_factory=dict)


TOOLING = frozenset(
    {
        Kind.TOOL_CHANGED,
        Kind.TOOL_REFUSED,
        Kind.PAYLOAD_CHANGED,
        Kind.POSTURE_MEASURED,
        Kind.POSTURE_REFUSED,
        Kind.PAYLOAD_FOUND,
        Kind.WIZARD_STARTED,
        Kind.WIZARD_FINISHED,
        Kind.WIZARD_STOPPED,
        Kind.WIZARD_REFUSED,
        Kind.SENSOR_ZEROED,
        Kind.ZERO_REFUSED,
        Kind.READING_ZEROED,
        Kind.READING_ZEROED_PULLED,
        Kind.ZERO_DUE,
    }
)
"""Of the tools, the payload wizard and the sensor's zero, which change no mode; tests/pendant/tooling/test_tool_in_use.py and
tests/pendant/test_zeroing.py say when they come."""


def drive(supervisor: Supervisor, stream: list[Step]) -> list[Seen]:
    """What the supervisor does with the stream."""
    return Driver(supervisor).go(stream)


class Driver:
    """Gives a supervisor streams, one after the other."""

    def __init__(self, supervisor: Supervisor) -> None:
        self.supervisor = supervisor
        self._tick = self._move_done = self._current = 0

    @property
    def state(self) -> tuple[object, ...]:
        """All that the next stream's outcome depends on besides the stream."""
        return self._tick, self._move_done, self._current, self.supervisor.state

    def go(self, stream: list[Step]) -> list[Seen]:
        """What the supervisor does with the stream."""
        seen: list[Seen] = []
        last: Step | None = None
        for tick, step in enumerate(stream, self._tick):
            if last is None or step is not last:
                value, inputs = _given(step)
                last = step
            if step.done:
                self._move_done = self._current
            value.tick = tick
            status = MotionStatus(self._move_done, "too far" if step.cannot else "")
            decision = self.supervisor.step(value, inputs, status)
            if decision.move is not None:
                self._current = decision.move.id
            for event in decision.events:
                assert event.tick == tick
                assert set(event.values) == set(TABLE[event.kind].keys)
                assert render(event)[0]
            kinds = tuple(event.kind for event in decision.events if event.kind not in TOOLING)
            seen.append((decision.mode, decision.safety, decision.phase, decision.law, decision.program, decision.step, kinds))
        self._tick += len(stream)
        return seen


def _given(step: Step) -> tuple[Estimate, Inputs]:
    value = estimate(
        joints_valid=step.joints,
        wrench_valid=step.wrench,
        qd=step.qd,
        force=step.force,
        felt=step.force,
        tau_ext=step.tau,
    )
    button = frozenset({Button.FREE_DRIVE})
    return value, Inputs(
        button if step.held else frozenset(),
        button if step.released else frozenset(),
        step.commands,
        step.settings,
        step.load,
        jog=step.jog,
        jog_released=step.jog_released,
    )


@dataclass
class World:
    """All that the oracle remembers: when things were last so."""

    mode: Mode = Mode.TEACH
    safety: Safety = Safety.NORMAL
    phase: Phase = Phase.OFF
    since: int = 0  # tick in which the phase began
    refreshed: float = -inf
    let_go: float = -inf
    present_at: float = -inf  # last tick with the signal
    fast_at: int = -1  # last tick in which a joint was too fast, or unknown
    cool_from: float = -inf
    blocked: bool = False
    entering_press: bool = False
    wrench: bool = False
    force0: float = 0.0
    tau0: float = 0.0
    back: Mode = Mode.TEACH
    origin: Mode = Mode.TEACH
    brake: bool = False
    loaded: bool = False
    program: ProgramState = ProgramState.NONE
    at: int = 0
    jog_refreshed: float = -inf
    jog_let_go: float = -inf
    jog_asked: Jogged | None = None  # by the press that lasts
    jogging: bool = False
    jog_spent: bool = False  # the press does not count any more
    forces: list[float] = field(default_factory=list)  # of the last tenth of a second, the sensor being valid
    safeguard: bool = False  # open
    reduced: bool = False
    category: int = 2  # hardest stop since the last reset
    stopped_at: int = 0  # tick of the stop
    unmeasured: bool = False  # a stop whose end has not been seen yet
    off_from: float = inf  # drive power is removed from this tick on
    anew: bool = False  # the period that runs was asked to begin anew
    registered: bool = False  # a waypoint was registered
    tried: bool = False  # the sensor was valid when the sequence began
    kept: list[tuple[int, float, float, bool]] = field(default_factory=list)  # tick, mean force, torque, sensor valid
    compared: tuple[int, float, float, bool] | None = None  # what the sequence is compared with


def follow(stream: list[Step], settings: Settings) -> list[Seen]:
    """What the spec asks for. The stream's settings changes are not followed: give streams without them."""
    return Follower(settings).go(stream)


class Follower:
    """Says of streams, one after the other, what the spec asks for."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._world = World()
        self._tick = 0

    @property
    def state(self) -> tuple[object, ...]:
        """All that what it says of the next stream depends on besides the stream."""
        return self._tick, replace(self._world)

    def go(self, stream: list[Step]) -> list[Seen]:
        """What the spec asks for in the stream."""
        world, settings = self._world, self._settings
        seen: list[Seen] = []
        for tick, step in enumerate(stream, self._tick):
            kinds: list[Kind] = []
            _tick(world, tick, step, settings, kinds)
            number = world.at if world.program in (ProgramState.RUNNING, ProgramState.PAUSED) else 0
            law = _law(world, tick, settings)
            seen.append((world.mode, world.safety, world.phase, law, world.program, number, tuple(kinds)))
        self._tick += len(stream)
        return seen


def _n(seconds: float) -> int:
    return int(seconds * 500 + 0.5)


def _static(w: World, t: int, s: Settings) -> bool:
    return t - w.fast_at >= _n(s.static.time)


def _law(w: World, t: int, s: Settings) -> Law:
    if w.phase is Phase.SEQUENCE:
        return Law.FREE
    if w.mode is Mode.STOP and t >= w.off_from:
        return Law.OFF
    moving_law = {
        Mode.FREE_DRIVE: Law.FREE,
        Mode.STOP: Law.BRAKE,
    }.get(w.mode)
    if moving_law:
        return moving_law
    if w.program is ProgramState.RUNNING:
        w.brake = False
        return Law.FOLLOW
    if w.jogging:
        w.brake = False
        return Law.FOLLOW
    w.brake = w.brake and not _static(w, t, s)
    return Law.BRAKE if w.brake else Law.HOLD


def _end(w: World, t: int, present: bool, cool: bool) -> None:
    if w.phase is Phase.SEQUENCE and w.since < t:
        w.brake = True
    w.phase = Phase.OFF
    w.blocked = present
    if cool:
        w.cool_from = t


def _stop(w: World, t: int, safety: Safety, static: bool, category: int = 2) -> None:
    if not w.unmeasured and w.category == 2:
        w.stopped_at, w.unmeasured = t, not static
    w.category = min(w.category, category)
    if w.category == 0 or (w.category == 1 and static):
        w.off_from = min(w.off_from, t)
    w.mode = Mode.STOP
    w.safety = Safety(max(w.safety, safety))
    w.brake = True
    if w.loaded:
        w.program = ProgramState.STOPPED


def _tick(w: World, t: int, i: Step, s: Settings, kinds: list[Kind]) -> None:
    # what is true now
    was_present = w.present_at == t - 1
    if i.held:
        w.refreshed = t
    if i.released:
        w.let_go = t
    present = w.let_go < w.refreshed and t - w.refreshed <= _n(s.hold.silence)
    if was_present and not present and not i.released:
        kinds.append(Kind.HOLD_SILENT)
    if present:
        w.present_at = t
    if t - w.present_at >= 100:
        w.blocked = False
    w.forces = [*w.forces[-49:], i.force] if i.wrench else []
    if not i.joints or not abs(i.qd) < s.static.speed:
        w.fast_at = t
    static = _static(w, t, s)
    if w.category == 1 and t > w.stopped_at and (static or t - w.stopped_at >= 500):
        w.off_from = min(w.off_from, t)
    if w.unmeasured and (static or not i.joints):
        w.unmeasured = False
        if i.joints:
            kinds.append(Kind.STOPPED)
    pressed = present and not was_present
    let_go = was_present and not present

    _safety(w, t, i, static, present, kinds)
    _modes(w, t, i, present, kinds)
    _programs(w, t, i, s, static, present, kinds)
    _free(w, t, i, s, present, pressed, let_go, static, kinds)
    if Command.DETECTION in i.commands:
        kinds.append(Kind.SETTING_CHANGED)


def _safety(w: World, t: int, i: Step, static: bool, present: bool, kinds: list[Kind]) -> None:
    if Command.SAFEGUARD_OPEN in i.commands and not w.safeguard:
        kinds.append(Kind.SAFEGUARD_STOP)
        w.safeguard = True
        if w.phase is not Phase.OFF:
            _end(w, t, present, cool=True)
        _stop(w, t, Safety.SAFEGUARD_STOP, static)
    elif Command.SAFEGUARD_CLOSED in i.commands and Command.SAFEGUARD_OPEN not in i.commands and w.safeguard:
        kinds.append(Kind.SAFEGUARD_CLOSED)
        w.safeguard = False
    reduced = Command.REDUCED_ON in i.commands or (w.reduced and Command.REDUCED_OFF not in i.commands)
    if reduced != w.reduced:
        kinds.append(Kind.REDUCED_ON if reduced else Kind.REDUCED_OFF)
        w.reduced = reduced
    calm = Safety.REDUCED if w.reduced else Safety.NORMAL
    if w.safety in (Safety.NORMAL, Safety.REDUCED):
        w.safety = calm
    if Command.EMERGENCY_STOP in i.commands and w.safety is not Safety.EMERGENCY_STOP:
        kinds.append(Kind.EMERGENCY_STOP)
        if w.phase is not Phase.OFF:
            _end(w, t, present, cool=True)
        _stop(w, t, Safety.EMERGENCY_STOP, static, 1)
    elif (
        Command.EMERGENCY_STOP_RELEASED in i.commands
        and Command.EMERGENCY_STOP not in i.commands
        and w.safety is Safety.EMERGENCY_STOP
    ):
        kinds.append(Kind.EMERGENCY_STOP_RELEASED)
        w.safety = Safety.SAFEGUARD_STOP if w.safeguard else calm
    if Command.PROTECTIVE_STOP in i.commands and w.safety not in (Safety.PROTECTIVE_STOP, Safety.EMERGENCY_STOP):
        kinds.append(Kind.PROTECTIVE_STOP)
        if w.phase is not Phase.OFF:
            _end(w, t, present, cool=True)
        _stop(w, t, Safety.PROTECTIVE_STOP, static)
    if Command.POWER_OFF in i.commands and w.off_from > t:
        kinds.append(Kind.POWERED_OFF)
        if w.phase is not Phase.OFF:
            _end(w, t, present, cool=True)
        _stop(w, t, Safety.NORMAL, static, 1)
    if Command.RESET in i.commands:
        rows = [
            (Command.EMERGENCY_STOP in i.commands, Kind.COMMAND_REFUSED),
            (w.mode is not Mode.STOP, Kind.COMMAND_REFUSED),
            (present, Kind.RESET_REFUSED_SIGNAL),
            (w.safeguard, Kind.RESET_REFUSED_SAFEGUARD),
            (not i.joints, Kind.RESET_REFUSED_SENSORS),
            (not static, Kind.RESET_REFUSED_MOVING),
            (True, Kind.RESET),
        ]
        kind = next(kind for condition, kind in rows if condition)
        kinds.append(kind)
        if kind is Kind.RESET:
            w.mode, w.safety, w.brake = Mode.TEACH, calm, False
            w.category, w.unmeasured, w.off_from = 2, False, inf


def _modes(w: World, t: int, i: Step, present: bool, kinds: list[Kind]) -> None:
    w.anew = w.registered = False
    for command in i.commands:
        if command is Command.LEAVE_FREE_DRIVE and w.phase is not Phase.OFF:
            kinds.append(Kind.DEACTIVATED)
            _end(w, t, present, cool=False)
            if w.mode is Mode.FREE_DRIVE:
                w.mode, w.brake = w.back, True
        if command is Command.REGISTER_WAYPOINT:
            w.registered = True
            kinds.append(Kind.WAYPOINT)
        elif command is Command.RESTART_PERIOD:
            w.anew = w.phase in (Phase.PERIOD, Phase.RESTART)
            if not w.anew:
                kinds.append(Kind.COMMAND_REFUSED)
        if command in (Command.NORMAL, Command.TEACH, Command.REMOTE):
            to = Mode(command.value.upper())
            if w.mode in (Mode.RUN, Mode.FREE_DRIVE, Mode.STOP):
                kinds.append(Kind.COMMAND_REFUSED)
            elif w.mode is not to:
                kinds.append(Kind.MODE_CHANGED)
                w.mode = to


def _load(w: World, i: Step, kinds: list[Kind]) -> None:
    if i.load is not None:
        if w.mode in (Mode.RUN, Mode.FREE_DRIVE) or i.load is WRONG:
            kinds.append(Kind.PROGRAM_REFUSED)
        else:
            kinds.append(Kind.PROGRAM_LOADED)
            w.loaded, w.program = True, ProgramState.STOPPED


def _jog(w: World, t: int, i: Step, s: Settings, static: bool, kinds: list[Kind]) -> None:
    """In TEACH and NORMAL, free-drive off, the arm moves while a jog button is held; what ends that needs a new press, or another
    button, and five angles are no posture of six joints."""
    if i.jog:
        w.jog_refreshed = t
    if i.jog_released:
        w.jog_let_go = t
    held = w.jog_let_go < w.jog_refreshed and t - w.jog_refreshed <= _n(s.hold.silence)
    may = w.mode in (Mode.NORMAL, Mode.TEACH) and w.phase is Phase.OFF and i.joints
    other = i.jog is not None and i.jog != w.jog_asked
    if w.jogging and (not held or other or i.done or i.cannot or not may):
        kinds.append(Kind.JOG_ENDED)
        w.jogging, w.jog_spent, w.brake = False, True, True
    if held and other:
        w.jog_asked, w.jog_spent = i.jog, False
    if held and not w.jogging and not w.jog_spent:
        w.jog_spent = not may or w.jog_asked is UNFIT
        if w.jog_spent:
            kinds.append(Kind.JOG_REFUSED)
        elif static:
            kinds.append(Kind.JOG_STARTED)
            w.jogging = True
    if not held:
        w.jog_asked = None


def _programs(w: World, t: int, i: Step, s: Settings, static: bool, present: bool, kinds: list[Kind]) -> None:
    _load(w, i, kinds)
    running_before = w.program is ProgramState.RUNNING
    fresh = False
    for command in i.commands:
        runs, pauses = w.program is ProgramState.RUNNING, w.program is ProgramState.PAUSED
        free_to_start = w.phase is not Phase.SEQUENCE
        can = {
            Command.START_PROGRAM: w.mode in (Mode.NORMAL, Mode.TEACH) and w.loaded and static and i.joints and free_to_start,
            Command.START_REMOTELY: w.mode is Mode.REMOTE and w.loaded and static and i.joints and free_to_start,
            Command.PAUSE_PROGRAM: w.mode is Mode.RUN and runs,
            Command.RESUME_PROGRAM: w.mode is Mode.RUN and pauses and static and i.joints and free_to_start,
            Command.STOP_PROGRAM: w.mode is Mode.RUN,
        }
        if command not in can:
            continue
        if not can[command]:
            kinds.append(Kind.COMMAND_REFUSED)
        elif command in (Command.START_PROGRAM, Command.START_REMOTELY):
            kinds.append(Kind.PROGRAM_STARTED)
            w.origin, w.mode, w.program, w.at, fresh = w.mode, Mode.RUN, ProgramState.RUNNING, 1, True
        elif command is Command.PAUSE_PROGRAM:
            kinds.append(Kind.PROGRAM_PAUSED)
            w.program, w.brake = ProgramState.PAUSED, True
        elif command is Command.RESUME_PROGRAM:
            kinds.append(Kind.PROGRAM_RESUMED)
            w.program, fresh = ProgramState.RUNNING, True
        else:
            kinds.append(Kind.PROGRAM_STOPPED)
            w.mode, w.program, w.brake = w.origin, ProgramState.STOPPED, True
    _jog(w, t, i, s, static, kinds)
    if not running_before or fresh or w.program is not ProgramState.RUNNING:
        return
    if not i.joints:
        kinds.append(Kind.RUN_SENSORS_LOST)
        if w.phase is not Phase.OFF:
            _end(w, t, present, cool=True)
        _stop(w, t, Safety.PROTECTIVE_STOP, static, 0)
    elif i.cannot:
        kinds.append(Kind.PROGRAM_FAILED)
        w.mode, w.program, w.brake = w.origin, ProgramState.STOPPED, True
    elif i.done:
        w.at += 1
        if w.at > 2:
            kinds.append(Kind.PROGRAM_FINISHED)
            w.mode, w.program = w.origin, ProgramState.STOPPED


def _free(
    w: World, t: int, i: Step, s: Settings, present: bool, pressed: bool, let_go: bool, static: bool, kinds: list[Kind]
) -> None:
    allowed = s.free_drive.allowed_from
    by_teach = allowed.teach and allowed.teach_first
    may = {Mode.TEACH: allowed.teach, Mode.NORMAL: allowed.normal or by_teach, Mode.RUN: allowed.run}.get(w.mode, False)
    cooling = t - w.cool_from < _n(s.free_drive.cool_down)
    if s.sequence.stored:
        _keep(w, t, i)
    if w.phase is Phase.OFF and present:
        if cooling or w.blocked:
            if pressed:
                kinds.append(Kind.NOT_YET)
            return
        if may:
            kinds.append(Kind.ACTIVATION_STARTED)
            w.phase, w.since = Phase.ACTIVATION, t
    if w.phase in (Phase.OFF, Phase.ACTIVATION):
        if not present:
            if w.phase is Phase.ACTIVATION:
                kinds.append(Kind.ACTIVATION_CANCELLED)
                w.phase = Phase.OFF
            return
        if not may:
            kinds.append(Kind.REFUSED_MODE)
            _end(w, t, present, cool=True)
        elif t - w.since == _n(s.activation.period):
            _begin_entry(w, t, i, s, static, kinds)
        return
    if w.phase is Phase.SEQUENCE:
        if not may:
            kinds.append(Kind.REFUSED_MODE)
            _end(w, t, present, cool=True)
        elif _stays(w, t, i, s, present, kinds) and t - w.since == _n(s.sequence.period):
            _enter(w, t, i, present, kinds)
        return
    _stay(w, t, i, s, pressed, let_go, static, kinds)


def _mean(w: World) -> float:
    return sum(w.forces) / len(w.forces) if w.forces else 0.0


def _keep(w: World, t: int, i: Step) -> None:
    """What the arm was like while nobody tried to free it, twenty times a second."""
    if w.phase not in (Phase.OFF, Phase.ACTIVATION) or (w.mode is Mode.RUN and w.fast_at == t):
        w.kept = []
    elif w.phase is Phase.OFF and (not w.kept or t >= w.kept[-1][0] + 25):
        if w.kept and w.kept[-1][3] != i.wrench:
            w.kept = []
        w.kept = [*w.kept, (t, _mean(w), i.tau, i.wrench)] if i.joints else []


def _begin_entry(w: World, t: int, i: Step, s: Settings, static: bool, kinds: list[Kind]) -> None:
    if not i.joints or not static:
        kinds.append(Kind.REFUSED_MOVING if i.joints else Kind.REFUSED_SENSORS)
        _end(w, t, True, cool=True)
        return
    old = [item for item in w.kept if _n(s.sequence.age) <= t - item[0] <= 15 * 500 + 25 and item[3] == i.wrench]
    w.compared = old[-1] if old and s.sequence.stored else None
    if s.sequence.on and (s.sequence.stored or s.sequence.period < 0.25) and w.compared is None:
        kinds.append(Kind.REFUSED_NOT_STORED if s.sequence.stored else Kind.REFUSED_SHORT)
        _end(w, t, True, cool=True)
    elif s.sequence.on:
        _teach(w, s, kinds)
        kinds.append(Kind.SEQUENCE_STARTED)
        w.phase, w.since, w.tried = Phase.SEQUENCE, t, i.wrench
        if w.program is ProgramState.RUNNING:
            kinds.append(Kind.PROGRAM_PAUSED)
            w.program, w.brake = ProgramState.PAUSED, True
        if _stays(w, t, i, s, True, kinds) and s.sequence.period == 0.0:
            _enter(w, t, i, True, kinds)
    else:
        _teach(w, s, kinds)
        _enter(w, t, i, True, kinds)


def _teach(w: World, s: Settings, kinds: list[Kind]) -> None:
    """To TEACH first, if that is asked for: a program is given up."""
    allowed = s.free_drive.allowed_from
    if w.mode is Mode.TEACH or not (allowed.teach and allowed.teach_first):
        return
    kinds.append(Kind.TEACH_FIRST)
    if w.mode is Mode.RUN:
        kinds.append(Kind.PROGRAM_STOPPED)
        w.program, w.brake = ProgramState.STOPPED, False
    w.mode = Mode.TEACH


def _stays(w: World, t: int, i: Step, s: Settings, present: bool, kinds: list[Kind]) -> bool:
    """The sequence goes on."""
    limits = s.limits.activation
    if not i.joints or (w.tried and not i.wrench):
        kinds.append(Kind.REFUSED_SENSORS)
        _end(w, t, present, cool=True)
        return False
    beyond = [
        abs(i.qd) > limits.joint_speed.max,
        abs(i.tau) > 100.0 * limits.joint_torque.max,
        w.tried and abs(_mean(w)) > limits.user_force.max,
    ]
    if w.compared is not None:
        _, force, torque, _ = w.compared
        beyond.append(abs(i.tau - torque) > 100.0 * limits.joint_torque.max)
        beyond.append(w.tried and abs(_mean(w) - force) > limits.user_force.max)
    if any(beyond):
        stop = s.sequence.beyond_limit == "protective_stop"
        kinds += [Kind.ENTRY_PREVENTED] * sum(beyond) + [Kind.SEQUENCE_STOPPED if stop else Kind.REFUSED_LIMIT]
        _end(w, t, present, cool=True)
        if stop:
            _stop(w, t, Safety.PROTECTIVE_STOP, _static(w, t, s))
    return not any(beyond)


def _enter(w: World, t: int, i: Step, present: bool, kinds: list[Kind]) -> None:
    kinds.append(Kind.ENTERED)
    w.back = w.mode
    if w.program is ProgramState.RUNNING:
        kinds.append(Kind.PROGRAM_PAUSED)
        w.program = ProgramState.PAUSED
    phase = Phase.HELD if present else Phase.PERIOD
    w.mode, w.phase, w.since, w.entering_press, w.wrench = Mode.FREE_DRIVE, phase, t, True, i.wrench
    w.force0, w.tau0 = i.force, i.tau


def _leave(w: World, t: int, kind: Kind, present: bool, kinds: list[Kind]) -> None:
    kinds.append(kind)
    _end(w, t, present, cool=True)
    w.mode, w.brake = w.back, True


def _stay(w: World, t: int, i: Step, s: Settings, pressed: bool, let_go: bool, static: bool, kinds: list[Kind]) -> None:
    present = w.present_at == t
    if not i.joints:
        kinds.append(Kind.SENSORS_LOST)
        _end(w, t, present, cool=True)
        _stop(w, t, Safety.NORMAL, static)
        return
    if w.wrench and not i.wrench:
        kinds.append(Kind.WRENCH_LOST)
        _end(w, t, present, cool=True)
        _stop(w, t, Safety.NORMAL, static)
        return

    def begin(phase: Phase) -> None:
        w.phase, w.since, w.force0, w.tau0 = phase, t, i.force, i.tau

    age = t - w.since
    guided = (
        (w.wrench and abs(i.force - w.force0) > s.limits.maintain.user_force.max)
        or abs(i.tau - w.tau0) > s.limits.maintain.joint_torque.max
        or abs(i.qd) > s.limits.maintain.joint_speed.max
    )
    if w.phase is Phase.HELD:
        if let_go and s.button.hold_to_run:
            _leave(w, t, Kind.LEFT_RELEASE, present, kinds)
        elif let_go and not w.entering_press and age < _n(s.button.short_press):
            _leave(w, t, Kind.LEFT_PRESS, present, kinds)
        elif let_go:
            begin(Phase.PERIOD)
    elif pressed:
        w.phase, w.since, w.entering_press = Phase.HELD, t, False
    elif w.phase is Phase.GUIDED:
        if age >= _n(s.static.time) and static:
            kinds.append(Kind.RESTARTED)
            begin(Phase.RESTART)
    elif w.anew:
        kinds.append(Kind.PERIOD_ANEW)
        begin(w.phase)
    elif guided or w.registered:
        kinds += [Kind.MANIPULATION] if guided else []
        w.phase, w.since = Phase.GUIDED, t
    else:
        first = w.phase is Phase.PERIOD
        if age == _n(s.free_drive.period if first else s.free_drive.restart_period):
            _leave(w, t, Kind.LEFT_PERIOD if first else Kind.LEFT_RESTART, present, kinds)


def agree(stream: list[Step], settings: Settings) -> list[Seen]:
    """Run both, compare every tick, return what was seen."""
    return _compare(stream, drive(Supervisor(settings, 6), stream), follow(stream, settings))


class Agreement:
    """The same of many streams that begin differently and go on alike, in some ways.

    Args:
        settings: of all of them.
        afters: the ways in which each goes on.
    """

    def __init__(self, settings: Settings, *afters: list[Step]) -> None:
        self._afters = afters
        self._driven = _GoneOn(lambda: Driver(Supervisor(settings, 6)), afters)
        self._followed = _GoneOn(lambda: Follower(settings), afters)

    def agree(self, stream: list[Step]) -> None:
        """Run both with `stream` and what comes after, in each way; compare every tick."""
        driven, followed = self._driven.all_of(stream), self._followed.all_of(stream)
        for after, seen, asked in zip(self._afters, driven, followed, strict=True):
            _compare([*stream, *after], seen, asked)


class _GoneOn:
    """What one of a kind does with streams and what comes after.

    In a state in which one has gone on before, another goes on the same (`Supervisor.state`): it is not asked twice.
    """

    def __init__(self, make: Callable[[], Driver | Follower], afters: tuple[list[Step], ...]) -> None:
        self._make, self._afters = make, afters
        self._known: list[tuple[tuple[object, ...], list[list[Seen]]]] = []

    def all_of(self, stream: list[Step]) -> list[list[Seen]]:
        """What is seen of it with `stream` and each way to go on."""
        one = self._make()
        seen = one.go(stream)
        state = one.state
        known = next((later for before, later in self._known if before == state), None)
        if known is None:
            first, *others = self._afters
            known = [one.go(first), *[self._anew(stream).go(after) for after in others]]
            self._known.append((state, known))
        return [seen + later for later in known]

    def _anew(self, stream: list[Step]) -> Driver | Follower:
        one = self._make()
        one.go(stream)
        return one


def _compare(stream: list[Step], seen: list[Seen], asked: list[Seen]) -> list[Seen]:
    if seen != asked:
        for tick, (has, should) in enumerate(zip(seen, asked, strict=True)):
            assert has == should, f"tick {tick}: {has}, should be {should}, after {stream[max(0, tick - 3) : tick + 1]}"
    return seen


def ticks_of(count: int, **values: object) -> list[Step]:
    """`count` ticks of the same step."""
    return [replace(Step(), **values)] * count  # type: ignore[arg-type]
