"""Programs: their steps, with what each of them may say (CD-15)."""

import math
from enum import StrEnum
from typing import Annotated

import msgspec
from msgspec import Meta

from pendant.program.reaction import Until
from pendant.settings.bounds import MOST_JOINTS, MOST_STEPS, Angle, Coordinate, Text
from pendant.tick.pose import Vector

UNFELT: Vector = (0.0, 0.0, 0.0)

LEAST_FORCE, MOST_FORCE = 1.0, 90.0
"""That a program may push with [N]: beyond the sensor's noise, and within its range."""

Fraction = Annotated[float, Meta(ge=0.001, le=1.0)]


class Move(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """Base of all steps. The sequencer numbers a move whenever it is begun or begun again; files leave `id` out."""

    id: int = 0


class JointMove(Move, tag="joint", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """To joint angles, all joints arriving together, at rest."""

    q: Annotated[tuple[Angle, ...], Meta(max_length=MOST_JOINTS)]  # (n,) output angles [rad]
    speed: Fraction = 0.25  # of each joint's limit
    acceleration: Fraction = 0.25  # of each joint's limit
    until: Until | None = None  # a contact that ends it (CD-15)

    def __post_init__(self) -> None:
        _finite(self.q)


class LinearMove(Move, tag="linear", frozen=True, forbid_unknown_fields=True, kw_only=True):
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


class Wait(Move, tag="wait", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Keep the posture for a time, which the sequencer counts."""

    duration: Annotated[float, Meta(ge=0.0, le=3600.0)]  # [s]

    def __post_init__(self) -> None:
        _finite((self.duration,))


class WaitForContact(Move, tag="wait_for_contact", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Keep the posture until a contact changes (CD-15)."""

    until: Until = Until()


class SwitchTool(Move, tag="tool", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Switch the tool on or off (CD-15)."""

    on: bool


class ApplyForce(Move, tag="force", frozen=True, forbid_unknown_fields=True, kw_only=True):
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


class HandGuide(Move, tag="hand_guide", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The arm is guided by hand, as in free-drive and with its activation; the program goes on when that ends (CD-15)."""


class ZeroSensor(Move, tag="zero", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Zero the flange force/torque sensor, as soon as the arm has stood for a second with nothing touching it."""


AnyStep = JointMove | LinearMove | Wait | WaitForContact | SwitchTool | ApplyForce | HandGuide | ZeroSensor


class Program(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A named list of steps, run once from first to last."""

    name: Text = "program"
    steps: Annotated[tuple[AnyStep, ...], Meta(min_length=1, max_length=MOST_STEPS)]


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
    return None


def _finite(values: tuple[float, ...]) -> None:
    for value in values:
        if not math.isfinite(value):
            raise ValueError(f"{value!r} is not a finite number")
