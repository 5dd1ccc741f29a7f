"""The activation sequence with the shipped settings (FD-9 to FD-12)."""

import math
from collections.abc import Callable
from itertools import combinations

import pytest
from msgspec.structs import astuple, replace

from pendant.all_settings import Settings, apply
from pendant.context import Surroundings
from pendant.events.event import Event, Kind
from pendant.freedrive.sequence import Sequence, SequenceVerdict
from pendant.inputs import NOTHING, Command, Inputs
from pendant.limits.parameters import reference
from pendant.limits.residual import PayloadError
from pendant.limits.validity import Stillness, WrenchMean
from pendant.sensor.sensor_spec import SensorSpec
from pendant.sensor.taring import Taring
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, JOINTS, LET_GO, Bench, remaining

PARAMETERS: dict[str, tuple[str, float, str, Callable[[float], Estimate]]] = {
    "flange displacement": ("flange", 0.002, "m", lambda value: estimate(position=value)),
    "flange speed": ("flange", 0.02, "m/s", lambda value: estimate(speed=-value)),
    "flange acceleration": ("flange", 1.5, "m/s²", lambda value: estimate(acceleration=value)),
    "joint speed": ("shoulder", 0.05, "rad/s", lambda value: estimate(qd=[0.0, -value, 0.0, 0.0, 0.0, 0.0])),
    "joint external torque": ("elbow", 4.0, "N·m", lambda value: estimate(tau_ext=[0.0, 0.0, value, 0.0, 0.0, 0.0])),
    "payload-like force": ("flange", 6.2, "N", lambda value: estimate(force=[0.0, 0.0, value])),
    "payload-like torque": ("flange", 1.5, "N·m", lambda value: estimate(torque=[0.0, value, 0.0])),
    "user force": ("flange", 12.0, "N", lambda value: estimate(force=[0.0, -value, 0.0])),
    "user torque": ("flange", 1.5, "N·m", lambda value: estimate(torque=[0.0, 0.0, -value])),
}
"""Part, limit, unit; rated torques are 100 N·m."""
AVERAGED = {name for name in PARAMETERS if "payload" in name or "user" in name}


def tried(**changes: float | bool) -> Bench:
    """In the first tick of the sequence, tick 560."""
    bench = Bench(**{"sequence__on": True, **changes})
    bench.run(60)
    bench.run(501, HOLD)
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.SEQUENCE, Law.FREE)
    return bench


def around(value: Estimate, tick: int = 0) -> Surroundings:
    """Of a tick whose mean wrench is its own."""
    value.tick, mean = tick, WrenchMean()
    return Surroundings(value, Mode.TEACH, mean.step(value), Stillness(), mean)


def sequence(start: Estimate, stored: Estimate | None = None, **changes: float | bool) -> Sequence:
    """Begun at `start`; settings by dotted name with __ for the dot."""
    settings = apply(Settings(), {name.replace("__", "."): value for name, value in changes.items()})
    return Sequence(
        around(start),
        settings,
        joints=JOINTS,
        rated=(100.0,) * 6,
        stored=None if stored is None else reference(stored, tuple(stored.F_user.tolist())),
    )


VERTICAL: dict[str, float | bool] = {"sequence__dynamic__vertical": True, "soft__vertical_share": 0.5}


@pytest.mark.parametrize(("z", "lowered", "there"), [(0.0009, True, False), (0.0011, True, True), (0.0019, False, False)])
def test_limits_that_fall_hold_for_the_change_since_a_stored_state_too(z: float, lowered: bool, there: bool) -> None:
    """FD-9, FD-12b: half of 2 mm is left along gravity."""
    begun = sequence(estimate(), estimate(position=[0.0, 0.0, -z]), **(VERTICAL if lowered else {}))
    assert [gauge.name for gauge in begun.check(around(estimate()))] == ["flange displacement, against stored"] * there


