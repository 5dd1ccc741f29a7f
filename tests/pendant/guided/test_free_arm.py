"""The free arm: what each of its watches tells, in which order, and what it knows of the others (FD-4, FD-18, FD-19, VW-6)."""

import math
from typing import Any

import pytest

from pendant.all_settings import Settings, apply
from pendant.context import Surroundings
from pendant.events.event import Event, Kind
from pendant.guided.bias_follower import SURE, UNUSED
from pendant.guided.free_arm import FreeArm
from pendant.guided.pull import HandFelt, PullCauses
from pendant.guided.sensor_bias import SensorBias
from pendant.guided.user_force import UserForce
from pendant.limits.joint_zones import JointZones
from pendant.limits.nearness import Nearness
from pendant.limits.validity import JOINTS_SENSED, Stillness, WrenchMean
from pendant.sensor.hand_model import KNOWN, SUSPECTED
from pendant.tick.estimate import GRAVITY, Estimate, JointsFeel
from pendant.tick.modes import TICK, Mode
from pendant.tick.motion_status import NO_MOTION, MotionStatus
from pendant.tick.pose import ORIGIN
from pendant.walls.containment import Containment
from pendant.walls.definitions import AnyBorder, Area
from pendant.walls.settings import Reaction
from pendant.walls.shapes import HalfSpace
from tests.pendant.estimates import SENSOR, estimate
from tests.pendant.telling import whole_transition

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
RATED, RANGES = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0), ((-3.0, 3.0),) * 6
TWO = [0.0, 0.0, 2.0 * GRAVITY]  # what 2 kg need at rest [N]
ALONE = 0.02
"""Shortest time that the arm may move alone [s]."""


class Free:
    """A free-drive that began at rest, stepped by hand."""

    def __init__(self, *borders: AnyBorder, sensor: bool = True, payload: float = 0.0, **changes: float | bool) -> None:
        off = {"walls.tether": False, "unexplained.time": ALONE}
        self.settings = apply(Settings(), off | {name.replace("__", "."): value for name, value in changes.items()})
        self.zero, self.mean, self.payload, self.tick = SensorBias(SENSOR), WrenchMean(), payload, 0
        self.zero.begin(estimate(), sensor, self.mean)
        containment, zones = Containment(borders, {}), JointZones(RATED, RANGES)
        self.arm = FreeArm(
            self.around(estimate()),
            self.settings,
            bias=self.zero,
            containment=containment,
            zones=zones,
            joints=JOINTS,
            rated=RATED,
        )

    def around(self, value: Estimate, shaken: bool = False, status: MotionStatus = NO_MOTION) -> Surroundings:
        value.tick = self.tick
        ok = self.mean.step(value)
        return Surroundings(
            value, Mode.FREE_DRIVE, ok, Stillness(), self.mean, shaken=shaken, payload=self.payload, status=status
        )

    def see(self, value: Estimate, waits: bool = False, shaken: bool = False, status: MotionStatus = NO_MOTION) -> list[Event]:
        self.tick += 1
        return whole_transition(self.arm.step(self.around(value, shaken, status), self.settings, waits), self.tick)

    def during(self, ticks: int, value: Estimate, waits: bool = False, shaken: bool = False) -> list[Event]:
        return [event for _ in range(ticks) for event in self.see(value, waits, shaken)]


def floor(reaction: Reaction = Reaction.STAY) -> Area:
    return Area(name="floor", shape=HalfSpace(normal=(0.0, 0.0, -1.0)), position=(0.0, 0.0, -0.1), reaction=reaction)


def below(depth: float, **motion: Any) -> Estimate:
    """The flange beneath the floor [m]."""
    return estimate(position=[0.2, -0.3, -0.1 - depth], **motion)


def test_it_begins_free_and_untouched() -> None:
    arm = Free().arm
    assert (arm.caught, arm.suspect, arm.user) == (False, False, ORIGIN)
    assert (arm.damping, arm.singularity) == (None, Nearness.OK)


def test_a_tick_in_which_nothing_happens() -> None:
    free = Free()
    assert free.see(estimate()) == []
    assert (free.arm.caught, free.arm.suspect, free.arm.user) == (False, False, ORIGIN)
    assert free.arm.damping is not None
    assert free.arm.damping[:3] == (1.5, 1.5, 3.0)


