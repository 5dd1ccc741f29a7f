"""What a session expects: each expectation is one struct, told apart by `expect`. `expectation_watch` compares them."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from app.session.triggers import After
from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.settings.bounds import Signed, Span, Text, Time
from pendant.tick.modes import Mode, Phase
from sim.arm.scenario import Vector

SafetyName = Literal["NORMAL", "REDUCED", "SAFEGUARD_STOP", "PROTECTIVE_STOP", "EMERGENCY_STOP"]

Quantity = Literal[
    "flange_speed",  # true speed of the flange's point [m/s]
    "tcp_speed",  # as the controller estimates it [m/s]
    "elbow_speed",  # as the controller estimates it [m/s]
    "joint_angle",  # of `joint`, as measured [rad]
    "joint_speed",  # of `joint`, as estimated [rad/s]
    "tracking_error",  # of `joint`, truth scoring: how far its true angle is from the wanted one, 0 in free-drive [rad]
    "friction_error",  # of `joint`, truth scoring: how wrong its friction estimate is, while it moves [N·m]
    "torque_error",  # of `joint`, truth scoring: how wrong the estimate of its transmission torque is [N·m]
    "user_force",  # size of F_user's force, as estimated [N]
    "user_torque",  # size of F_user's torque, as estimated [N·m]
    "payload_configured",  # mass that the controller believes in, beyond the tool [kg]
    "payload_true",  # true mass of what is attached [kg]
]

OF_A_JOINT = ("joint_angle", "joint_speed", "tracking_error", "friction_error", "torque_error")


class Expectation(After, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="expect"):
    """Base of all expectations. With `after`, all their times count from there."""

    why: Text = ""  # where its bounds come from, or why the claim does not depend on them


class During(Expectation, frozen=True, kw_only=True):
    """Base of what is looked at in an interval."""

    begin: Time = msgspec.field(default=0.0, name="from")  # [s]
    end: Span | None = msgspec.field(default=None, name="to")  # None: the session's end [s]

    def __post_init__(self) -> None:
        """Check that the interval has a length."""
        super().__post_init__()
        if self.end is not None and self.end <= self.begin:
            raise ValueError(f"to = {self.end} must come after from = {self.begin}")


class State(Expectation, tag="state", frozen=True, kw_only=True):
    """The robot is in a mode, phase or safety mode: `at` a time, or reached `by` a deadline, or all the time `from` .. `to`."""

    mode: Mode | None = None
    phase: Phase | None = None
    safety: SafetyName | None = None
    at: Time | None = None  # [s]
    by: Span | None = None  # [s]
    begin: Time | None = msgspec.field(default=None, name="from")  # [s]
    end: Span | None = msgspec.field(default=None, name="to")  # [s]

    def __post_init__(self) -> None:
        """Check that there is one thing to see, and one time."""
        super().__post_init__()
        if self.mode is None and self.phase is None and self.safety is None:
            raise ValueError("needs one or more of mode, phase, safety")
        if [self.at, self.by, self.begin].count(None) != 2 or (self.begin is None) != (self.end is None):
            raise ValueError("needs one of `at: SECONDS`, `by: SECONDS`, or `from: SECONDS` with `to: SECONDS`")
        if self.begin is not None and self.end is not None and self.end <= self.begin:
            raise ValueError(f"to = {self.end} must come after from = {self.begin}")


def bounds(least: float | None, most: float | None) -> str:
    """Bounds, in words."""
    low = "" if least is None else f"at least {least:g}"
    high = "" if most is None else f"at most {most:g}"
    return " and ".join(filter(None, (low, high)))


class NumberRange(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where a number lies, its bounds within."""

    min: Signed | None = None
    max: Signed | None = None

    def __post_init__(self) -> None:
        """Check that there are bounds, in order."""
        if self.min is None and self.max is None:
            raise ValueError("needs min, max, or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min = {self.min} must not be above max = {self.max}")

    def holds(self, value: float) -> bool:
        """Whether `value` lies there; what is not a number lies nowhere."""
        return (self.min is None or value >= self.min) and (self.max is None or value <= self.max)

    def words(self) -> str:
        """The bounds, in words."""
        return bounds(self.min, self.max)