def test_the_hands_force_and_torque_lower_the_limits_by_their_whole_sizes() -> None:
    """FD-12b: whatever their direction; without the flange's sensor nothing does."""
    on: dict[str, float | bool] = {"sequence__dynamic__pushed": True, "soft__force_share": 0.02, "soft__torque_share": 0.1}
    pushed = estimate(force=[2.0, 3.0, 6.0], torque=[4.0, 0.0, 3.0])
    begun, blind = sequence(pushed, None, **on), sequence(estimate(wrench_valid=False), None, **on)
    begun.check(around(pushed))
    assert blind.check(around(estimate(wrench_valid=False))) == []
    left = {item.name: item.high for item in begun.monitored()}
    whole = {item.name: item.high for item in blind.monitored()}
    for name, share in (("flange speed", 1.0 + 0.02 * 7.0), ("joint speed", 1.0 + 0.1 * 5.0)):
        assert left[name] == pytest.approx(whole[name] / share)
        assert whole[name] == PARAMETERS[name][1]


def test_what_it_is_compared_with_is_part_of_its_state() -> None:
    states = [None, estimate(), estimate(position=0.001)]
    memories = [state_of(sequence(estimate(), stored)) for stored in states]
    assert memories == [state_of(sequence(estimate(), stored)) for stored in states]
    assert all(one != other for one, other in combinations(memories, 2))


@pytest.mark.parametrize(("force", "way"), [(0.5, "up"), (1.5, "up"), (0.0, "down"), (-0.5, "down")])
def test_payload_comes_first_of_several_reasons(force: float, way: str) -> None:
    """FD-11: as what explains them best."""
    begun = sequence(estimate())
    now = around(estimate(position=0.003, speed=0.1, force=[0.0, 0.0, force], torque=[0.0, 1.6, 0.0]), 50)
    beyond = begun.check(now)
    events = [*begun.reasons(beyond, now), begun.refusal(beyond, now, Settings())]
    assert [event.values["parameter"] for event in events[:-1]] == ["flange displacement", "flange speed", "payload-like torque"]
    values = {
        "mass": pytest.approx(-force / 9.81, abs=1e-12),
        "force": abs(force),
        "way": way,
        "zero": False,
        "parameter": "payload-like torque",
    }
    assert events[-1] == Event(Kind.REFUSED_PAYLOAD, 50, values)


@pytest.mark.parametrize(
    ("left", "valid", "last", "kinds"),
    [
        (10.0, False, False, []),
        (5.0, True, False, None),
        (4.9, True, False, [Kind.RESIDUAL_GONE]),
        (-4.9, True, True, [Kind.RESIDUAL_GONE]),
        (8.49, True, True, []),
        (8.5, True, True, [Kind.RESIDUAL_STAYED]),
        (11.5, True, True, [Kind.RESIDUAL_STAYED]),
        (11.51, True, True, []),
        (-10.0, True, True, []),
    ],
)
def test_a_verdict_waits_for_what_stays_of_the_force(left: float, valid: bool, last: bool, kinds: list[Kind] | None) -> None:
    """FD-11: from 10 N, up to half counts as there, up to 1.5 N more or less as the same; `None`: it waits on."""
    verdict = SequenceVerdict()
    verdict.begin(around(estimate(force=[0.0, 0.0, 10.0])), Settings())
    told = verdict.step(around(estimate(force=[3.0, 4.0, left], wrench_valid=valid)), last)
    assert [event.kind for event in told] == (kinds or [])
    assert verdict.waiting is (kinds is None)


@pytest.mark.parametrize(("seconds", "count"), [(0.25, 125), (1.0, 500), (5.0, 2500)])
def test_it_lasts_its_period_to_the_tick_and_ends_in_free_drive(seconds: float, count: int) -> None:
    """FD-9, FD-12."""
    bench = tried(sequence__period=seconds)
    assert remaining(bench.last) == {"sequence": (count, count)}
    for left in range(count - 1, 0, -1):
        bench.step(HOLD)
        assert (bench.last.mode, bench.last.phase, bench.last.law, bench.last.gain) == (Mode.TEACH, Phase.SEQUENCE, Law.FREE, 0.0)
        assert remaining(bench.last) == {"sequence": (left, count)}
    bench.step(HOLD)
    assert (bench.last.mode, bench.last.phase, bench.last.law, bench.last.gain) == (Mode.FREE_DRIVE, Phase.HELD, Law.FREE, 1.0)
    assert bench.last.monitored == ()
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED, Kind.SEQUENCE_STARTED, Kind.ENTERED]
    assert bench.events[1] == Event(Kind.SEQUENCE_STARTED, 560, {"period": seconds})