def test_without_joint_values_it_cannot_go_on() -> None:
    """FD-12."""
    free = Free(floor())
    assert free.see(below(0.01, joints_valid=False)) == [Event(Kind.SENSORS_LOST, 1, {"sensor": JOINTS_SENSED})]


@pytest.mark.parametrize("sensor", [True, False])
def test_the_flange_sensor_tells_the_users_force_while_it_is_used(sensor: bool) -> None:
    free, value = Free(sensor=sensor), estimate(force=[5.0, 20.0, -3.0])
    assert free.see(value) == []
    expected = UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force)
    expected.step(value, sensor, Settings().unexplained.speed)
    assert free.arm.user == expected.user
    assert (free.arm.user != ORIGIN) is sensor


@pytest.mark.parametrize("sensor", [True, False])
def test_a_sensor_that_falls_silent_ends_a_free_drive_that_used_it(sensor: bool) -> None:
    """FD-19."""
    assert Free(sensor=sensor).see(estimate(wrench_valid=False)) == [Event(Kind.WRENCH_LOST, 1)] * sensor


@pytest.mark.parametrize(("watched", "sensor"), [(True, True), (False, True), (True, False)])
def test_a_sensor_that_steps_ends_free_drive_while_it_is_used_and_watched(watched: bool, sensor: bool) -> None:
    """FD-19."""
    free = Free(sensor=sensor, unexplained__sensor=watched)
    free.during(2, estimate())
    value = estimate(force=[0.0, 0.0, 20.0])
    value.whose = value.whose._replace(step_odds=KNOWN, step_force=20.0)
    told = [Event(Kind.SENSOR_STEPPED, 3, {"force": 20.0})]
    assert free.see(value) == (told if watched and sensor else [])


@pytest.mark.parametrize("waits", [True, False])
def test_what_the_sensor_drifts_by_is_taken_off_while_nobody_moves_the_arm(waits: bool) -> None:
    """FD-19: two means of 0.1 s, apart by less than a drift may be."""
    free = Free()
    free.during(49, estimate(), waits)
    free.during(52, estimate(force=[0.1, -0.2, 0.05]), waits)
    assert free.zero.baseline[:3] == pytest.approx((0.1, -0.2, 0.05) if waits else ORIGIN)


def beneath(depth: float) -> dict[str, Any]:
    """What an event says of the flange `below` the floor: the way back leads up."""
    back = {"x": 0.0, "y": 0.0, "z": 1.0, "px": 0.2, "py": -0.3, "pz": -0.1 - depth}
    return {"wall": "floor", "part": "flange", "distance": pytest.approx(1000.0 * depth), "way": "+z"} | back


def test_a_wall_that_keeps_the_arm_is_told_each_time_it_is_reached() -> None:
    """VW-6."""
    free = Free(floor(), unexplained__motion=False)
    for first in (3, 7):
        assert free.during(2, below(-0.01)) == []
        assert free.arm.caught is False
        assert free.during(2, below(0.01)) == [Event(Kind.WALL_REACHED, first, beneath(0.01))]
        assert free.arm.caught is True


@pytest.mark.parametrize(("reaction", "kind"), [(Reaction.LEAVE, Kind.LEFT_WALL), (Reaction.STOP, Kind.STOPPED_WALL)])
def test_a_wall_that_ends_free_drive_is_all_that_is_told(reaction: Reaction, kind: Kind) -> None:
    """VW-6: of a tool that is too fast in the same tick nothing is told."""
    free = Free(floor(reaction), unexplained__motion=False)
    assert free.see(below(-0.01)) == []
    assert free.see(below(0.01, v_tcp=9.0)) == [Event(kind, 2, beneath(0.01))]
    assert free.arm.caught is False


@pytest.mark.parametrize("locked", [True, False])
def test_the_way_to_a_singularity_is_told_where_a_lock_may_have_to_give_way(locked: bool) -> None:
    """FD-4; the word itself is known without a lock, too."""
    free, ok, near, too_near = Free(axes__rz=not locked), Nearness.OK, Nearness.NEAR, Nearness.TOO_NEAR
    for tick, (value, word, new) in enumerate(
        [(0.05, ok, False), (0.03, near, True), (0.03, near, False), (0.005, too_near, True)], 1
    ):
        event = Event(Kind.SINGULARITY, tick, {"status": word, "value": value, "limit": 0.04})
        assert free.see(estimate(), status=MotionStatus(singularity=value)) == ([event] if locked and new else [])
        assert free.arm.singularity is word


