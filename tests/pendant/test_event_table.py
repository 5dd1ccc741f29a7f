"""The event table is complete, and its texts fit."""

import string
from itertools import product

from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind, Values
from pendant.events.event_row import LEAVING, Clears, Effect, EventRow, Severity
from pendant.inputs import Command
from pendant.program.rows import COMMANDS
from pendant.tick.modes import Mode
from tests.items import each_of

EXAMPLE: Values = {
    **dict.fromkeys(
        ("force", "acceleration", "ratio", "fx", "fy", "fz", "ax", "ay", "az", "x", "y", "z", "px", "py", "pz"), -123.456
    ),
    **{
        "source": "force and tool-side acceleration",
        "rule": "statistical",
        "steps": 123,
        "action": "contact_pose",
        "state": "off",
        "status": "too near",
    },
    "age": 15.0,
    "position": True,
    "allowed": "TEACH, NORMAL",
    "category": 1,
    "cause": "emergency_stop",
    "command": "resume_program",
    "elbow": 0.25,
    "file": "recording-2026-11-29-183400.mcap",
    "grip": "fully pressed",
    "from": "FREE_DRIVE",
    "gain": 1.0,
    "force": 17.6,
    "torque": 1.23,
    "joint": "shoulder",
    "joint_speed": 1.0,
    "speed": 250.0,
    "joints": "shoulder +12.3°, base -10.4°, wrist_1 +3.2°, wrist_2 +1.1°",
    "late": 123.4,
    "lost": 12.3,
    "often": "7 times in 27 s",
    "change": "long gripper added",
    "count": 5,
    "left": 0.4,
    "limit": 10.0,
    "mass": -1.8,
    "mode": "FREE_DRIVE",
    "moved": 12.3,
    "name": "free_drive.allowed_from.normal",
    "new": True,
    "old": False,
    "parameter": "joint external torque",
    "part": "shoulder",
    "period": 3.0,
    "reason": "switch to NORMAL or TEACH first",
    "remaining": 1.5,
    "sensor": "joint encoders and motor currents",
    "step": 3,
    "tcp": 0.25,
    "steps": 12,
    "time": 0.1,
    "to": "TEACH",
    "unit": "rad/s",
    "value": 12.345,
    "posture": "0.0000 -1.2000 1.5000 -1.8700 -1.5700 0.0000",
    "wall": "step down",
    "feedback": 0.5,
    "window": 10.0,
    "within": 2.0,
    "way": "+x -y -z",
    "distance": 12.34,
    "angle": 46.3,
    "centre_deviation": 1.23,
    "fit": 0.123,
    "mass_deviation": 0.0123,
    "missing": 3,
    "number": 4,
    "postures": 12,
    "text": "Put the next part into the holder",
    "tone": True,
    "tool": "two-finger gripper",
    "total": 2.925,
    "what": "payload of the wizard",
    "zero": False,
}