@pytest.mark.parametrize("tick", [1, 2, 250, 499])
def test_the_button_let_go_in_it_does_not_abort(tick: int) -> None:
    """FD-8a: and nobody holds it at entry, so that the period runs from there."""
    bench = tried()
    bench.run(tick - 1, HOLD)
    bench.step(LET_GO)
    assert bench.run(499 - tick).phase is Phase.SEQUENCE
    bench.step()
    assert (bench.last.mode, bench.last.phase) == (Mode.FREE_DRIVE, Phase.PERIOD)
    assert remaining(bench.last) == {"free-drive": (1500, 1500)}


def test_pressed_again_in_it_the_button_is_held_at_entry() -> None:
    bench = tried()
    bench.step(LET_GO)
    bench.run(300)
    assert bench.run(199, HOLD).phase is Phase.HELD
    assert bench.step(LET_GO).phase is Phase.PERIOD


@pytest.mark.parametrize("tick", [1, 250, 499, 500])
@pytest.mark.parametrize("name", PARAMETERS)
def test_beyond_a_limit_in_any_tick_refuses_at_once_and_at_it_does_not(name: str, tick: int) -> None:
    """FD-10, FD-11."""
    part, limit, unit, make = PARAMETERS[name]
    value = limit * (1 + 1e-9)
    bench = tried()
    at_limit, beyond = make(limit * (1 - 1e-12)), make(value)
    if name in AVERAGED:
        bench = Bench(sequence__on=True)
        bench.run(60)
        bench.run(500 + tick, HOLD, at_limit)
        bench.supervisor._mean._ring[:] = beyond.F_user
    else:
        bench.run(tick - 1, HOLD, at_limit)
    assert bench.last.phase is Phase.SEQUENCE
    bench.events.clear()
    bench.step(HOLD, beyond)
    assert (bench.last.mode, bench.last.safety, bench.last.phase) == (Mode.TEACH, Safety.NORMAL, Phase.OFF)
    assert bench.last.law is (Law.BRAKE if name == "joint speed" else Law.HOLD)
    assert remaining(bench.last) == {"cool-down": (1000, 1000)}
    told, refused = bench.events
    assert told.kind is Kind.ENTRY_PREVENTED
    assert told.values == {
        "parameter": name,
        "part": part,
        "value": pytest.approx(value),
        "limit": pytest.approx(limit),
        "unit": unit,
        "time": pytest.approx(tick / 500),
    }
    assert refused.kind is (Kind.REFUSED_PAYLOAD if name.startswith("payload") else Kind.REFUSED_LIMIT)
    assert bench.run(1100, HOLD).mode is Mode.TEACH


@pytest.mark.parametrize("name", PARAMETERS)
def test_a_limit_that_is_off_is_not_checked(name: str) -> None:
    _, limit, _, make = PARAMETERS[name]
    key = {"joint external torque": "joint_torque", "payload-like force": "payload_force"}.get(name, name)
    key = {"payload-like torque": "payload_torque"}.get(name, key).replace(" ", "_")
    bench = tried(**{f"limits__activation__{key}__on": False})
    assert name not in [item.name for item in bench.last.monitored]
    assert bench.run(500, HOLD, make(1.5 * limit)).mode is Mode.FREE_DRIVE


