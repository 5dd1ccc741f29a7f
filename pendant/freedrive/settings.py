"""The settings of free-drive: its activation, its sequence, its periods, and the devices that ask for it."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import choice as _choice
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch
from pendant.tick.words import Word


class BeyondLimit(Word):
    """What follows when a limit of the activation sequence is exceeded (FD-10)."""

    REFUSE = "refuse"  # the arm is held again
    BALANCE = "balance"  # what it carries is balanced until it stands, then it is held
    PROTECTIVE_STOP = "protective_stop"


class RestartBegins(Word):
    """When the restart period begins (FD-15)."""

    STANDSTILL = "standstill"  # the guided arm stands still
    MANIPULATION = "manipulation"  # again with each tick of it
    FORCE_ENDS = "force_ends"  # the hand's force ends, whether the arm moves or not


class ActivationSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """From the signal to entry."""

    BASIC = ("period",)

    period: Annotated[
        float, _number(0.0, 15.0, "s", "FD-7", text="time for which the signal must be present without a break")
    ] = 1.0
    sum_presences: Annotated[bool, _switch("FD-7", "the times of presence add up; a gap of up to 1 s does not reset them")] = (
        False
    )


class SequenceDynamic(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What lowers the limits of the activation sequence, by the shares of `Soft`."""

    acceleration: Annotated[bool, _switch("FD-12b", "its displacements and allowed times decrease with acceleration")] = False
    payload: Annotated[bool, _switch("FD-12b", "its speeds and accelerations decrease with the payload")] = False
    drift: Annotated[bool, _switch("FD-12b", "its speeds decrease while the arm creeps in one direction")] = False
    pushed: Annotated[bool, _switch("FD-12b", "its speeds and accelerations decrease with the user's force or torque")] = False
    vertical: Annotated[bool, _switch("FD-12b", "its displacements, speeds and accelerations are smaller along gravity")] = False


class SequenceSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The activation sequence, in which the arm is freed to see whether it stays."""

    BASIC = ("on", "period", "beyond_limit")

    on: Annotated[bool, _switch("FD-24", "free-drive begins with an activation sequence")] = True
    period: Annotated[float, _number(0.0, 5.0, "s", "FD-9", text="time for which the freed arm must stay within its limits")] = (
        1.0
    )
    stored: Annotated[bool, _switch("FD-9", "the freed arm is also compared with its state of some time ago")] = False
    age: Annotated[float, _number(0.5, 15.0, "s", "FD-9", text="age of the state that the freed arm is compared with")] = 2.0
    amplified: Annotated[bool, _switch("FD-9", "the user's force is amplified in the activation sequence already")] = False
    beyond_limit: Annotated[BeyondLimit, _choice("FD-10", "what follows when a limit of the activation sequence is exceeded")] = (
        BeyondLimit.REFUSE
    )
    dynamic: SequenceDynamic = SequenceDynamic()


class Origins(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Modes from which free-drive can be entered."""

    BASIC = ("normal", "teach", "run")

    normal: Annotated[bool, _switch("FD-1", "free-drive can be entered from NORMAL")] = False
    teach: Annotated[bool, _switch("FD-1", "free-drive can be entered from TEACH")] = True
    run: Annotated[bool, _switch("FD-1", "free-drive can be entered from RUN, which it pauses")] = False
    teach_first: Annotated[bool, _switch("FD-1", "activation in NORMAL or RUN switches to TEACH, where it leads back to")] = False


class FreeDriveSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Free-drive itself."""

    BASIC = ("period", "restart_period", "restart_begins", "gain", "force_cap")

    allowed_from: Origins = Origins()
    period: Annotated[
        float,
        _number(0.5, 30.0, "s", "FD-14", text="free-drive ends when nobody moves the arm for this time", locked=False),
    ] = 3.0
    restart_period: Annotated[
        float,
        _number(0.5, 30.0, "s", "FD-15", text="free-drive ends when a guided arm stands still for this time", locked=False),
    ] = 3.0
    restart_begins: Annotated[RestartBegins, _choice("FD-15", "when the restart period begins")] = RestartBegins.STANDSTILL
    signal_renews: Annotated[bool, _switch("FD-16", "a signal starts the running period again")] = True
    longest: Annotated[
        float, _number(0.5, 30.0, "s", "FD-16", text="upper limit of the free-drive period and of the restart period")
    ] = 30.0
    ends_by_period: Annotated[bool, _switch("FD-24", "free-drive ends when nobody moves the arm for its periods")] = True
    remainders: Annotated[bool, _switch("FD-20", "the time that is left of each period is published")] = True
    way_back: Annotated[bool, _switch("FD-22", "the way back to the posture at activation is shown")] = True
    cool_down: Annotated[
        float, _number(0.0, 30.0, "s", "FD-12c", text="time after a refusal or an end in which no signal counts")
    ] = 2.0
    gain: Annotated[float, _number(0.0, 3.0, "", "FD-3", text="factor on the user's force: how much of it is added")] = 1.0
    force_cap: Annotated[float, _number(5.0, 100.0, "N", "FD-3", text="largest force of the user that is amplified")] = 50.0


class HoldSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Held controls."""

    silence: Annotated[
        float, _number(0.1, 1.0, "s", "FD-23", text="a held control that is silent for longer counts as released")
    ] = 0.5


class Enabling(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The three-position enabling device."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-23", "motion needs the enabling device in its middle position")] = False


class ButtonUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The free-drive button."""

    BASIC = ("hold_to_run",)

    short_press: Annotated[
        float, _number(0.1, 2.0, "s", "FD-8a", text="a press of the button that is shorter than this ends free-drive")
    ] = 0.4
    hold_to_run: Annotated[bool, _switch("FD-8a", "free-drive ends when the button is let go")] = False
