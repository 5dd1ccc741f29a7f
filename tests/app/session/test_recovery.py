"""After a collision: what clients are told, how it is unlocked, and how the arm gets away from what it touches (RL-3)."""

from typing import Any

import pytest

from app.api import run, session
from pendant.events.event import Kind

DOWN = "def down():\n  p = get_actual_tcp_pose()\n  p[2] = p[2] - 0.6\n  movel(p, a=1, v=0.25)\nend\n"
UP = "def up():\n  p = get_actual_tcp_pose()\n  p[2] = p[2] + 0.1\n  movel(p, a=0.5, v=0.1)\nend\n"
STOPPED, NORMAL = 1 << 2 | 1 << 10, 1 << 0
"""`safety_status_bits` of RTDE: protective stop and stopped for safety; normal."""

PROTECTIVE, IN_NORMAL, RUNNING = 3, 1, 7
"""`safety_mode` and `robot_mode` of RTDE."""

LOCKED = "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop before unlocking"
"""What a UR answers in the first 5 s."""


CRASH = {"at": 0.3, "do": "script", "text": DOWN}
JOGGED = {"at": 0.3, "do": "jog", "for": 2.6, "move": {"kind": "jog", "frame": "base", "axis": 2, "sign": -1}}
"""Into the table, which the tool meets after 2.1 s."""


def outcome(title: str, timeline: list[dict[str, Any]], expectations: list[dict[str, Any]], **fields: Any) -> Any:
    """What becomes of a UR5e over a table."""
    about = {"title": title, "robot": "ur5e", "seed": 4, "world": "table", **fields}
    return run(session({**about, "timeline": timeline, "expectations": expectations}))


def field(at: float, name: str, value: float) -> dict[str, Any]:
    """A client reads this value in a field of RTDE."""
    return {"at": at, "do": "rtde", "field": name, "min": value, "max": value}


def line(at: float, send: str, reply: str) -> dict[str, Any]:
    """A client says a line to the dashboard."""
    return {"at": at, "do": "dashboard", "send": send, "reply": reply}


def test_clients_are_told_and_unlock_it_after_five_seconds_and_drive_on() -> None:
    found = outcome(
        "unlocked by a client",
        [
            CRASH,
            field(3.0, "safety_status_bits", STOPPED),
            field(3.0, "safety_mode", PROTECTIVE),
            field(3.0, "robot_mode", RUNNING),
            line(3.0, "safetymode", "Safetymode: PROTECTIVE_STOP"),
            line(3.1, "safetystatus", "Safetystatus: PROTECTIVE_STOP"),
            line(3.2, "robotmode", "Robotmode: RUNNING"),
            line(3.3, "running", "Program running: false"),
            line(3.4, "unlock protective stop", LOCKED),
            line(3.5, "close safety popup", "closing safety popup"),
            line(8.0, "unlock protective stop", "Protective stop releasing"),
            line(8.5, "safetymode", "Safetymode: NORMAL"),
            field(8.5, "safety_status_bits", NORMAL),
            field(8.5, "safety_mode", IN_NORMAL),
            {"at": 9.0, "do": "script", "text": UP},
        ],
        [
            {"expect": "state", "safety": "PROTECTIVE_STOP", "from": 3.0, "to": 7.9},
            {"expect": "displacement", "part": "flange", "max": 0.002, "from": 3.0, "to": 9.0},
            {"expect": "displacement", "part": "flange", "min": 0.095, "from": 9.0, "to": 11.5},
        ],
        duration=11.5,
    )
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]
    assert sum(event.kind is Kind.COLLISION for event in found.events) == 1


def test_the_arm_is_jogged_off_what_it_still_touches() -> None:
    found = outcome(
        "jogged off",
        [
            JOGGED,
            {"at": 3.0, "do": "tap", "control": "reset"},
            {"at": 3.5, "do": "jog", "for": 1.0, "move": {"kind": "jog", "frame": "base", "axis": 2, "sign": 1}},
        ],
        [
            {"expect": "state", "safety": "NORMAL", "from": 3.1, "to": 5.5},
            {"expect": "displacement", "part": "flange", "min": 0.1, "from": 3.5, "to": 5.4},
        ],
        duration=5.5,
    )
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]
    assert sum(event.kind is Kind.COLLISION for event in found.events) == 1


@pytest.mark.parametrize("seed", [4, 5])
def test_free_drive_does_not_begin_while_something_presses_and_does_once_the_arm_is_off(seed: int) -> None:
    """What presses cannot be told from a wrong payload (FD-9): the arm is jogged off, and then guided."""
    found = outcome(
        "guided off",
        [
            JOGGED,
            {"at": 3.0, "do": "tap", "control": "reset"},
            {"at": 3.5, "do": "press", "control": "free_drive"},
            {"at": 6.5, "do": "release", "control": "free_drive"},
            {"at": 7.0, "do": "jog", "for": 1.0, "move": {"kind": "jog", "frame": "base", "axis": 2, "sign": 1}},
            {"at": 12.0, "do": "press", "control": "free_drive"},
            {"at": 15.0, "do": "push", "for": 1.0, "force": [0.0, 0.0, 30.0]},
        ],
        [
            {"expect": "displacement", "part": "flange", "max": 0.002, "from": 3.5, "to": 7.0},
            {"expect": "event", "kind": "refused_payload", "from": 3.5, "to": 7.0},
            {"expect": "state", "mode": "FREE_DRIVE", "by": 14.9},
            {"expect": "displacement", "part": "flange", "min": 0.05, "from": 15.0, "to": 16.1},
        ],
        duration=16.2,
        seed=seed,
    )
    assert found.passed, ([verdict for verdict in found.verdicts if not verdict.passed], found.events[-6:])
