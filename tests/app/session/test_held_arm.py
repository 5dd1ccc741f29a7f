"""An arm that something holds, as it was attacked from outside: no stop and no end of a motion makes it leap (RL-1, RL-2)."""

from typing import Any

import pytest

from app.api import run, session
from benchmarks.blocked import FASTER, FURTHER, measure_case
from benchmarks.blocking.motions import Case, Moves, Obstacle, Stop
from pendant.events.event import Kind
from pendant.tick.modes import Safety

SPEEDJ = "def press():\n  speedj([0, 1.0, 0, 0, 0, 0], 5, {:g})\nend\n"
PRESSED = 1.2
"""After this time the tool is on the table, and the arm is held [s]."""


def outcome(title: str, **fields: Any) -> Any:
    """A session without the stop at a collision, which would come before the arm presses."""
    return run(session({"title": title, "robot": "ur5e", "settings": {"collision.on": False}, **fields}))


def stopped_by(outcome: Any) -> list[Kind]:
    return [event.kind for event in outcome.events if event.kind is Kind.PATH_LEFT]


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("pressed", [0.5, 5.0])
def test_an_arm_that_presses_on_a_table_stays_there_when_the_motion_ends(pressed: float, seed: int) -> None:
    rests = {"from": 0.3 + pressed + PRESSED, "to": 0.3 + pressed + 3.0}
    found = outcome(
        "pressed",
        seed=seed,
        duration=pressed + 3.5,
        world="table",
        timeline=[{"at": 0.3, "do": "script", "text": SPEEDJ.format(pressed + 0.5)}],
        expectations=[
            {"expect": "displacement", "part": "flange", "max": 0.005, **rests},
            {"expect": "value", "of": "joint_speed", "joint": "shoulder", "max": 1.2},
        ],
    )
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]
    assert stopped_by(found) == [Kind.PATH_LEFT]


@pytest.mark.parametrize("control", ["protective_stop", "safeguard_open", "emergency_stop", "power_off"])
def test_a_stop_of_an_arm_that_presses_does_not_make_it_leap(control: str) -> None:
    found = outcome(
        "stopped",
        seed=2,
        duration=3.5,
        world="table",
        timeline=[
            {"at": 0.3, "do": "script", "text": SPEEDJ.format(10.0)},
            {"at": 1.3, "do": "tap", "control": control},
        ],
        expectations=[{"expect": "displacement", "part": "flange", "max": 0.005, "from": 1.3, "to": 3.4}],
    )
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]


@pytest.mark.parametrize(
    ("moves", "obstacle", "stop"),
    [
        ("movel", "hand", "dashboard stop"),
        ("program line", "post", "pause"),
        ("program joint", "table", "pendant stop"),
        ("jog line", "table", "release"),
        ("speedl", "hand", "lost"),
        ("servoj", "table", "fault"),
    ],
)
def test_nor_does_any_other_end_of_a_motion(moves: Moves, obstacle: Obstacle, stop: Stop) -> None:
    """Slow motions, which are stopped while the arm still follows (bench `blocked`)."""
    found = measure_case(Case("ur5e", moves, obstacle, stop, 0.3, 0.03, 2e4, 0.5, 11))
    assert found is not None
    assert (found.faster <= FASTER, found.further <= FURTHER) == (True, True), found


def test_a_hand_that_holds_a_moving_arm_and_lets_go_does_not_have_it_thrown() -> None:
    """300 N for 2.5 s; the arm is stopped, and gives way to what is stronger."""
    found = outcome(
        "held by a hand",
        seed=1,
        duration=6.0,
        timeline=[
            {"at": 0.3, "do": "script", "text": "def turn():\n  speedj([0.5, 0, 0, 0, 0, 0], 5, 3)\nend\n"},
            {"at": 0.6, "do": "push", "for": 2.5, "part": "flange", "force": [0.0, 300.0, 0.0]},
        ],
        expectations=[{"expect": "value", "of": "joint_speed", "joint": "base", "max": 3.3}],
    )
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]
    assert stopped_by(found) == [Kind.PATH_LEFT]


def test_torques_of_a_script_are_bounded_and_so_is_the_brake_after_them() -> None:
    found = outcome(
        "a billion newton metres",
        seed=1,
        duration=3.0,
        timeline=[
            {
                "at": 0.3,
                "do": "script",
                "text": "def t():\n  while True:\n    direct_torque([1e9, 0, 0, 0, 0, 0])\n  end\nend\n",
                "trouble": "joint 1 moves",
            }
        ],
        expectations=[
            {"expect": "value", "of": "joint_speed", "joint": "base", "min": -0.3, "max": 3.3},
            {"expect": "value", "of": "joint_speed", "joint": "base", "from": 1.5, "to": 3.0, "min": -0.01, "max": 0.01},
        ],
    )
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]
    assert found.events[-1].kind is not Kind.PATH_LEFT
    assert Safety.PROTECTIVE_STOP not in {event.values.get("safety") for event in found.events}