MOVING = {"speed": [0.0, 0.0, 0.03]}
BENT = estimate(theta=[2.98] + [0.0] * 5, **MOVING).copy()  # in the stiff zone before its limit
BENT.theta_d[0] = 0.1
AFTER = round(ALONE / TICK) + 1  # ticks


def test_what_ends_it_is_told_with_its_numbers() -> None:
    """FD-19."""
    free = Free()
    assert free.during(AFTER - 1, estimate(**MOVING)) == []
    values = {"distance": 0.0, "time": pytest.approx(AFTER * TICK), "limit": 0.02}
    assert free.see(estimate(**MOVING)) == [Event(Kind.STOPPED_MOTION, AFTER, values)]


@pytest.mark.parametrize("by", ["haptics", "wall", "joint limit"])
def test_what_moves_the_arm_in_place_of_a_hand_is_known_each_by_itself(by: str) -> None:
    """FD-19: motion that nobody causes is not that of a shaker, of a wall or of a joint's spring."""
    free = Free(floor())
    free.see(estimate(theta=[2.9] + [0.0] * 5))
    value = {"haptics": estimate(**MOVING), "wall": below(0.01, **MOVING), "joint limit": BENT}[by]
    assert [event.kind for event in free.during(2 * AFTER, value, shaken=by == "haptics")] == [Kind.WALL_REACHED] * (by == "wall")


@pytest.mark.parametrize(("share", "doubtful"), [(0.4, False), (0.7, True)])
def test_half_of_the_time_that_nobody_leads_it_is_doubtful(share: float, doubtful: bool) -> None:
    free = Free()
    value = estimate(speed=0.05, qd=TRANSITIONS, friction=RUBS)
    free.during(round(share * AFTER), value)
    assert free.arm.doubtful is doubtful


