"""An arm that hits something is stopped, in every mode that holds or moves it; what touched it already lets it go (RL-3)."""

import math

import numpy as np
import pytest

from pendant.events.event import Kind
from pendant.inputs import Inputs
from pendant.program.jog_move import JogMove
from pendant.safety.collision import MORE, Collisions
from pendant.safety.settings import CollisionSettings
from pendant.tick.estimate import Estimate, LinkForce
from pendant.tick.modes import Law, Mode, Safety
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

ELBOW = 2
USE = CollisionSettings()
BELOW, ABOVE = 0.95, 1.05


def touched(tool: float = 0.0, link: float = 0.0, joint: int = 1, *, clipped: bool = False, sensed: bool = True) -> Estimate:
    """An arm that feels these forces [N] on its tool and on the link that `joint` moves."""
    felt = estimate()
    felt.F_user = np.array([0.6 * tool, 0.0, -0.8 * tool, 0.0, 0.0, 0.0])
    felt.link_force, felt.clipped, felt.wrench_valid = LinkForce(joint, link, 0.3 * link, 1), clipped, sensed
    return felt


def hit(felt: Estimate, *, moves: bool = True, use: CollisionSettings = USE) -> Kind | None:
    """What an arm says that felt nothing before."""
    watch = Collisions(ELBOW)
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
    assert Collisions(ELBOW).step(touched(tool=math.inf), USE, moves=True) is not None


def test_a_flange_sensor_that_is_out_tells_nothing() -> None:
    assert hit(touched(tool=1000.0, sensed=False)) is None


def test_beyond_the_range_of_the_sensor_the_joints_feel_the_rest() -> None:
    assert hit(touched(tool=100.0, link=45.0, clipped=True), moves=False) is None
    assert hit(touched(tool=100.0, link=55.0, clipped=True), moves=False) is Kind.COLLISION
    assert hit(touched(tool=100.0, link=55.0), moves=False) is None


@pytest.mark.parametrize(
    ("felt", "part"),
    [
        (touched(tool=80.0), "tool"),
        (touched(tool=100.0, link=80.0, joint=4, clipped=True), "tool"),
        (touched(link=80.0, joint=0), "elbow"),
        (touched(link=80.0, joint=1), "elbow"),
        (touched(link=80.0, joint=2), "forearm"),
        (touched(link=80.0, joint=3), "wrist"),
        (touched(link=80.0, joint=5, sensed=False), "wrist or tool"),
    ],
)
def test_the_event_names_part_force_limit_and_speed(felt: Estimate, part: str) -> None:
    felt.v_tcp = 0.25
    watch = Collisions(ELBOW)
    watch.step(touched(), USE, moves=True)
    event = watch.step(felt, USE, moves=True)
    assert event is not None
    force = 180.0 if felt.clipped else 80.0
    assert event.values == {"part": part, "force": pytest.approx(force), "limit": USE.force, "speed": 250.0}


def test_an_arm_that_is_touched_already_may_move_away_but_not_press_on() -> None:
    watch = Collisions(ELBOW)
    watch.rest()
    for force in (180.0, 180.0 + BELOW * MORE, 120.0):
        assert watch.step(touched(tool=force), USE, moves=True) is None
    assert watch.step(touched(tool=120.0 + BELOW * MORE), USE, moves=True) is None
    assert watch.step(touched(tool=120.0 + ABOVE * MORE), USE, moves=True) is not None


def test_once_off_the_limit_is_that_of_the_settings_again() -> None:
    watch = Collisions(ELBOW)
    watch.rest()
    for force in (180.0, 100.0, 0.0):
        assert watch.step(touched(tool=force), USE, moves=True) is None
    assert watch.step(touched(tool=ABOVE * USE.force), USE, moves=True) is not None


def test_a_motion_may_begin_with_the_force_that_held_the_standing_arm() -> None:
    watch = Collisions(ELBOW)
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
