"""An arm that hits something is stopped as shipped, names the part, and stays there (RL-3)."""

from typing import Any

import pytest

from app.api import run, session
from pendant.events.event import Event, Kind
from pendant.tick.modes import TICK

SPEEDJ = "def press():\n  speedj([0, 1.0, 0, 0, 0, 0], 5, 3)\nend\n"
MOVEL = "def down():\n  p = get_actual_tcp_pose()\n  p[2] = p[2] - 0.6\n  movel(p, a=1, v=0.25)\nend\n"
LIMITS = {"force": 50.0, "clamping": 150.0}


def hits(title: str, **fields: Any) -> tuple[Any, list[Event]]:
    """What became of a session, and its collisions."""
    found = run(session({"title": title, "robot": "ur5e", **fields}))
    return found, [event for event in found.events if event.kind is Kind.COLLISION]


@pytest.mark.parametrize("seed", [2, 3])
@pytest.mark.parametrize(("script", "part"), [(SPEEDJ, "wrist"), (MOVEL, "tool")])
def test_a_script_into_the_table_is_stopped_where_it_meets_it(script: str, part: str, seed: int) -> None:
    """The shoulder's motion brings a wrist to the table first, of which the flange sensor feels nothing."""
    found, stops = hits(
        "table",
        seed=seed,
        duration=5.0,
        world="table",
        timeline=[{"at": 0.3, "do": "script", "text": script}],
        expectations=[{"expect": "displacement", "part": "flange", "max": 0.005, "from": 4.0, "to": 4.9}],
    )
    assert [stop.values["part"] for stop in stops] == [part]
    assert stops[0].values["force"] > LIMITS["force"] == stops[0].values["limit"]
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]
    assert found.events[-1].kind is not Kind.PATH_LEFT


@pytest.mark.parametrize("size", [0.95, 1.05])
def test_a_standing_arm_bears_a_push_up_to_the_clamping_force(size: float) -> None:
    """The flange sensor ends at 100 N an axis, so the push is oblique."""
    force = [0.58 * size * LIMITS["clamping"], 0.58 * size * LIMITS["clamping"], -0.58 * size * LIMITS["clamping"]]
    push = {"at": 1.0, "do": "push", "for": 1.0, "profile": {"shape": "half-sine"}, "part": "flange", "force": force}
    _, stops = hits("pushed", seed=2, duration=3.0, timeline=[push])
    assert bool(stops) is (size > 1.0)


@pytest.mark.parametrize("robot", ["ur3e", "ur5e", "ur10e", "ur16e"])
@pytest.mark.parametrize("size", [250.0, 500.0])
def test_a_hand_that_overpowers_a_standing_arm_is_told_and_does_not_throw_it(robot: str, size: float) -> None:
    """Down on the flange for half a second, which threw the arm at 2.3 and 5.9 m/s before it was stopped."""
    push = {"at": 1.0, "do": "push", "for": 0.5, "part": "flange", "force": [0.0, 0.0, -size]}
    stays = {"expect": "displacement", "part": "flange", "max": 0.005, "from": 2.5, "to": 2.9}
    found, stops = hits("overpowered", robot=robot, seed=2, duration=3.0, timeline=[push], expectations=[stays])
    assert [stop.values["part"] for stop in stops] == ["tool"]
    assert 1.0 <= stops[0].tick * TICK <= 1.1
    assert stops[0].values["limit"] == LIMITS["clamping"]
    assert found.passed, [verdict for verdict in found.verdicts if not verdict.passed]


def test_a_hit_at_the_elbow_names_it() -> None:
    """The forearm begins there, so that it may be named, too."""
    turns = "def turn():\n  speedj([0.5, 0, 0, 0, 0, 0], 5, 3)\nend\n"
    push = {"at": 1.0, "do": "push", "for": 0.5, "part": "elbow", "force": [0.0, 0.0, -200.0]}
    posture = [0.4, -1.0, 1.2, -1.8, -1.57, 0.3]
    _, stops = hits("link", seed=2, duration=2.5, posture=posture, timeline=[{"at": 0.3, "do": "script", "text": turns}, push])
    assert [str(stop.values["part"]).split(" or ")[0] for stop in stops] == ["elbow"]
