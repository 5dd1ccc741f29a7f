"""Measuring postures one after the other."""

import math

import numpy as np
import pytest

from pendant.equipment.load import Load
from pendant.events.event import Event, Kind
from pendant.inputs import Command, Inputs
from pendant.tick.estimate import Estimate
from pendant.tooling.payload_wizard import IDLE, MOST, UNSTEADY, PayloadWizard, Progress
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench
from tests.pendant.telling import whole

G = 9.81
TICKS = 10


def turned(about_x: float, about_y: float = 0.0) -> np.ndarray:
    cx, sx, cy, sy = math.cos(about_x), math.sin(about_x), math.cos(about_y), math.sin(about_y)
    return np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])


def standing(R: np.ndarray, mass: float = 2.0, centre: tuple[float, float, float] = (0.0, 0.0, 0.1)) -> Estimate:
    """The flange stands at R_BF; the sensor reads what this mass at this centre needs."""
    value = estimate()
    value.R_BF = R
    a = R.T @ [0.0, 0.0, G]
    value.w_sensor = np.concatenate([mass * a, np.cross(centre, mass * a)])
    return value


def disturbed(wizard: PayloadWizard, wrench: list[float]) -> list[Event]:
    """One measurement, in the middle of which a wrench [N, N·m] comes and stays."""
    value = standing(WRIST[0])
    wizard.begin(value, TICKS, "")
    events: list[Event] = []
    for k in range(TICKS):
        if k == TICKS // 2:
            value.w_sensor = np.add(value.w_sensor, wrench)
        events += wizard.step(value, "", ())
    return events


def measure(wizard: PayloadWizard, value: Estimate, length: int = TICKS, known: tuple[Load, ...] = ()) -> list[Event]:
    events = wizard.begin(value, length, "")
    for _ in range(length if wizard.left else 0):
        events += wizard.step(value, "", known)
    assert not wizard.left
    return whole(events, value.tick)


WRIST = [turned(math.pi), turned(math.pi - 0.8), turned(math.pi, 0.8), turned(math.pi, -0.8)]


def test_four_postures_lead_to_the_payload() -> None:
    wizard = PayloadWizard()
    assert (wizard.progress, wizard.left) == (IDLE, False)
    told = [measure(wizard, standing(R)) for R in WRIST]
    assert [[event.kind for event in events] for events in told[:3]] == [[Kind.POSTURE_MEASURED]] * 3
    assert told[0][0].values == {"number": 1, "angle": 0.0, "limit": 0.0, "missing": 3}
    assert told[1][0].values == {"number": 2, "angle": pytest.approx(math.degrees(0.8)), "limit": 22.5, "missing": 2}
    assert [event.kind for event in told[3]] == [Kind.POSTURE_MEASURED, Kind.PAYLOAD_FOUND]
    assert told[3][0].values["missing"] == 0
    values = told[3][1].values
    assert (values["mass"], values["postures"]) == (pytest.approx(2.0), 4)
    assert (values["x"], values["y"], values["z"]) == pytest.approx((0.0, 0.0, 100.0), abs=1e-6)
    finding = wizard.progress.finding
    assert finding is not None
    assert finding.load == Load(mass=2.0, com=[0.0, 0.0, 0.1])
    assert (wizard.progress.postures, wizard.progress.share, wizard.progress.reason) == (4, 0.0, "")
    assert (*finding.force_offset, *finding.torque_offset) == pytest.approx((0.0,) * 6, abs=1e-9)


def test_while_a_posture_is_measured_no_other_is() -> None:
    """Up to the last tick."""
    wizard, value = PayloadWizard(), standing(WRIST[0])
    wizard.begin(value, TICKS, "")
    for _ in range(TICKS):
        (event,) = wizard.begin(value, TICKS, "")
        assert event.values["reason"] == "a posture is being measured"
        ended = wizard.step(value, "", ())
    assert [event.kind for event in ended] == [Kind.POSTURE_MEASURED]


def test_what_is_found_is_told_in_millimetres_with_its_uncertainty() -> None:
    wizard = PayloadWizard()
    (*_, told) = [event for R in WRIST for event in measure(wizard, standing(R, centre=(0.02, -0.03, 0.08)))]
    assert [told.values[name] for name in ("x", "y", "z")] == pytest.approx([20.0, -30.0, 80.0])
    # Exact readings: what is left is 0.6 % of the scale, in the mass and with it in the centre.
    assert [told.values[name] for name in ("mass_deviation", "centre_deviation")] == pytest.approx([0.012, 0.48])
    assert told.values["fit"] == pytest.approx(0.0, abs=1e-9)


