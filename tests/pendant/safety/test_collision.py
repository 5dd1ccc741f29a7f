"""An arm that hits something is stopped, in every mode that holds or moves it; what touched it already lets it go (RL-3)."""

import math

import numpy as np
import pytest

from pendant.events.event import Kind, posture_text
from pendant.inputs import Inputs
from pendant.program.jog_move import JogMove
from pendant.safety.collision import BEFORE, HELD_BY, MORE, Collisions
from pendant.safety.settings import CollisionSettings
from pendant.tick.estimate import Estimate, LinkForce
from pendant.tick.modes import Law, Mode, Safety
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
USE = CollisionSettings()
BELOW, ABOVE = 0.95, 1.05


ELBOW, FOREARM, WRIST = (0.95, 0.05, 0.0), (0.0, 1.0, 0.0), (0.01, 0.04, 0.95)
"""Probabilities of elbow, forearm and wrist, of which one is sure."""


def touched(
    tool: float = 0.0,
    link: float = 0.0,
    joint: int = 1,
    parts: tuple[float, float, float] = ELBOW,
    *,
    clipped: bool = False,
    sensed: bool = True,
) -> Estimate:
    """An arm that feels these forces [N] on its tool and on a link, which is most likely that of `parts`."""
    felt = estimate()
    felt.F_user = np.array([0.6 * tool, 0.0, -0.8 * tool, 0.0, 0.0, 0.0])
    felt.link_force, felt.clipped, felt.wrench_valid = LinkForce(joint, link, 0.3 * link, 1, parts), clipped, sensed
    return felt


def hit(felt: Estimate, *, moves: bool = True, use: CollisionSettings = USE) -> Kind | None:
    """What an arm says that felt nothing before."""
    watch = Collisions(JOINTS)
    assert watch.step(touched(), use, moves=moves) is None
    event = watch.step(felt, use, moves=moves)
    return None if event is None else event.kind


@pytest.mark.parametrize(("moves", "limit"), [(True, USE.force), (False, USE.clamping)])
@pytest.mark.parametrize("part", ["tool", "link"])
def test_either_force_has_its_limit(moves: bool, limit: float, part: str) -> None:
    assert hit(touched(**{part: BELOW * limit}), moves=moves) is None
    assert hit(touched(**{part: limit}), moves=moves) is None
    assert hit(touched(**{part: ABOVE * limit}), moves=moves) is Kind.COLLISION
    assert hit(touched(**{part: ABOVE * limit}), moves=moves, use=CollisionSettings(on=False)) is None


def test_what_is_not_a_number_is_a_collision() -> None:
    assert hit(touched(tool=math.nan)) is Kind.COLLISION
    assert hit(touched(link=math.nan)) is Kind.COLLISION
    assert Collisions(JOINTS).step(touched(tool=math.inf), USE, moves=True) is not None


def test_a_flange_sensor_that_is_out_tells_nothing() -> None:
    assert hit(touched(tool=1000.0, sensed=False)) is None


def test_beyond_the_range_of_the_sensor_the_joints_feel_the_rest() -> None:
    assert hit(touched(tool=100.0, link=45.0, clipped=True), moves=False) is None
    assert hit(touched(tool=100.0, link=55.0, clipped=True), moves=False) is Kind.COLLISION
    assert hit(touched(tool=100.0, link=55.0), moves=False) is None


@pytest.mark.parametrize(
    ("felt", "part", "joint", "speed"),
    [
        (touched(tool=80.0), "tool", "wrist_3", 250.0),
        (touched(tool=100.0, link=80.0, joint=4, clipped=True), "tool", "wrist_3", 250.0),
        (touched(link=80.0, joint=0, parts=(0.3, 0.7, 0.0)), "elbow or forearm", "base", 150.0),
        (touched(link=80.0, joint=0, parts=(0.88, 0.12, 0.0)), "elbow or forearm", "base", 150.0),
        (touched(link=80.0, joint=0, parts=(0.92, 0.08, 0.0)), "elbow", "base", 150.0),
        (touched(link=80.0, joint=1), "elbow", "shoulder", 150.0),
        (touched(link=80.0, joint=2, parts=FOREARM), "forearm", "elbow", 150.0),
        (touched(link=80.0, joint=2, parts=(0.05, 0.55, 0.4)), "forearm or wrist", "elbow", 250.0),
        (touched(link=80.0, joint=3, parts=WRIST), "wrist", "wrist_1", 250.0),
        (touched(link=80.0, joint=5, parts=WRIST, sensed=False), "wrist or tool", "wrist_3", 250.0),
        (touched(link=80.0, joint=2, parts=(0.0, 0.6, 0.4), sensed=False), "forearm or wrist or tool", "elbow", 250.0),
        (touched(link=80.0, joint=2, parts=(0.0, 0.0, 0.0)), "arm", "elbow", 250.0),
    ],
)
def test_the_event_tells_with_what_where_how_hard_and_how_fast(felt: Estimate, part: str, joint: str, speed: float) -> None:
    """The contact has braked the arm to a tenth of its speed when its force tells."""
    before = touched()
    before.v_tcp, before.v_elbow = 0.25, 0.15
    felt.v_tcp, felt.v_elbow = 0.025, 0.015
    felt.tcp = np.array([0.4, -0.1, 0.2, 0.0, 0.0, 0.0])
    watch = Collisions(JOINTS)
    for _ in range(10):
        watch.step(before, USE, moves=True)
    event = watch.step(felt, USE, moves=True)
    assert event is not None
    force = 180.0 if felt.clipped else 80.0
    assert event.values == {
        "part": part,
        "joint": joint,
        "force": pytest.approx(force),
        "limit": USE.force,
        "speed": speed,
        **{"x": 0.4, "y": -0.1, "z": 0.2},
        "posture": posture_text(felt.q.tolist()),
    }