def test_every_parameter_that_prevented_entry_is_told() -> None:
    bench = tried()
    bench.step(HOLD, estimate(position=0.003, speed=0.1, qd=0.4, tau_ext=-30.0, acceleration=2.0))
    kinds = [event.kind for event in bench.last.events]
    assert kinds == [Kind.ENTRY_PREVENTED] * 5 + [Kind.REFUSED_LIMIT]
    names = [event.values["parameter"] for event in bench.last.events]
    assert names == [*list(PARAMETERS)[:5], "flange displacement"]


def test_values_and_limits_are_published_while_they_are_checked() -> None:
    bench = tried()
    assert [item.name for item in bench.last.monitored] == list(PARAMETERS)
    bench.step(HOLD, estimate(position=0.001, tau_ext=3.0))
    shown = {item.name: item for item in bench.last.monitored}
    assert astuple(shown["flange displacement"])[1:] == ("flange", pytest.approx(0.001), -math.inf, 0.002, "m")
    assert astuple(shown["joint external torque"])[1:] == ("base", 3.0, -math.inf, 4.0, "N·m")
    assert Bench().run(3).monitored == ()


def test_an_arm_without_flange_sensors_is_judged_by_its_joints() -> None:
    """FD-3a."""
    blind = estimate(wrench_valid=False, acceleration_valid=False)
    bench = Bench(sequence__on=True)
    bench.run(60, NOTHING, blind)
    bench.run(501, HOLD, blind)
    names = [item.name for item in bench.last.monitored]
    assert names == ["flange displacement", "flange speed", "joint speed", "joint external torque"]
    assert bench.run(500, HOLD, blind).mode is Mode.FREE_DRIVE
    assert bench.last.gain == 0.0


@pytest.mark.parametrize(("amplified", "gain"), [(False, 0.0), (True, 1.5)])
def test_the_users_force_is_not_amplified_in_it_unless_asked_for(amplified: bool, gain: float) -> None:
    bench = tried(sequence__amplified=amplified, free_drive__gain=1.5)
    assert bench.last.gain == gain
    assert bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,))).gain == 0.0


def test_limits_are_locked_in_it() -> None:
    bench = tried()
    bench.step(Inputs(settings={"limits.activation.user_force.max": 50.0, "free_drive.period": 5.0}))
    assert [event.kind for event in bench.last.events] == [Kind.SETTING_REFUSED, Kind.SETTING_CHANGED]
    assert bench.last.events[0].values["reason"] == "no change of a limit in the activation of free-drive"


def test_equal_states_decide_equally_in_it() -> None:
    one, other = tried(), tried()
    one.step(HOLD, estimate(position=0.001))
    assert one.supervisor.state != other.supervisor.state
    other.step(HOLD, estimate(position=0.001))
    assert one.supervisor.state == other.supervisor.state


def test_only_what_was_there_at_the_start_is_missed() -> None:
    """FD-3a, FD-12."""
    for broken, sensor in (
        (estimate(wrench_valid=False), "flange force sensor"),
        (estimate(acceleration_valid=False), "flange accelerometer"),
    ):
        assert sequence(estimate()).missing(around(broken)) == sensor
        assert sequence(broken).missing(around(broken)) == ""


class OtherPostures(Taring):
    """Knows the payload's error from other postures; the sensor's bias is what is felt beside it."""

    def __init__(self, error: PayloadError | None, explains: bool = True) -> None:
        super().__init__(SensorSpec())
        self._told, self._explains = error, explains

    def payload_error(self, estimate: Estimate, wrench: tuple[float, ...]) -> PayloadError | None:
        return self._told

    def explains(self, estimate: Estimate, wrench: tuple[float, ...]) -> bool:
        return self._explains


def known(value: Estimate, error: PayloadError | None) -> Surroundings:
    return replace(around(value), taring=OtherPostures(error))


@pytest.mark.parametrize(
    ("mass", "more", "refused"), [(0.29, 0.0, False), (0.31, 0.0, True), (-0.31, 0.0, True), (0.1, 0.25, True)]
)
def test_a_payload_that_other_postures_know_to_be_wrong_is_refused(mass: float, more: float, refused: bool) -> None:
    """FD-9: also when it became so since the sequence began."""
    first, now = known(estimate(force=3.0), PayloadError(mass, 0.1)), around(estimate(force=[3.0, 0.0, -more * GRAVITY]))
    begun = Sequence(first, Settings(), joints=JOINTS, rated=(100.0,) * 6, stored=None)
    assert [gauge.name for gauge in begun.check(now)] == ["payload error"] * refused