EFFECTS = {
    Kind.TEACH_FIRST: Effect.TO_TEACH,
    Kind.SEQUENCE_STARTED: Effect.TRY,
    Kind.ENTERED: Effect.ENTER,
    Kind.REFUSED_LIMIT: Effect.NO_ENTRY,
    Kind.REFUSED_PAYLOAD: Effect.NO_ENTRY,
    Kind.REFUSED_WALL: Effect.NO_ENTRY,
    Kind.SEQUENCE_STOPPED: Effect.PROTECTIVE_STOP,
    Kind.REFUSED_MODE: Effect.NO_ENTRY,
    Kind.REFUSED_SENSORS: Effect.NO_ENTRY,
    Kind.REFUSED_CHANGING: Effect.NO_ENTRY,
    Kind.REFUSED_SHORT: Effect.NO_ENTRY,
    Kind.REFUSED_NOT_STORED: Effect.NO_ENTRY,
    Kind.REFUSED_MOVING: Effect.NO_ENTRY,
    Kind.REFUSED_UNCONFIRMED: Effect.NO_ENTRY,
    Kind.REFUSED_STILL_HELD: Effect.NO_ENTRY,
    Kind.LEFT_PERIOD: Effect.LEAVE,
    Kind.LEFT_RESTART: Effect.LEAVE,
    Kind.LEFT_PRESS: Effect.LEAVE,
    Kind.LEFT_RELEASE: Effect.LEAVE,
    Kind.LEFT_LIMIT: Effect.LEAVE,
    Kind.STOPPED_LIMIT: Effect.LEAVE_TO_STOP,
    Kind.STOPPED_MOTION: Effect.LEAVE_TO_STOP,
    Kind.STOPPED_PAYLOAD: Effect.LEAVE_TO_STOP,
    Kind.LEFT_WALL: Effect.LEAVE,
    Kind.STOPPED_WALL: Effect.LEAVE_TO_STOP,
    Kind.DEACTIVATED: Effect.LEAVE,
    Kind.SENSORS_LOST: Effect.LEAVE_TO_STOP,
    Kind.WRENCH_LOST: Effect.LEAVE_TO_STOP,
    Kind.SENSOR_STEPPED: Effect.LEAVE_TO_STOP,
    Kind.SENSOR_DRIFTED: Effect.LEAVE_TO_STOP,
    Kind.RUN_SENSORS_LOST: Effect.PROTECTIVE_STOP,
    Kind.MOTOR_ANGLE_LOST: Effect.PROTECTIVE_STOP,
    Kind.PATH_LEFT: Effect.PROTECTIVE_STOP,
    Kind.COLLISION: Effect.PROTECTIVE_STOP,
    Kind.LIMIT_EXCEEDED: Effect.PROTECTIVE_STOP,
    Kind.EMERGENCY_STOP: Effect.EMERGENCY_STOP,
    Kind.PROTECTIVE_STOP: Effect.PROTECTIVE_STOP,
    Kind.POWERED_OFF: Effect.LEAVE_TO_STOP,
    Kind.SAFEGUARD_STOP: Effect.SAFEGUARD_STOP,
    Kind.REFUSED_ENABLING: Effect.NO_ENTRY,
    Kind.LEFT_ENABLING: Effect.LEAVE,
}
"""All other kinds change nothing."""


def test_every_kind_has_a_row_and_every_row_a_kind() -> None:
    assert set(TABLE) == set(Kind)


def test_effects_are_as_the_spec_says() -> None:
    assert {kind: row.effect for kind, row in TABLE.items()} == {kind: EFFECTS.get(kind, Effect.INFO) for kind in Kind}
    assert set(EFFECTS.values()) | {Effect.INFO} == set(Effect)
    assert {effect for effect in Effect if effect.name.startswith("LEAVE") or effect.name.endswith("STOP")} == LEAVING


def test_refusals_and_leavings_start_the_cool_down_except_the_deactivation_signal() -> None:
    """FD-12c."""
    starting = {kind for kind, row in TABLE.items() if row.cool_down}
    assert starting == {kind for kind, effect in EFFECTS.items() if effect not in (Effect.TO_TEACH, Effect.TRY, Effect.ENTER)} - {
        Kind.DEACTIVATED
    }


def test_what_stops_is_cleared_by_a_reset_alone_and_overridden_by_nobody() -> None:
    stops = {Effect.LEAVE_TO_STOP, Effect.SAFEGUARD_STOP, Effect.PROTECTIVE_STOP, Effect.EMERGENCY_STOP}
    for row in TABLE.values():
        assert (row.clears is Clears.RESET) == (row.effect in stops) == (row.severity is Severity.STOP)


def test_stop_categories_are_those_of_the_robots() -> None:
    """UR5e user manual, 8.2: an emergency stop removes the power at standstill, a safeguard stop leaves it on; beyond the
    limits of REDUCED is category 0."""
    others = {Kind.EMERGENCY_STOP: 1, Kind.POWERED_OFF: 1}
    others |= {Kind.RUN_SENSORS_LOST: 0, Kind.MOTOR_ANGLE_LOST: 0}  # no loop holds such a joint
    assert {kind: row.category for kind, row in TABLE.items()} == {kind: others.get(kind, 2) for kind in Kind}


def test_a_refusal_warns_a_contact_is_noticed_and_no_row_is_without_its_severity() -> None:
    """FD-22, CD-16."""
    for kind, row in TABLE.items():
        assert row.severity in tuple(Severity)
        if row.effect is Effect.NO_ENTRY or "REFUSED" in kind.name:
            assert row.severity is Severity.WARNING, kind
        if kind.name.startswith("CONTACT"):
            assert row.severity is Severity.NOTICE
        if row.effect is Effect.INFO:
            assert row.severity is not Severity.STOP