def test_a_speed_from_long_before_the_contact_does_not_count() -> None:
    watch, fast, slow = Collisions(JOINTS), touched(), touched(tool=ABOVE * USE.force)
    fast.v_tcp, slow.v_tcp = 0.8, 0.1
    watch.step(fast, USE, moves=True)
    for _ in range(BEFORE):
        watch.step(touched(), USE, moves=True)
    event = watch.step(slow, USE, moves=True)
    assert event is not None
    assert event.values["speed"] == 100.0


@pytest.mark.parametrize(
    ("felt", "part"),
    [
        (touched(tool=BELOW * HELD_BY * USE.force), ""),
        (touched(tool=ABOVE * HELD_BY * USE.force), "tool"),
        (touched(link=ABOVE * HELD_BY * USE.force, joint=2, parts=FOREARM), "forearm"),
        (touched(tool=30.0, link=40.0, joint=3, parts=WRIST), "wrist"),
        (touched(tool=math.nan), ""),
    ],
)
@pytest.mark.parametrize("on", [True, False])
def test_an_arm_that_does_not_follow_is_told_what_holds_it(felt: Estimate, part: str, on: bool) -> None:
    watch, use = Collisions(JOINTS), CollisionSettings(on=on)
    watch.step(touched(), use, moves=True)
    assert watch.holding(felt, use)["part"] == part
    watch.rest()
    assert watch.holding(felt, use)["part"] == part


def test_an_arm_that_is_touched_already_may_move_away_but_not_press_on() -> None:
    watch = Collisions(JOINTS)
    watch.rest()
    for force in (180.0, 180.0 + BELOW * MORE, 120.0):
        assert watch.step(touched(tool=force), USE, moves=True) is None
    assert watch.step(touched(tool=120.0 + BELOW * MORE), USE, moves=True) is None
    assert watch.step(touched(tool=120.0 + ABOVE * MORE), USE, moves=True) is not None


def test_once_off_the_limit_is_that_of_the_settings_again() -> None:
    watch = Collisions(JOINTS)
    watch.rest()
    for force in (180.0, 100.0, 0.0):
        assert watch.step(touched(tool=force), USE, moves=True) is None
    assert watch.step(touched(tool=ABOVE * USE.force), USE, moves=True) is not None


def test_a_motion_may_begin_with_the_force_that_held_the_standing_arm() -> None:
    watch = Collisions(JOINTS)
    assert watch.step(touched(link=BELOW * USE.clamping), USE, moves=False) is None
    assert watch.step(touched(link=BELOW * USE.clamping), USE, moves=True) is None


def test_a_standing_arm_that_is_overpowered_is_stopped_once() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(Inputs(), touched(tool=BELOW * USE.clamping))
    assert bench.last.events == ()
    bench.step(Inputs(), touched(tool=ABOVE * USE.clamping))
    assert [event.kind for event in bench.last.events] == [Kind.COLLISION]
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.PROTECTIVE_STOP, Law.BRAKE)
    bench.step(Inputs(), touched(tool=ABOVE * USE.clamping))
    assert bench.last.events == ()


def test_a_jogged_arm_is_stopped_at_less() -> None:
    bench = Bench()
    bench.run(60)
    jog = Inputs(jog=JogMove(frame="base", axis=0, sign=1))
    for _ in range(2):
        bench.step(jog, touched())
    bench.step(jog, touched(tool=BELOW * USE.force))
    assert bench.last.law is Law.FOLLOW
    bench.step(jog, touched(tool=ABOVE * USE.force))
    assert [event.kind for event in bench.last.events if event.kind is Kind.COLLISION] == [Kind.COLLISION]
    assert bench.last.safety is Safety.PROTECTIVE_STOP
