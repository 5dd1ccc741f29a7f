"""Robot mode, safety mode, free-drive phase and control law: the words every interface shares (FD-1)."""

from enum import IntEnum

from pendant.tick.words import Word

TICK_RATE = 500
"""Control ticks a second: the rate at which a UR e-Series gives the values of its flange sensor (RTDE, 500 Hz)."""

TICK = 1.0 / TICK_RATE
"""Length of a control tick in s."""


class Mode(Word):
    """Robot mode (FD-1). Exactly one holds."""

    NORMAL = "NORMAL"  # holding still
    TEACH = "TEACH"  # being programmed, holding still
    REMOTE = "REMOTE"  # holding still for a remote controller; refuses the pendant's activation
    RUN = "RUN"  # executing a program
    FREE_DRIVE = "FREE_DRIVE"  # following the user's hand
    STOP = "STOP"  # braked and held; left only by a reset


class Safety(IntEnum):
    """Safety mode (FD-1), a dimension of its own; the order is the severity."""

    NORMAL = 1
    REDUCED = 2
    SAFEGUARD_STOP = 3
    PROTECTIVE_STOP = 4
    EMERGENCY_STOP = 5


class Phase(Word):
    """Where free-drive stands. `OFF` and the phases up to entry leave the robot mode as it is."""

    OFF = "OFF"
    ACTIVATION = "ACTIVATION"  # the signal is present, its period runs (FD-7)
    SEQUENCE = "SEQUENCE"  # the arm is freed, to see whether it stays (FD-9); balanced where it did not (FD-10)
    HELD = "HELD"  # in free-drive, button held: the period is suspended (FD-8a)
    PERIOD = "PERIOD"  # in free-drive, free-drive period runs (FD-14)
    GUIDED = "GUIDED"  # in free-drive, the user moves the arm
    RESTART = "RESTART"  # in free-drive, restart period runs (FD-15)
    FEEDBACK = "FEEDBACK"  # the robot asks for a confirmation (FD-8)
    CONFIRM = "CONFIRM"  # a confirmation counts (FD-8)
    LET_GO = "LET_GO"  # the hand that gave the signal is to leave the arm (FD-8a)
    DELAY = "DELAY"  # the signal is complete; the robot asks for a confirmation in a while (FD-8)


class Law(Word):
    """Which control law the decision asks for."""

    HOLD = "HOLD"  # keep the posture
    BRAKE = "BRAKE"  # come to rest as fast as the limits allow, then keep the posture
    FOLLOW = "FOLLOW"  # track the requested move
    OFF = "OFF"  # no drive power, the brakes hold
    FREE = "FREE"  # free-drive law (FD-2, FD-3); also in the activation sequence, where the mode is still the old one


def way_out(mode: Mode) -> str:
    """What to do first, where `mode` forbids a command."""
    if mode is Mode.STOP:
        return "reset first"
    if mode is Mode.FREE_DRIVE:
        return "leave free-drive first"
    if mode is Mode.RUN:
        return "stop the program first"
    return "switch to NORMAL or TEACH first"
