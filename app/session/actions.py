"""What a session's time line can do: each action is one struct, told apart by `do`."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from app.session.profiles import AnyProfile, Constant, HalfSine, Ramp
from app.session.triggers import When
from pendant.equipment.load import Angles
from pendant.inputs import Button
from pendant.limits.axis_locks import PRESETS, freeing
from pendant.program.jog_move import Jogged
from pendant.settings.bounds import MOST_WALLS, Extent, Span, Speed, Text
from pendant.settings.bounds import Force as Size
from pendant.walls.definitions import AnyBorder
from sim.arm.scenario import Load, Vector
from sim.plant.changes import AnyChange, DriveGripper
from sim.plant.touch import ZERO, Push, Triple

Control = Literal[
    "free_drive",
    "emergency_stop",
    "emergency_stop_released",
    "protective_stop",
    "power_off",
    "reset",
    "leave_free_drive",
    "normal",
    "teach",
    "remote",
    "restart_period",
    "register_waypoint",
    "detection",
    "enabling_device",
    "enabling_device_full",
    "safeguard_open",
    "safeguard_closed",
    "reduced_on",
    "reduced_off",
    "wizard_measure",
    "wizard_run",
    "wizard_apply",
    "wizard_clear",
    "zero_sensor",
]
# Beyond what a person or a dropped load does to an arm, and still within what the physics can bear.
Force = Annotated[list[Annotated[float, Meta(ge=-2000, le=2000)]], Meta(min_length=3, max_length=3)]  # [N]
Torque = Annotated[list[Annotated[float, Meta(ge=-500, le=500)]], Meta(min_length=3, max_length=3)]  # [N·m]

Walls = Annotated[list[AnyBorder], Meta(max_length=MOST_WALLS)]
Lines = Annotated[list[Text], Meta(max_length=100)]
HOLDABLE = tuple(button.value for button in Button)


class Action(When, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="do"):
    """Base of all actions."""


class Holding(Action, frozen=True, kw_only=True):
    """Base of what is done to a control that is held."""

    control: Control

    def __post_init__(self) -> None:
        """Check that the control can be held."""
        super().__post_init__()
        if self.control not in HOLDABLE:
            text = f'"{self.control}" acts once, so it is used with `do: tap`; held can be {", ".join(HOLDABLE)}'
            raise ValueError(f"control: {text}")


class Press(Holding, tag="press", frozen=True, kw_only=True):
    """A control goes down and stays held, until `release`."""


class Release(Holding, tag="release", frozen=True, kw_only=True):
    """A held control is let go."""


class Tap(Action, tag="tap", frozen=True, kw_only=True):
    """A control is pressed shortly; for a control that acts once, this is how to use it."""

    control: Control
    length: Span = msgspec.field(default=0.2, name="for")  # [s]


class DigitalInput(Action, tag="input", frozen=True, kw_only=True):
    """A digital input changes."""

    input: Annotated[int, Meta(ge=0, le=7)]
    high: bool


class Effort(Action, frozen=True, kw_only=True):
    """Base of what a hand does to a point of the arm for a while."""

    length: Span = msgspec.field(name="for")  # [s]
    part: str = "flange"  # "foot", a joint's link by its joint name, "flange", "tool"
    point: Vector = msgspec.field(default_factory=lambda: [0.0, 0.0, 0.0])  # in the part's frame [m]


class Wrench(Effort, frozen=True, kw_only=True):
    """Base of efforts that are a force or a torque given over time."""

    def push(self, t: float) -> Push:
        """The wrench `t` seconds after the start, 0 <= t <= length."""
        raise NotImplementedError


class Pushing(Wrench, tag="push", frozen=True, kw_only=True):
    """A force on a point, by default all at once."""

    force: Force  # in W [N]
    profile: AnyProfile = Constant()

    def push(self, t: float) -> Push:
        """See `Wrench.push`."""
        return Push(self.part, triple(self.point), triple(self.force, self.profile.factor(t, self.length)))


class Twisting(Wrench, tag="twist", frozen=True, kw_only=True):
    """A torque on a part, by default all at once."""

    torque: Torque  # in W [N·m]
    profile: AnyProfile = Constant()

    def push(self, t: float) -> Push:
        """See `Wrench.push`."""
        return Push(self.part, triple(self.point), ZERO, triple(self.torque, self.profile.factor(t, self.length)))


class Bump(Wrench, tag="bump", frozen=True, kw_only=True):
    """A short knock: half a sine."""

    force: Force  # at its peak, in W [N]

    def push(self, t: float) -> Push:
        """See `Wrench.push`."""
        return Push(self.part, triple(self.point), triple(self.force, HalfSine().factor(t, self.length)))


class Lean(Pushing, tag="lean", frozen=True, kw_only=True):
    """Somebody leans on a point: the force comes and goes slowly."""

    profile: AnyProfile = Ramp(rise=0.5, fall=0.5)


class Hold(Effort, tag="hold", frozen=True, kw_only=True):
    """A hand grabs a point and keeps it where it is, or carries it: a spring and damper, its force capped."""

    carry: Vector = msgspec.field(default_factory=lambda: [0.0, 0.0, 0.0])  # by the end, evenly, in W [m]
    cap: Annotated[float, Meta(ge=0.01, le=2000)] = 50.0  # [N]


class LoadProgram(Action, tag="program", frozen=True, kw_only=True):
    """The session's program is started, paused, resumed or stopped."""

    command: Literal["start", "pause", "resume", "stop"]