def test_the_more_postures_there_are_the_nearer_another_may_be() -> None:
    """pi / (2 n) with n postures, as `estimate_payload` of URScript asks: with the fifth, pi / 10 is enough."""
    wizard = PayloadWizard()
    for R in WRIST:
        measure(wizard, standing(R))
    (refused,) = measure(wizard, standing(turned(math.pi + math.radians(17.9))))
    assert refused.values == {"reason": "17.9° from posture 1, at least 18.0°: turn the wrist on"}
    measured, _ = measure(wizard, standing(turned(math.pi + math.radians(18.1))))
    assert (measured.values["angle"], measured.values["limit"]) == (pytest.approx(18.1), pytest.approx(18.0))


def test_steady_is_the_force_not_the_torque() -> None:
    wizard = PayloadWizard()
    events = disturbed(wizard, [0.0, 0.0, 0.0, 1.5 * UNSTEADY, 0.0, 0.0])
    assert [event.kind for event in events] == [Kind.POSTURE_MEASURED]


def test_what_is_known_is_not_found_again() -> None:
    wizard = PayloadWizard()
    for R in WRIST:
        measure(wizard, standing(R), known=(Load(mass=0.5, com=[0.0, 0.0, 0.1]),))
    assert wizard.progress.finding is not None
    assert wizard.progress.finding.mass == pytest.approx(1.5)


def test_a_measurement_lasts_its_ticks_and_shows_how_far_it_is() -> None:
    wizard = PayloadWizard()
    value = standing(WRIST[0])
    assert wizard.begin(value, 4, "") == []
    seen = []
    for _ in range(4):
        seen.append(wizard.progress.share)
        assert wizard.left
        wizard.step(value, "", ())
    assert (seen, wizard.left) == ([0.0, 0.25, 0.5, 0.75], False)
    assert wizard.progress == Progress(postures=1)


@pytest.mark.parametrize("length", [2, 5])
def test_the_mean_over_the_measurement_counts(length: int) -> None:
    """Readings that alternate about the true value, within what is steady."""
    wizard = PayloadWizard()
    for R in WRIST:
        value = standing(R)
        true = value.w_sensor.copy()
        assert wizard.begin(value, length, "") == []
        for k in range(length):
            value.w_sensor = true + 0.0 if k == length - 1 and length % 2 else true + (-1) ** k * 0.2
            wizard.step(value, "", ())
    assert wizard.progress.finding is not None
    assert wizard.progress.finding.mass == pytest.approx(2.0, abs=1e-9)


def test_a_posture_like_another_is_refused_with_both_angles() -> None:
    wizard = PayloadWizard()
    measure(wizard, standing(WRIST[0]))
    events = measure(wizard, standing(turned(math.pi - math.radians(10.0))))
    assert [event.kind for event in events] == [Kind.POSTURE_REFUSED]
    assert events[0].values == {"reason": "10.0° from posture 1, at least 22.5°: turn the wrist on"}
    # Turning about the vertical is no other posture at all.
    about = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert "0.0° from posture 1" in str(measure(wizard, standing(about @ WRIST[0]))[0].values["reason"])
    assert wizard.progress.postures == 1


def test_what_forbids_it_is_said_and_nothing_begins() -> None:
    wizard = PayloadWizard()
    assert wizard.begin(standing(WRIST[0]), TICKS, "the arm moves") == [
        Event(Kind.POSTURE_REFUSED, 0, {"reason": "the arm moves"})
    ]
    assert not wizard.left
    assert wizard.begin(standing(WRIST[0]), TICKS, "") == []
    (event,) = wizard.begin(standing(WRIST[0]), TICKS, "")
    assert event.values == {"reason": "a posture is being measured"}
    assert wizard.left


def test_what_comes_in_between_ends_the_measurement() -> None:
    wizard = PayloadWizard()
    value = standing(WRIST[0])
    wizard.begin(value, TICKS, "")
    wizard.step(value, "", ())
    (event,) = wizard.step(value, "the arm moves", ())
    assert (event.kind, event.values) == (Kind.POSTURE_REFUSED, {"reason": "the arm moves"})
    assert (wizard.left, wizard.progress) == (False, IDLE)