class OfEvents(During, frozen=True, kw_only=True):
    """Base of what looks for events of a kind, those alone that carry these words and numbers in these ranges:
    `values: {parameter: flange speed}`, `numbers: {ratio: {max: -0.5}}`.
    """

    kind: Kind
    values: dict[str, str | bool] = msgspec.field(default_factory=dict)
    numbers: dict[str, NumberRange] = msgspec.field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check that events of the kind carry such values."""
        super().__post_init__()
        keys = TABLE[self.kind].keys
        for name in [*self.values, *self.numbers]:
            if name not in keys:
                raise ValueError(f"values: {self.kind.value} carries no {name}; it carries {', '.join(keys) or 'none'}")


class Happens(OfEvents, tag="event", frozen=True, kw_only=True):
    """An event of a kind happens in the interval, at least `times` times, or `exactly` so many."""

    times: Annotated[int, Meta(ge=1)] = 1
    exactly: bool = False


class Never(OfEvents, tag="no_event", frozen=True, kw_only=True):
    """No event of a kind happens in the interval."""


class Heard(During, tag="tone", frozen=True, kw_only=True):
    """A page with sound lets a tone be heard in the interval, after its first tick (app/tones.py): at least `times` times, or
    `exactly` so many.
    """

    tone: Literal["STOP", "ASK", "FREE", "HELD", "SIGN", "WALL", "COUNT"]
    times: Annotated[int, Meta(ge=1)] = 1
    exactly: bool = False


class Bounds(During, frozen=True, kw_only=True):
    """Base of what must stay within bounds."""

    min: Signed | None = None
    max: Signed | None = None

    def __post_init__(self) -> None:
        """Check that there are bounds, in order."""
        super().__post_init__()
        if self.min is None and self.max is None:
            raise ValueError("needs min, max, or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min = {self.min} must not be above max = {self.max}")


class Value(Bounds, tag="value", frozen=True, kw_only=True):
    """A quantity stays within bounds all through the interval."""

    of: Quantity
    joint: str | None = None  # for a quantity of a joint

    def __post_init__(self) -> None:
        """Check that a joint is named where one is needed."""
        super().__post_init__()
        if (self.of in OF_A_JOINT) != (self.joint is not None):
            raise ValueError(f"joint goes with {' and '.join(OF_A_JOINT)}, and only with these; of = {self.of}")


class Reaches(Value, tag="reaches", frozen=True, kw_only=True):
    """A quantity is within bounds in one tick of the interval at least."""


class Displacement(Bounds, tag="displacement", frozen=True, kw_only=True):
    """How far a part is from its place at the interval's begin [m]: the largest in the interval, or what is left at its end."""

    part: str = "flange"
    measure: Literal["largest", "final"] = "largest"
    along: Vector | None = None  # direction in W to count along, with its sign; None: the distance

    def __post_init__(self) -> None:
        """Check the direction."""
        super().__post_init__()
        if self.along is not None and not any(self.along):
            raise ValueError("along = [0, 0, 0] is no direction")


class Period(Expectation, tag="period", frozen=True, kw_only=True):
    """The `run`-th run of a period (FD-20), counted after `after`, lasts `length` within `tolerance`."""

    name: str
    length: Span  # [s]
    tolerance: Time = 0.01  # [s]
    run: Annotated[int, Meta(ge=1)] = 1


class Countdown(During, tag="countdown", frozen=True, kw_only=True):
    """As often as a period is shown in the interval (FD-20), its remainder is the whole period less the time since it began,
    in every tick; and it is not taken away before its end, if it `runs_down`.
    """

    name: str
    runs_down: bool = True


class ContactDelay(During, tag="contact_delay", frozen=True, kw_only=True):
    """The first event of a change in contact comes at most `max` after the true touch of an object, or parting."""

    kind: Kind = Kind.CONTACT_GAINED
    max: Span

    def __post_init__(self) -> None:
        """Check that the kind is one of a touch, or of parting."""
        super().__post_init__()
        if self.kind not in (Kind.CONTACT_GAINED, Kind.CONTACT_LOST, Kind.CONTACT_CLAMPING):
            raise ValueError("kind must be contact_gained, contact_lost or contact_clamping")

    @property
    def gained(self) -> bool:
        """It tells of a touch, not of a parting."""
        return self.kind is not Kind.CONTACT_LOST


class Compared(Bounds, tag="compared", frozen=True, kw_only=True):
    """How large a quantity is in the interval, over what it is in the same session with other `settings`: a ratio."""

    of: Quantity
    joint: str | None = None  # for a quantity of a joint
    measure: Literal["largest", "mean_square"] = "largest"
    settings: dict[str, float | bool | str]  # of the other run, by dotted name

    def __post_init__(self) -> None:
        """Check that a joint is named where one is needed, and that something is different."""
        super().__post_init__()
        if (self.of in OF_A_JOINT) != (self.joint is not None):
            raise ValueError(f"joint goes with {' and '.join(OF_A_JOINT)}, and only with these; of = {self.of}")
        if not self.settings:
            raise ValueError("settings must name what is different in the other run")


AnyExpectation = State | Happens | Never | Heard | Value | Reaches | Displacement | Period | Countdown | ContactDelay | Compared
