"""What a decision tells: every value from its source, and only where it applies."""

from types import SimpleNamespace
from typing import cast

import pytest

from pendant.all_settings import Settings, apply, safety_checksum
from pendant.contact.contact_change import Contact
from pendant.decision import Decision, EstimatorCommand
from pendant.events.event import Event, Kind
from pendant.freedrive.periods import Remaining
from pendant.guided.bias_follower import SURE, Slack
from pendant.haptics import Pattern, Shake
from pendant.limits.axis_locks import axis_locks, locks_of
from pendant.motion.script_requests import Guided
from pendant.motion.scripting import Scripting
from pendant.program.steps import ProgramState, Wait
from pendant.publisher import Publisher
from pendant.robot.robot_mode import Robot
from pendant.safety.robot_limits import JointRange, SpeedLimits
from pendant.sensor.taring import Taring
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tick.pose import from_rpy
from pendant.tooling.tool_in_use import Fitting, Tooling
from pendant.walls.containment import Containment

SETTINGS = apply(Settings(), {"free_drive.gain": 2.5, "free_drive.force_cap": 70.0, "axes.x": False, "program.speed": 0.4})
SPEEDS = SpeedLimits(0.1, 0.2, (0.3,) * 6)
RANGE = JointRange((-1.0,), (2.0,))
SHAKE = Shake(Pattern.ENTERED, 0.001, 0.2, 3.0)
PERIODS = (Remaining("free-drive", 3, 7),)
MOVE = Wait(duration=1.0, id=4)
EVENT = Event(Kind.RESET, 5)
SLACK = Slack(1.5, 0.1)
CONTACT = cast("Contact", "contact")
AXES = (True, False, True, False, False, True)
TURNED = from_rpy(0.1, 0.2, 0.3)
PASSING = {"events": (), "periods": (), "walls": (), "monitored": (), "contacts": ()}


class Parts:
    """What a decision is made of, each value one of its own; those that the publisher must leave out are there as well."""

    def __init__(self, settings: Settings = SETTINGS, /, **changes: object) -> None:
        self.free = SimpleNamespace(
            phase=Phase.HELD, pull="pull",
            arm=SimpleNamespace(damping="damping", singularity="singularity", doubtful="doubtful", slack=SLACK, taken="taken"),
            helping=True, balance="balance",
            baseline=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0), zones=(0.5, 0.6), idle=False,
            periods=lambda: PERIODS, walls=lambda: ("wall",), monitored=lambda: ("monitored",),
        )  # fmt: skip
        self.sequencer = SimpleNamespace(state=ProgramState.PAUSED, index=2, tool_on=True, outputs=frozenset({3}))
        self.robot = SimpleNamespace(
            free=self.free,
            sequencer=self.sequencer,
            move=MOVE,
            mode=Mode.FREE_DRIVE,
            safety=Safety.REDUCED,
            grip="in the middle",
            static=False,
        )
        self.tooling = SimpleNamespace(fitting="fitting", wizard=SimpleNamespace(progress="progress"))
        self.taring = SimpleNamespace(zero=(0.1,) * 6, reading_zero=(0.3,) * 6, due=False)
        self.scripting = SimpleNamespace(guided=None, force="force", offset="offset", done=7)
        self.publisher = Publisher(
            cast("Robot", self.robot),
            cast("Tooling", self.tooling),
            cast("Taring", self.taring),
            scripting=cast("Scripting", self.scripting),
            containment=cast("Containment", SimpleNamespace(workspace=lambda walls: ("workspace", walls))),
        )
        self.publisher.refresh(settings)
        self.settings = settings
        self.set(**changes)

    def set(self, **changes: object) -> None:
        owners = (self.free, self.sequencer, self.robot, self.tooling, self.taring, self.scripting)
        for name, value in changes.items():
            owner = next(one for one in owners if hasattr(one, name))
            setattr(owner, name, value)

    def step(self, *events: Event, contacts: tuple[Contact, ...] = (), looks: bool = False) -> Decision:
        return self.publisher.step(
            Law.FREE, list(events), contacts=contacts, looks=looks, speeds=SPEEDS, joint_range=RANGE, shake=SHAKE
        )

    def ordered(self, unsure: float = 0.5, *, looks: bool = False) -> EstimatorCommand:
        """To the estimator, in free-drive."""
        use, bias = self.settings, self.free.baseline
        fitting, zero = cast("Fitting", "fitting"), (0.1,) * 6
        return EstimatorCommand(fitting, zero, bias, unsure, False, looks, use.joint_control, use.contact)

    def expected(self, **changes: object) -> dict[str, object]:
        """Of a tick of held free-drive."""
        return {
            "mode": Mode.FREE_DRIVE, "safety": Safety.REDUCED, "phase": Phase.HELD, "law": Law.FREE, "move": MOVE, "gain": 2.5,
            "flange_help": True,
            "force_cap": 70.0, "baseline": self.free.baseline, "periods": PERIODS, "events": (), "program": ProgramState.PAUSED,
            "step": 3, "monitored": (), "contacts": (), "tool_on": True, "outputs": frozenset({3}),
            "walls": ("wall",), "grip": "in the middle",
            "workspace": ("workspace", self.settings.walls), "speed_limits": SPEEDS, "joint_range": RANGE,
            "damping": "damping", "zones": (0.5, 0.6), "balance": None,
            "locks": axis_locks(self.settings.axes), "singularity": "singularity", "shake": SHAKE,
            "wizard": "progress", "reading_zero": (0.3,) * 6, "zero_due": False,
            "slack": SLACK, "doubtful": "doubtful",
            "limits": safety_checksum(self.settings), "speed": 0.4, "static": False,
            "force": "force", "offset": "offset", "script_done": 7, "signs": 0, "pull": "pull", "taken": "taken",
            "estimator": self.ordered(),
        } | changes  # fmt: skip