def test_without_the_sensor_other_postures_tell_nothing() -> None:
    blind = estimate(wrench_valid=False)
    begun = Sequence(known(blind, PayloadError(2.0, 0.1)), Settings(), joints=JOINTS, rated=(100.0,) * 6, stored=None)
    assert begun.check(around(blind)) == []
    assert around(estimate()).payload_error is None


def unseen(mass: float, deviation: float) -> Estimate:
    """Without the flange sensor the joints tell a payload that is wrong by so much, with this standard deviation [kg]."""
    blind = estimate(wrench_valid=False, force=math.nan)
    blind.missing_mass = (mass, deviation)
    return blind


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("mass", "deviation", "refused"),
    [(0.29, 0.01, False), (0.31, 0.01, True), (0.98, 0.3, False), (0.99, 0.3, True), (9.0, math.inf, False)],
)
def test_without_the_sensor_the_joints_tell_a_wrong_payload_as_well_as_its_gears_are_known(
    mass: float, deviation: float, refused: bool, way: float
) -> None:
    """FD-9: 3.29 deviations of 0.3 kg are 0.987 kg. What was told as the sequence began counts: then the arm stood."""
    start = around(unseen(way * mass, deviation))
    begun = Sequence(start, Settings(), joints=JOINTS, rated=(100.0,) * 6, stored=None)
    beyond = begun.check(around(unseen(0.0, deviation)))
    assert [gauge.name for gauge in beyond] == ["payload error"] * refused
    if refused:
        told = begun.refusal(beyond, start, Settings())
        assert told.kind is Kind.REFUSED_PAYLOAD
        assert told.values["mass"] == pytest.approx(way * mass)
        assert (told.values["way"], told.values["zero"]) == ("down" if way > 0.0 else "up", False)


@pytest.mark.parametrize("wrong", [(math.nan, 0.1), (2.0, math.nan), (math.inf, 0.1)])
def test_what_the_joints_tell_of_the_payload_must_be_a_number(wrong: tuple[float, float]) -> None:
    assert around(unseen(*wrong)).payload_error is None


@pytest.mark.parametrize(("margin", "said", "zero"), [(0.1, 0.5, False), (0.3, 0.5, False), (0.31, -0.7, True)])
def test_where_the_payload_is_known_well_its_mass_is_said_and_the_zero_is_no_cause(
    margin: float, said: float, zero: bool
) -> None:
    """FD-11: of 7 N more than that the sensor's bias is the cause."""
    value = known(estimate(force=[0.0, 0.0, 0.7 * GRAVITY]), PayloadError(0.5, margin))
    begun = Sequence(value, Settings(), joints=JOINTS, rated=(100.0,) * 6, stored=None)
    refusal = begun.refusal(begun.check(value), value, Settings())
    assert refusal.kind is Kind.REFUSED_PAYLOAD
    assert (refusal.values["mass"], refusal.values["zero"]) == (pytest.approx(said), zero)


@pytest.mark.parametrize(("error", "mass", "zero"), [(PayloadError(0.5, 0.1), 0.5, False), (None, -0.7, True)])
def test_what_stays_is_said_without_the_bias_that_is_known(error: PayloadError | None, mass: float, zero: bool) -> None:
    """FD-11, FD-22."""
    value, verdict = known(estimate(force=[0.0, 0.0, 0.7 * GRAVITY]), error), SequenceVerdict()
    verdict.begin(value, Settings())
    (told,) = verdict.step(value, True)
    assert told.kind is Kind.RESIDUAL_STAYED
    assert told.values == {"force": pytest.approx(abs(mass) * GRAVITY), "mass": pytest.approx(mass), "zero": zero}
