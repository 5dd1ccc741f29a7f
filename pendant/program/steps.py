"""Programs: their steps, with what each of them may say (CD-15)."""

import math
from enum import StrEnum
from typing import Annotated, Literal, cast

import msgspec
from msgspec import Meta

from pendant.contact.contact_change import ArmPose
from pendant.program.reaction import Until
from pendant.settings.bounds import MOST_JOINTS, MOST_STEPS, Angle, Coordinate, Text
from pendant.tick.pose import Rotation, Vector, product, quaternion

UNFELT: Vector = (0.0, 0.0, 0.0)

LEAST_FORCE, MOST_FORCE = 1.0, 90.0
"""That a program may push with [N]: beyond the sensor's noise, and within its range."""

LINES = 8
"""Digital inputs, and outputs, that a program may name: 0 to 7."""

LineNumber = Annotated[int, Meta(ge=0, le=LINES - 1)]

MOST_RUNS = 1_000_000

SHORTEST_ROUND = 0.1
"""Of a program that repeats, by its waits [s]: nobody could read what a faster one switches."""

Fraction = Annotated[float, Meta(ge=0.001, le=1.0)]


class Move(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """Base of all that moves the arm. The sequencer numbers a move whenever it is begun or begun again; files leave `id` out."""

    id: int = 0


class GentleStop(Move, tag="stop", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Come to rest on the way that the arm is on."""

    of: Literal["joints", "tool"] = "joints"  # whose deceleration it is: of the fastest joint, or of the tool centre point
    deceleration: float = math.inf  # [rad/s²] or [m/s²]; not more than the arm can


class InputLevel(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A digital input, and the level that it should have."""

    input: LineNumber
    high: bool = True

    def holds(self, high: frozenset[int]) -> bool:
        """Whether it has that level, where the inputs in `high` are high."""
        return (self.input in high) is self.high


class ProgramStep(Move, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all steps. One with a condition is left out where that does not hold as it would begin."""

    when: InputLevel | None = None


class JointMove(ProgramStep, tag="joint", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """To joint angles, all joints arriving together, at rest."""

    q: Annotated[tuple[Angle, ...], Meta(max_length=MOST_JOINTS)]  # (n,) output angles [rad]
    speed: Fraction = 0.25  # of each joint's limit
    acceleration: Fraction = 0.25  # of each joint's limit
    until: Until | None = None  # a contact that ends it (CD-15)

    def __post_init__(self) -> None:
        _finite(self.q)


class LinearMove(ProgramStep, tag="linear", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The tool centre point along a straight line in B, to a pose X_BT, at rest."""

    position: tuple[Coordinate, Coordinate, Coordinate]  # p_BT [m]
    quaternion: tuple[float, float, float, float]  # wxyz, orientation of T in B
    speed: Annotated[float, Meta(ge=0.0001, le=3.0)] = 0.1  # [m/s]
    acceleration: Annotated[float, Meta(ge=0.001, le=50.0)] = 0.5  # [m/s²]
    until: Until | None = None  # a contact that ends it (CD-15)

    def __post_init__(self) -> None:
        _finite(self.position + self.quaternion)
        if abs(math.hypot(*self.quaternion) - 1.0) > 1e-3:
            raise ValueError(f"quaternion: its length is {math.hypot(*self.quaternion):.4g}, allowed: 1 (wxyz)")


class ContactMove(ProgramStep, tag="until_contact", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The tool centre point straight along an axis from where it stands, until it meets something (CD-15).

    Contact detection is on for as long as it lasts. Where nothing is met within `distance`, the program ends and says so.
    """

    frame: Literal["base", "tool"] = "base"
    along: Literal["x", "y", "z", "-x", "-y", "-z"] = "-z"  # axis of `frame`
    distance: Annotated[float, Meta(ge=0.001, le=1.0)] = 0.2  # at most [m]
    speed: Annotated[float, Meta(ge=0.001, le=0.25)] = 0.03  # [m/s]
    until: Until = Until(change="gained", then="contact_pose")

    def line(self, now: ArmPose, R_FT: Rotation, number: int) -> LinearMove:
        """The straight line from here, as move `number`.

        Args:
            now: where the arm stands.
            R_FT: orientation of the tool centre point in the flange.
            number: id of the move.
        """
        R = product(now.R_BF, R_FT)
        column, way = "xyz".index(self.along[-1]), -self.distance if self.along[0] == "-" else self.distance
        axis = R[column::3] if self.frame == "tool" else tuple(float(k == column) for k in range(3))
        x, y, z = (p + way * e for p, e in zip(now.p_BT, axis, strict=True))
        return LinearMove(id=number, position=(x, y, z), quaternion=quaternion(R), speed=self.speed, until=self.until)


class Wait(ProgramStep, tag="wait", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Keep the posture for a time, which the sequencer counts."""

    duration: Annotated[float, Meta(ge=0.0, le=3600.0)]  # [s]

    def __post_init__(self) -> None:
        _finite((self.duration,))


class WaitForContact(ProgramStep, tag="wait_for_contact", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Keep the posture until a contact changes (CD-15)."""

    until: Until = Until()


class WaitForInput(ProgramStep, tag="wait_for_input", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Keep the posture until a digital input has a level."""

    level: InputLevel


class SetOutput(ProgramStep, tag="output", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Switch a digital output on or off."""

    output: LineNumber
    on: bool


class SwitchTool(ProgramStep, tag="tool", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Switch the tool on or off (CD-15)."""

    on: bool


class ApplyForce(ProgramStep, tag="force", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Push with a force, going on along it until that is felt, and keep it for a time (CD-15)."""

    force: tuple[float, float, float]  # of the arm on what it touches, axes of B [N]
    duration: Annotated[float, Meta(ge=0.0, le=3600.0)] = 1.0  # that it lasts, once reached [s]
    tolerance: Annotated[float, Meta(ge=0.5, le=50.0)] = 2.0  # within which it counts as reached [N]
    speed: Annotated[float, Meta(ge=0.0001, le=0.1)] = 0.005  # at most [m/s]
    distance: Annotated[float, Meta(ge=0.0001, le=0.5)] = 0.05  # at most; nothing that resists within it: it fails [m]
    untouched: tuple[float, float, float] = UNFELT  # F_user where nothing touches; files leave it out [N]

    def __post_init__(self) -> None:
        _finite(self.force + self.untouched)
        if not LEAST_FORCE <= math.hypot(*self.force) <= MOST_FORCE:
            allowed = f"{LEAST_FORCE:g} .. {MOST_FORCE:g} N"
            raise ValueError(f"force: its size is {math.hypot(*self.force):.4g}, allowed: {allowed}")


class Tell(ProgramStep, tag="tell", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Say a text to the user, and let a tone be heard (CD-15)."""

    text: Text
    tone: bool = True


class HandGuide(ProgramStep, tag="hand_guide", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The arm is guided by hand, as in free-drive and with its activation; the program goes on when that ends (CD-15)."""


class ZeroSensor(ProgramStep, tag="zero", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Zero the flange force/torque sensor, as soon as the arm has stood for a second with nothing touching it."""


class RunScript(ProgramStep, tag="script", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A script says in every tick what the arm shall do; until it says so, the arm stands. It is in no file."""


AnyStep = (
    JointMove
    | LinearMove
    | ContactMove
    | Wait
    | WaitForContact
    | WaitForInput
    | SetOutput
    | SwitchTool
    | ApplyForce
    | Tell
    | HandGuide
    | ZeroSensor
)

INSTANT = (SwitchTool, SetOutput, Tell, WaitForInput)
"""Steps that may take a single tick."""


class Program(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A named list of steps, run from first to last, `repeat` times."""

    name: Text = "program"
    repeat: Annotated[int, Meta(ge=0, le=MOST_RUNS)] = 1  # times; 0: until it is stopped
    steps: Annotated[tuple[AnyStep, ...], Meta(min_length=1, max_length=MOST_STEPS)]


def script_program(name: str) -> Program:
    """The program whose only step is a script."""
    return Program(name=name, steps=cast("tuple[AnyStep, ...]", (RunScript(),)))


def is_script(program: Program) -> bool:
    """A script runs as this program."""
    return any(isinstance(step, RunScript) for step in program.steps)


class ProgramState(StrEnum):
    """What the sequencer does."""

    NONE = "NONE"  # no program loaded
    STOPPED = "STOPPED"
    RUNNING = "RUNNING"
    PAUSED = "PAUSED"


def misfit(program: Program, n_joints: int) -> str | None:
    """Why a program does not fit an arm of `n_joints`, or None."""
    if not program.steps:
        return "the program has no steps"
    for number, step in enumerate(program.steps, 1):
        if isinstance(step, JointMove) and len(step.q) != n_joints:
            return f"step {number} has {len(step.q)} joint angles, the arm has {n_joints} joints"
    if program.repeat != 1 and not any(_lasts(step) for step in program.steps):
        return "a program that repeats needs a step that takes time without a condition: a move, or a wait of 0.1 s"
    return None


def _lasts(step: AnyStep) -> bool:
    """Whether a step takes time whenever it is come to."""
    return step.when is None and not isinstance(step, INSTANT) and (not isinstance(step, Wait) or step.duration >= SHORTEST_ROUND)


def _finite(values: tuple[float, ...]) -> None:
    for value in values:
        if not math.isfinite(value):
            raise ValueError(f"{value!r} is not a finite number")