def told(decision: Decision) -> dict[str, object]:
    return {name: getattr(decision, name) for name in decision.__struct_fields__}


UNKNOWN = {"estimator": Parts().ordered(0.0)}
"""The free arm has told no slack."""

TRYING = {"mode": Mode.TEACH, "phase": Phase.SEQUENCE, "arm": None}
TRIED = {
    "mode": Mode.TEACH,
    "phase": Phase.SEQUENCE,
    "damping": None,
    "singularity": None,
    "slack": SURE,
    "doubtful": False,
    "locks": None,
    "taken": None,
    **UNKNOWN,
}


@pytest.mark.parametrize(
    ("changes", "differs"),
    [
        ({}, {}),
        ({"helping": False}, {"gain": 0.0, "flange_help": False}),
        ({"state": ProgramState.RUNNING}, {"program": ProgramState.RUNNING}),
        ({"state": ProgramState.STOPPED}, {"program": ProgramState.STOPPED, "step": 0}),
        ({"arm": None}, {**UNKNOWN, "damping": None, "singularity": None, "slack": SURE, "doubtful": False, "taken": None}),
        ({"idle": True}, {"periods": ()}),
        ({"mode": Mode.RUN}, {"mode": Mode.RUN, "locks": None}),
        ({"guided": Guided()}, {}),
        ({"guided": Guided(axes=AXES, R_BU=TURNED)}, {"locks": locks_of(AXES, TURNED, SETTINGS.axes)}),
        ({"phase": Phase.OFF}, {"phase": Phase.OFF, "walls": ()}),
        (TRYING, {**TRIED, "balance": "balance", "monitored": ("monitored",), "gain": 0.0, "flange_help": False}),
    ],
)
def test_it_tells_what_is_and_where_it_applies(changes: dict[str, object], differs: dict[str, object]) -> None:
    """The locks hold in FREE_DRIVE; balance and monitored values are of the sequence; a program has a step while it runs."""
    parts = Parts(**changes)
    first = parts.step(EVENT, contacts=(CONTACT,))
    assert told(first) == parts.expected(**differs, events=(EVENT,), contacts=(CONTACT,))
    assert told(parts.step()) == parts.expected(**differs)
    again = parts.step(EVENT, contacts=(CONTACT,))
    assert again == first
    assert told(parts.step(looks=True)) == parts.expected(**differs) | {
        "estimator": parts.ordered(first.estimator.unsure, looks=True)
    }


@pytest.mark.parametrize("amplified", [True, False])
@pytest.mark.parametrize("phase", [Phase.SEQUENCE, Phase.HELD])
@pytest.mark.parametrize("balance", [None, "balance"])
def test_in_the_sequence_the_force_is_amplified_where_that_is_set_and_nothing_is_refused(
    amplified: bool, phase: Phase, balance: str | None
) -> None:
    """FD-10: the balance is of the sequence alone."""
    parts = Parts(apply(SETTINGS, {"sequence.amplified": amplified}), phase=phase, balance=balance)
    gain = 2.5 if phase is Phase.HELD or (amplified and balance is None) else 0.0
    trying = {"balance": balance, "monitored": ("monitored",)} if phase is Phase.SEQUENCE else {}
    assert told(parts.step()) == parts.expected(phase=phase, gain=gain, flange_help=gain > 0.0, **trying)