@pytest.mark.parametrize(("force", "kind"), [(0.9 * UNSTEADY, Kind.POSTURE_MEASURED), (1.1 * UNSTEADY, Kind.POSTURE_REFUSED)])
def test_a_hand_that_comes_in_between_is_noticed(force: float, kind: Kind) -> None:
    wizard = PayloadWizard()
    events = disturbed(wizard, [0.0, force, 0.0, 0.0, 0.0, 0.0])
    assert [event.kind for event in events] == [kind]
    assert wizard.progress.postures == (kind is Kind.POSTURE_MEASURED)
    if kind is Kind.POSTURE_REFUSED:
        assert events[0].values == {"reason": "the force changed by 1.1 N, at most 1 N: hands off the arm"}


def test_postures_that_tell_nothing_together_are_kept_and_the_reason_is_said() -> None:
    """A fan in one plane; one more out of it is enough."""
    wizard = PayloadWizard()
    events = [event for k in range(4) for event in measure(wizard, standing(turned(math.radians(23.0 * k))))]
    assert [event.kind for event in events][-2:] == [Kind.POSTURE_MEASURED, Kind.POSTURE_REFUSED]
    assert "across one direction" in wizard.progress.reason
    assert (wizard.progress.postures, wizard.progress.share, wizard.progress.finding) == (4, 0.0, None)
    assert events[-1].values == {"reason": wizard.progress.reason}
    events = measure(wizard, standing(turned(0.0, 1.0)))
    assert events[-1].kind is Kind.PAYLOAD_FOUND
    assert wizard.progress.reason == ""


def test_clearing_forgets_everything() -> None:
    wizard = PayloadWizard()
    for R in WRIST:
        measure(wizard, standing(R))
    wizard.clear()
    assert wizard.progress == IDLE
    assert wizard._postures == ()
    wizard.begin(standing(WRIST[0]), TICKS, "")
    wizard.clear()
    assert not wizard.left
    assert measure(wizard, standing(WRIST[0]))[0].values["number"] == 1


def test_there_is_an_end_to_postures() -> None:
    wizard = PayloadWizard()
    # On a spiral over the whole sphere, far enough from each other for their number (pi / 48).
    for k in range(MOST):
        z = 1.0 - (2.0 * k + 1.0) / MOST
        about = math.pi * (1.0 + math.sqrt(5.0)) * k
        axis = np.array([math.cos(about) * math.sqrt(1.0 - z * z), math.sin(about) * math.sqrt(1.0 - z * z), z])
        # Any rotation that turns `axis` of F upwards.
        side = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.9 else [0.0, 1.0, 0.0])
        side /= np.linalg.norm(side)
        R = np.stack([side, np.cross(axis, side), axis])
        assert measure(wizard, standing(R))[0].kind is Kind.POSTURE_MEASURED
    assert wizard.progress.postures == MOST
    (event,) = wizard.begin(standing(turned(0.123)), TICKS, "")
    assert event.values == {"reason": f"{MOST} postures are enough: clear them to begin again"}


@pytest.mark.parametrize(("ticks", "reasons"), [(48, ["the arm moves"]), (49, []), (50, [])])
def test_the_supervisor_lets_it_measure_once_the_arm_is_static(ticks: int, reasons: list[str]) -> None:
    """Static is slow for 0.1 s: 50 ticks, with that of the command."""
    bench = Bench()
    bench.step(value=estimate(qd=0.3))
    bench.run(ticks, value=standing(WRIST[0]))
    events = bench.step(Inputs(commands=(Command.WIZARD_MEASURE,)), standing(WRIST[0])).events
    assert [event.values["reason"] for event in events] == reasons


def test_a_sensor_that_is_zeroed_between_two_postures_changes_nothing_but_its_offset() -> None:
    """What F_user loses, the sensor gains."""
    gone = (1.0, -2.0, 0.5, 0.1, -0.2, 0.05)
    wizard = PayloadWizard()
    for R in WRIST[:2]:
        measure(wizard, standing(R))
    wizard.shift(gone)
    assert wizard.progress.finding is None
    for R in WRIST[2:]:
        value = standing(R)
        value.w_sensor = np.add(value.w_sensor, gone)
        measure(wizard, value)
    finding = wizard.progress.finding
    assert finding is not None
    assert finding.mass == pytest.approx(2.0)
    assert (*finding.force_offset, *finding.torque_offset) == pytest.approx(gone, abs=1e-9)
    wizard.shift(gone)
    finding = wizard.progress.finding
    assert finding is not None
    assert (*finding.force_offset, *finding.torque_offset) == pytest.approx(np.multiply(2.0, gone), abs=1e-9)