class HoldJog(Action, tag="jog", frozen=True, kw_only=True):
    """A jog button is held for a while: `move: {kind: jog, frame: base, axis: 2, sign: -1}`, or of kind `there` or `straight`."""

    length: Span = msgspec.field(name="for")  # [s]
    move: Jogged


class ChangeSettings(Action, tag="settings", frozen=True, kw_only=True):
    """Settings are changed, by dotted name."""

    set: Annotated[dict[str, float | bool | str], Meta(min_length=1)]


class SelectTool(Action, tag="select_tool", frozen=True, kw_only=True):
    """A tool of the table is used from now on: tool centre point and load together, and no payload beyond it."""

    tool: str


class SetPayload(Action, tag="payload", frozen=True, kw_only=True):
    """The payload that the controller is to believe in, beyond the tool, is entered on the pendant."""

    load: Load


class Axes(Action, tag="axes", frozen=True, kw_only=True):
    """Axes of the tool are freed, and the others locked; one of `preset` and `free` says which."""

    preset: Literal["all", "plane", "translation", "rotation"] | None = None
    free: list[Literal["x", "y", "z", "rx", "ry", "rz"]] | None = None
    frame: Literal["base", "tool", "user"] = "base"  # of the tool as it stands then
    rpy: Angles = msgspec.field(default_factory=lambda: [0.0, 0.0, 0.0])  # of the user's frame in the base [rad]

    def __post_init__(self) -> None:
        """Check that it says what is free, once, and that only the user's frame is turned."""
        super().__post_init__()
        if (self.preset is None) == (self.free is None):
            raise ValueError("do: axes wants either `preset` or `free`")
        if self.frame != "user" and any(self.rpy):
            raise ValueError("rpy: turns the user's frame alone, so it wants `frame: user`")

    @property
    def set(self) -> dict[str, float | bool | str]:
        """The changes of settings, by dotted name."""
        free = PRESETS[self.preset] if self.preset is not None else frozenset[str](self.free or ())
        turned = dict(zip(("axes.roll", "axes.pitch", "axes.yaw"), self.rpy, strict=True))
        return {**freeing(free), "axes.frame": "tool" if self.frame == "tool" else "base", **turned}


class SetWalls(Action, tag="walls", frozen=True, kw_only=True):
    """Walls and areas, all of them, from now on; what is not named is deleted."""

    walls: Walls


class Laboratory(Action, tag="change", frozen=True, kw_only=True):
    """The true arm or world is changed: payload, sensors, friction, temperature, objects."""

    change: AnyChange


class UseGripper(Action, tag="gripper", frozen=True, kw_only=True):
    """The gripper is driven, past what is wired to it: `command: close`, or `opening: 0.04`. A cup draws when it closes."""

    command: Literal["close", "open", "stop"] | None = None
    opening: Extent | None = None  # distance of the fingers to go to [m]
    speed: Speed | None = None  # of one finger against the other; None: as before [m/s]
    force: Size | None = None  # of one finger; None: as before [N]

    def __post_init__(self) -> None:
        """Check that it says what to do, and one thing at most where to go."""
        super().__post_init__()
        if self.command is None and self.opening is None and self.speed is None and self.force is None:
            raise ValueError("do: gripper wants `command`, `opening`, `speed` or `force`")
        if self.command is not None and self.opening is not None:
            raise ValueError("do: gripper wants either `command` or `opening`")

    @property
    def change(self) -> DriveGripper:
        """The same as what a laboratory does."""
        return DriveGripper(command=self.command, opening=self.opening, speed=self.speed, force=self.force)


class DashboardLine(Action, tag="dashboard", frozen=True, kw_only=True):
    """A client says a line to the dashboard of the robot, which is in remote control from the start (app/robot_interface)."""

    send: Text
    reply: Text = ""  # how the answer must begin


class ReadField(Action, tag="rtde", frozen=True, kw_only=True):
    """A client reads an output field of RTDE; a value of a vector by its `index`."""

    field: Text
    index: Annotated[int, Meta(ge=0, le=5)] = 0
    min: float | None = None
    max: float | None = None


class AskForFreeDrive(Action, tag="remote_free_drive", frozen=True, kw_only=True):
    """A client asks for free-drive for a while, as it does by its register."""

    length: Span = msgspec.field(name="for")  # [s]


class SendScript(Action, tag="script", frozen=True, kw_only=True):
    """A client sends a program in URScript, which runs in place of the one that runs (docs/guide/scripts.md)."""

    text: Annotated[str, Meta(min_length=1, max_length=100_000)]
    tells: Lines = msgspec.field(default_factory=list)  # how what it says with textmsg must begin, from its first line on
    trouble: Text = ""  # that its error must contain; "": none may end it, and by the end of the session it must be over


OfClient = DashboardLine | ReadField | AskForFreeDrive | SendScript
"""What clients of the network interfaces do, in a session without a network."""

AnyAction = (
    Press
    | Release
    | Tap
    | DigitalInput
    | Pushing
    | Twisting
    | Bump
    | Lean
    | Hold
    | LoadProgram
    | HoldJog
    | ChangeSettings
    | SelectTool
    | SetPayload
    | Axes
    | SetWalls
    | Laboratory
    | UseGripper
    | OfClient
)


def triple(values: list[float], factor: float = 1.0) -> Triple:
    """Three numbers times `factor`, as a touch wants them."""
    x, y, z = values
    return (x * factor, y * factor, z * factor)