TRANSITIONS, RUBS = [0.0, 0.0, 0.4, 0.0, 0.0, 0.0], [0.0, 0.0, 8.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("on", [True, False])
def test_the_tether_follows_who_pays_for_the_motion(on: bool) -> None:
    """A hand on a link leads the arm with less force than is felt (VW-4, FD-19); where nobody asks for its work it is held."""
    free = Free(walls__tether=True, unexplained__motion=on)
    told = []
    for tick in range(1, 400):
        place = [0.2 * TICK * tick, 0.0, 0.0]
        torques = [0.0, 0.0, 1.5, 0.0, 0.0, 0.0]
        told += free.see(estimate(position=place, speed=0.2, qd=TRANSITIONS, friction=RUBS, tau_hand=torques))
    assert free.arm.user == ORIGIN
    assert [event.kind for event in told] == ([] if on else [Kind.WALL_REACHED])


@pytest.mark.parametrize(("watched", "sensor"), [(True, True), (False, True), (True, False)])
def test_while_the_sensor_may_have_stepped_nothing_helps(watched: bool, sensor: bool) -> None:
    """FD-19: and once it may not, the help is back."""
    free, value = Free(sensor=sensor, unexplained__sensor=watched), estimate()
    for odds, suspected in ((-SUSPECTED - 1e-9, False), (-SUSPECTED, True), (-math.inf, False)):
        value.whose = value.whose._replace(step_odds=odds)
        free.see(value)
        assert free.arm.suspect is (suspected and watched and sensor)


@pytest.mark.parametrize("sensor", [True, False])
def test_a_payload_that_drops_is_told_by_its_odds(sensor: bool) -> None:
    """FD-19: of a sensor that is used."""
    free, value = Free(sensor=sensor, payload=2.0), estimate(needed=TWO, load_mass=2.0)
    value.whose = value.whose._replace(lost_odds=SUSPECTED, lost_share=0.9)
    assert free.see(value) == []
    assert free.arm.suspect is sensor
    value.whose = value.whose._replace(lost_odds=KNOWN)
    mass, weight = pytest.approx(-1.8), pytest.approx(0.9 * TWO[2])
    assert free.see(value) == ([Event(Kind.STOPPED_PAYLOAD, 2, {"mass": mass, "force": weight})] if sensor else [])


@pytest.mark.parametrize("sensor", [True, False])
def test_what_pulls_is_told_with_the_odds_of_a_sensor_that_is_used(sensor: bool) -> None:
    """FD-19."""
    free, value = Free(sensor=sensor, payload=2.0), estimate(needed=TWO, load_mass=2.0)
    free.see(value)
    assert free.arm.pull == PullCauses(HandFelt.NOBODY)
    value.whose = value.whose._replace(lost_odds=KNOWN, lost_share=0.9, step_odds=-3.0)
    free.see(value)
    assert free.arm.pull == (PullCauses(HandFelt.NOBODY, KNOWN, 0.9, -3.0) if sensor else PullCauses(HandFelt.NOBODY))


@pytest.mark.parametrize("feels", JointsFeel)
def test_without_the_sensor_a_hand_is_told_where_only_a_hand_explains_what_the_joints_feel(feels: JointsFeel) -> None:
    """FD-19: whatever force that makes."""
    free, value = Free(sensor=False), estimate(felt=40.0)
    value.whose = value.whose._replace(joints_feel=feels)
    free.during(50, value)
    assert free.arm.pull == PullCauses(HandFelt.FLANGE if feels is JointsFeel.HAND else HandFelt.NOBODY)


def test_a_hand_that_leads_a_link_is_told_while_the_arm_moves() -> None:
    """FD-19: with less force than is felt; at rest nobody is told."""
    free = Free()
    free.see(estimate())
    assert free.arm.pull.felt is HandFelt.NOBODY
    for tick in range(1, 100):
        place = [0.2 * TICK * tick, 0.0, 0.0]
        free.see(estimate(position=place, speed=0.2, qd=TRANSITIONS, friction=RUBS, tau_hand=[0.0, 0.0, 1.5, 0.0, 0.0, 0.0]))
    assert free.arm.pull.felt is HandFelt.LINK
    free.see(estimate(position=[0.04, 0.0, 0.0], speed=0.0))
    assert free.arm.pull.felt is HandFelt.NOBODY


@pytest.mark.parametrize("sensor", [True, False])
def test_what_is_taken_for_the_users_force_is_told_with_the_doubts_of_a_sensor_that_is_used(sensor: bool) -> None:
    """FD-19: with what the sensor may have drifted by, and how the flange was turned at entry."""
    free = Free(sensor=sensor)
    assert free.arm.taken is None
    free.during(50, estimate(force=20.0))
    taken = free.arm.taken
    assert taken is not None
    assert taken.force == free.arm.user
    assert (taken.doubts is not None) is sensor
    if taken.doubts is not None:
        assert taken.doubts.change == pytest.approx((20.0, 0.0, 0.0))
        assert taken.doubts.slack == pytest.approx(math.sqrt(3.0) * SENSOR.offset_force * 50 * TICK / SENSOR.quickest, rel=1e-3)
        assert taken.doubts.hung == (0.0, 0.0, 1.0)


def test_of_a_sensor_that_is_not_used_all_may_be_wrong() -> None:
    without, with_it = Free(sensor=False), Free()
    assert (without.arm.slack, with_it.arm.slack) == (UNUSED, SURE)
    without.see(estimate())
    with_it.see(estimate())
    assert without.arm.slack == UNUSED
    assert with_it.arm.slack.force < 1.0


@pytest.mark.parametrize(
    ("why", "force", "pressed"),
    [
        ("at entry it passed", 11.9, False),
        ("more than at entry", 12.1, True),
        ("the sensor may have drifted", 14.5, False),
        ("more than that, too", 15.0, True),
        ("nothing was checked at entry", 50.0, False),
        ("the force was not", 50.0, False),
        ("no sensor", 50.0, False),
    ],
)
def test_a_steady_hand_is_known_by_a_force_that_nothing_else_explains(why: str, force: float, pressed: bool) -> None:
    """FD-13: 12 N pass at entry; in two minutes the sensor may drift by 2.8 N."""
    entry = {
        "sequence__on": why != "nothing was checked at entry",
        "limits__activation__user_force__on": why != "the force was not",
    }
    free = Free(sensor=why != "no sensor", **entry)
    free.tick = 60_000 if force > 14.0 else 0
    free.during(500, estimate(force=force, felt=force))
    excess = free.arm.pressed
    assert (excess is not None) is pressed
    if excess is not None:
        assert excess[:2] == ("user force", "arm")
        assert excess.value == pytest.approx(force, abs=0.01)
        assert excess.limit == pytest.approx(14.8 if force > 14.0 else 12.0, abs=0.05)
