"""What can be asked of the control channel: a struct for each request with a body (docs/reference/control-channel.md)."""

from typing import Annotated

import msgspec
from msgspec import Meta

from app.session.actions import AnyAction
from pendant.settings.bounds import MOST_STEPS

Seconds = Annotated[float, Meta(ge=0.0, le=60.0)]


class Timed(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Actions of a session's time line; `at` counts from the tick after which they were taken."""

    actions: Annotated[list[AnyAction], Meta(min_length=1, max_length=MOST_STEPS)]


class CableFault(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What happens to the network of one interface, or of all."""

    interface: str = "all"
    cut: Seconds | None = None  # all connections end, and none begins for so long [s]
    delay: Annotated[float, Meta(ge=0.0, le=5.0)] | None = None  # of all that is heard from now on [s]


class ClockPace(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How fast simulated time passes."""

    speed: Annotated[float, Meta(ge=0.01, le=1.0)] | None = None  # of the clock's
    paused: bool | None = None
    ticks: Annotated[int, Meta(ge=0, le=500)] = 0  # single ones, while paused


class Switched(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Something is switched on or off."""

    on: bool


class ConveyorSpeed(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A conveyor turns an encoder of the robot from now on."""

    encoder: Annotated[int, Meta(ge=0, le=1)] = 0
    ticks_per_second: Annotated[float, Meta(ge=-1e6, le=1e6)]


class Asked(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The remote controller asks for free-drive for so long; 0 ends it. To go on, ask again before that."""

    seconds: Seconds = 0.5