def test_without_the_switch_no_periods_are_told() -> None:
    """FD-20."""
    parts = Parts(apply(SETTINGS, {"free_drive.remainders": False}))
    assert told(parts.step()) == parts.expected(periods=())


LASTING = {
    "mode": Mode.RUN, "safety": Safety.NORMAL, "phase": Phase.PERIOD, "helping": False, "baseline": (0.0,) * 6, "grip": None,
    "arm": SimpleNamespace(damping="other", singularity="other", doubtful="other", slack=Slack(3.0, 0.3), taken="other"),
    "zones": (), "move": None,
    "state": ProgramState.RUNNING,
    "index": 3, "tool_on": False, "outputs": frozenset(), "static": True, "fitting": "other",
    "wizard": SimpleNamespace(progress="other"),
    "zero": (0.2,) * 6, "reading_zero": (0.4,) * 6, "due": True, "pull": "other",
}  # fmt: skip


@pytest.mark.parametrize("name", LASTING)
def test_what_lasts_is_told_anew_when_it_changes(name: str) -> None:
    parts, fresh = Parts(), Parts()
    before = parts.step()
    for one in (parts, fresh):
        one.set(**{name: LASTING[name]})
    assert parts.step() == fresh.step()
    assert parts.step() != before


@pytest.mark.parametrize("passing", [{"events"}, {"contacts"}, {"walls"}, {"monitored"}, {"periods"}, set(PASSING), set()])
def test_what_is_of_a_tick_is_told_in_it_alone(passing: set[str]) -> None:
    """Also after a tick that told nothing, and where it is all that the tick has to tell."""
    parts = Parts(phase=Phase.SEQUENCE)
    sources = {"periods": PERIODS, "walls": ("wall",), "monitored": ("monitored",)}

    def step(names: set[str]) -> Decision:
        parts.set(**{name: (lambda told=value if name in names else (): told) for name, value in sources.items()})
        events, contacts = [EVENT] if "events" in names else [], (CONTACT,) if "contacts" in names else ()
        return parts.step(*events, contacts=contacts)

    whole = {**sources, "events": (EVENT,), "contacts": (CONTACT,)}
    quiet = step(set())
    for names in (passing, passing, set(), set(), passing):
        decision = step(names)
        assert told(decision) == told(quiet) | PASSING | {name: whole[name] for name in names}


def test_new_settings_are_told_from_the_next_decision_on() -> None:
    parts = Parts()
    before = parts.step()
    parts.settings = apply(SETTINGS, {"free_drive.gain": 2.0, "free_drive.force_cap": 60.0, "axes.y": False})
    parts.publisher.refresh(parts.settings)
    after = parts.step()
    assert told(after) == parts.expected(gain=2.0, force_cap=60.0)
    assert (after.locks, after.limits) != (before.locks, before.limits)


def test_without_amplification_the_sensor_helps_all_the_same() -> None:
    """FD-3: gain 0 adds nothing of the user's force; the flange sensor tells on whom friction is taken off."""
    parts = Parts(apply(SETTINGS, {"free_drive.gain": 0.0}))
    assert told(parts.step()) == parts.expected(gain=0.0)


@pytest.mark.parametrize("audible", [True, False])
@pytest.mark.parametrize("tone", [True, False])
def test_what_is_to_be_heard_is_counted(tone: bool, audible: bool) -> None:
    """CD-15: steps that tell the user, and changes in contact; of several in a tick each."""
    parts = Parts(apply(SETTINGS, {"contact.audible": audible}))
    tells = Event(Kind.PROGRAM_TELLS, 5, {"name": "p", "text": "t", "tone": tone})
    assert parts.step(tells, EVENT).signs == tone
    assert parts.step().signs == tone
    assert parts.step(EVENT, contacts=(CONTACT, CONTACT)).signs == tone + 2 * audible
    assert parts.step(tells, tells, contacts=(CONTACT,)).signs == 3 * tone + 3 * audible


@pytest.mark.parametrize("law", [law for law in Law if law is not Law.FREE])
def test_outside_free_drive_the_estimator_is_told_no_bias_and_whether_motion_is_planned(law: Law) -> None:
    parts = Parts()
    decision = parts.publisher.step(law, [], contacts=(), looks=True, speeds=SPEEDS, joint_range=RANGE, shake=SHAKE)
    command = decision.estimator
    assert (command.bias, command.unsure, command.planned) == (None, 0.0, law is Law.FOLLOW)
