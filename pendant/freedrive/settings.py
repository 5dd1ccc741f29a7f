"""The settings of free-drive: its activation, its sequence, its periods, and the devices that ask for it."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class ActivationSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """From the signal to entry."""

    period: Annotated[float, _number(0.0, 15.0, "s", "FD-7", text="how long the signal must be present without a break")] = 1.0
    sum_presences: Annotated[bool, _switch("FD-7", "presences add up; a gap up to 1 s does not begin afresh")] = False


class SequenceDynamic(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What lowers the limits of the activation sequence, by the shares of `Soft`."""

    acceleration: Annotated[bool, _switch("FD-12b", "its displacements and allowed times fall with acceleration")] = False
    payload: Annotated[bool, _switch("FD-12b", "its speeds and accelerations fall with the payload")] = False
    drift: Annotated[bool, _switch("FD-12b", "its speeds fall for what creeps on about the same way")] = False
    pushed: Annotated[bool, _switch("FD-12b", "its speeds, accelerations fall with the user's force, torque")] = False
    vertical: Annotated[bool, _switch("FD-12b", "its ways, speeds and accelerations are less along gravity")] = False


class SequenceSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The activation sequence, in which the arm is freed to see whether it stays."""

    on: Annotated[bool, _switch("FD-24", "free-drive begins with an activation sequence")] = True
    period: Annotated[float, _number(0.0, 5.0, "s", "FD-9", text="how long the freed arm must stay within limits")] = 1.0
    stored: Annotated[bool, _switch("FD-9", "it is also compared with its state of some time ago")] = False
    age: Annotated[float, _number(0.5, 15.0, "s", "FD-9", text="how old the state is that it is compared with")] = 2.0
    amplified: Annotated[bool, _switch("FD-9", "the user's force is amplified in it already")] = False
    protective_stop: Annotated[bool, _switch("FD-10", "a limit exceeded in it is a protective stop")] = False
    compensate: Annotated[bool, _switch("FD-10", "beyond a limit the arm is balanced till it stands, then held")] = False
    dynamic: SequenceDynamic = SequenceDynamic()


class Origins(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Modes from which free-drive can be entered."""

    normal: Annotated[bool, _switch("FD-1", "free-drive can be entered from NORMAL")] = False
    teach: Annotated[bool, _switch("FD-1", "free-drive can be entered from TEACH")] = True
    run: Annotated[bool, _switch("FD-1", "free-drive can be entered from RUN, which it pauses")] = False


class FreeDriveSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Free-drive itself."""

    allowed_from: Origins = Origins()
    period: Annotated[float, _number(0.5, 30.0, "s", "FD-14", text="leave when nobody moves it for this long", locked=False)] = (
        3.0
    )
    restart_period: Annotated[
        float, _number(0.5, 30.0, "s", "FD-15", text="leave when a guided arm stands still for this long", locked=False)
    ] = 3.0
    restart_at_manipulation: Annotated[bool, _switch("FD-15", "the restart period begins with each manipulation")] = False
    restart_after_force: Annotated[bool, _switch("FD-15", "it begins when the hand's force ends, moving or not")] = False
    anew: Annotated[bool, _switch("FD-16", "a signal starts the running period again")] = True
    longest: Annotated[float, _number(0.5, 30.0, "s", "FD-16", text="longest that the two periods may be")] = 30.0
    maintained: Annotated[bool, _switch("FD-24", "free-drive ends when nobody moves the arm for its periods")] = True
    remainders: Annotated[bool, _switch("FD-20", "what is left of every period is published")] = True
    way_back: Annotated[bool, _switch("FD-22", "the way back to the posture at activation is told")] = True
    cool_down: Annotated[float, _number(0.0, 30.0, "s", "FD-12c", text="pause after a refusal or a leaving")] = 2.0
    gain: Annotated[float, _number(0.0, 3.0, "", "FD-3", text="factor on the user's force")] = 1.0
    force_cap: Annotated[float, _number(5.0, 100.0, "N", "FD-3", text="largest user force that is amplified")] = 50.0


class HoldSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Held controls."""

    silence: Annotated[float, _number(0.1, 1.0, "s", "FD-23", text="a held control silent for longer counts as released")] = 0.5


class Enabling(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The three-position enabling device."""

    on: Annotated[bool, _switch("FD-23", "motion needs the enabling device in its middle position")] = False


class ReducedLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Safety mode REDUCED."""

    on: Annotated[bool, _switch("FD-1", "REDUCED slows the arm down, and stops a faster one")] = True
    tcp_speed: Annotated[float, _number(0.05, 0.25, "m/s", "FD-1", text="speed of the tool centre point in REDUCED")] = 0.25
    elbow_speed: Annotated[float, _number(0.05, 0.25, "m/s", "FD-1", text="speed of the elbow in REDUCED")] = 0.25
    joint_speed: Annotated[float, _number(0.1, 3.0, "rad/s", "FD-1", text="speed of a joint in REDUCED")] = 1.0
    transition: Annotated[float, _number(0.1, 1.0, "s", "FD-1", text="time to slow down in when REDUCED begins")] = 0.5


class ButtonUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The free-drive button."""

    short_press: Annotated[float, _number(0.1, 2.0, "s", "FD-8a", text="a press shorter than this leaves free-drive")] = 0.4
    hold_to_run: Annotated[bool, _switch("FD-8a", "letting go of the button leaves free-drive")] = False