def test_what_starts_the_cool_down_is_shown_to_its_end_unless_it_stops() -> None:
    """FD-12c, FD-22."""
    for row in TABLE.values():
        if row.cool_down:
            assert row.clears is (Clears.RESET if row.severity is Severity.STOP else Clears.COOL_DOWN)


def test_a_contact_is_told_with_force_rule_and_action() -> None:
    """CD-16."""
    values = {**EXAMPLE, "force": 17.62, "rule": "slow", "steps": 20, "action": "none", "part": "tool"}
    assert render(Event(Kind.CONTACT_GAINED, 0, values)) == (
        "Touched at 18 N: tool",
        "The force changed by 17.6 N, seen by the rule slow. The arm goes on.",
    )


def test_a_refused_command_is_told_in_words() -> None:
    """Every command has its words, and the guidance is a sentence."""
    assert set(COMMANDS) == set(Command)
    values: Values = {"command": Command.START_PROGRAM, "mode": Mode.STOP, "reason": "reset first"}
    assert render(Event(Kind.COMMAND_REFUSED, 0, values)) == ("Starting the program is not possible in STOP", "Reset first.")


def test_severities_are_ordered() -> None:
    assert list(Severity) == [Severity.INFO, Severity.NOTICE, Severity.WARNING, Severity.STOP]
    assert sorted(Severity) == list(Severity)


LOGGED = {
    "tone",
    "steps",
    "source",
    "acceleration",
    "ratio",
    "fx",
    "fy",
    "fz",
    "ax",
    "ay",
    "az",
    "x",
    "y",
    "z",
    "px",
    "py",
    "pz",
    "posture",
}
"""Of a contact: for the log and the page, too many to read (CD-16)."""


def texts(row: EventRow) -> tuple[str, ...]:
    return (row.headline, row.guidance, *(row.variant[1:] if row.variant else ()))


def fields(row: EventRow) -> set[str]:
    return {name for text in texts(row) for _, name, _, _ in string.Formatter().parse(text) if name}


@each_of(Kind)
def test_texts_use_the_declared_values_and_no_others(kind: Kind) -> None:
    row = TABLE[kind]
    assert fields(row) <= set(row.keys)
    chosen = set(row.variant[:1]) if row.variant else set[str]()
    assert chosen <= set(row.keys)
    assert set(row.keys) - fields(row) - chosen <= {"from", "gain", "unit", "parameter", "cause", "joint", "speed"} | LOGGED
    assert len(set(row.keys)) == len(row.keys)


@each_of(product(Kind, [True, False]))
def test_texts_are_short_and_whole(kind: Kind, zero: bool) -> None:
    row = TABLE[kind]
    headline, guidance = render(Event(kind, 0, {key: {**EXAMPLE, "zero": zero}[key] for key in row.keys}))
    assert 3 < len(headline) <= 60, headline
    assert len(guidance) <= 100, guidance
    assert "{" not in headline + guidance
    assert not headline.endswith(".")
    assert guidance == "" or guidance.endswith(".")


@each_of(kind for kind, row in TABLE.items() if row.effect is not Effect.INFO)
def test_whatever_acts_on_the_mode_has_guidance(kind: Kind) -> None:
    """FD-22."""
    assert TABLE[kind].guidance


def test_limits_are_shown_with_numbers_and_units() -> None:
    values: Values = {"parameter": "user force", "part": "flange", "value": 12.34, "limit": 8.0, "unit": "N"}
    assert render(Event(Kind.MANIPULATION, 0, values)) == ("The arm is guided", "User force, flange: 12.34 N, limit 8.00 N.")
    values = {"joint": "elbow", "value": 0.0123, "limit": 0.01, "time": 0.1}
    assert render(Event(Kind.REFUSED_MOVING, 0, values)) == (
        "Free-drive refused: the arm moves",
        "Elbow at 0.012 rad/s, limit 0.010 rad/s for 0.1 s. Hands off, then try again.",
    )
