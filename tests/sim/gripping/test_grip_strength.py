"""What a grip bears: by Coulomb's friction, worked out by hand (GR-1)."""

import math

import pytest

from sim.gripping.grip_strength import GripContact, HeldBody, load_on_grip, pad_radius, strength_taken

FINGERS = GripContact((0.0, 0.0, 0.1), (1.0, 0.0, 0.0), True, 50.0, 0.5, 0.012)
CUP = GripContact((0.0, 0.0, 0.1), (0.0, 0.0, -1.0), False, 75.0, 0.5, 0.02)


def taken(grip: GripContact, force: tuple[float, float, float], torque: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> float:
    return strength_taken(grip, (*force, *torque), (0.0, 0.0, 0.1))


def test_two_fingers_hold_twice_mu_f() -> None:
    assert taken(FINGERS, (0.0, 0.0, -50.0)) == pytest.approx(1.0)
    assert taken(FINGERS, (0.0, 30.0, 40.0)) == pytest.approx(1.0)
    assert taken(FINGERS, (25.0, 0.0, 0.0)) == pytest.approx(0.5), "along the fingers one of them bears it"


def test_turning_about_the_pads_is_held_by_two_thirds_of_their_radius() -> None:
    arm = 2.0 / 3.0 * 0.012
    assert taken(FINGERS, (0.0, 0.0, 0.0), (50.0 * arm, 0.0, 0.0)) == pytest.approx(1.0)
    assert taken(FINGERS, (0.0, 0.0, -30.0), (40.0 * arm, 0.0, 0.0)) == pytest.approx(1.0), "both on an ellipse"


def test_a_part_beside_the_fingers_turns_about_them() -> None:
    beside = strength_taken(FINGERS, (0.0, 0.0, -10.0, 0.0, 0.0, 0.0), (0.0, 0.02, 0.1))
    assert beside == pytest.approx(math.hypot(10.0, 10.0 * 0.02 / (2.0 / 3.0 * 0.012)) / 50.0)


def test_a_cup_holds_its_vacuum_and_less_along_the_face() -> None:
    assert taken(CUP, (0.0, 0.0, -75.0)) == pytest.approx(1.0), "the axis points away from the part: this pulls at it"
    assert taken(CUP, (0.0, 37.5, 0.0)) == pytest.approx(1.0)
    assert taken(CUP, (0.0, 0.0, 0.0), (0.0, 1.5, 0.0)) == pytest.approx(1.0), "tilted off about its rim"
    assert taken(CUP, (0.0, 0.0, 20.0)) == 0.0, "pressed on"


def test_what_does_not_press_holds_nothing() -> None:
    assert taken(FINGERS._replace(force=0.0), (0.0, 0.0, -1.0)) == math.inf
    assert taken(FINGERS._replace(friction=0.0), (0.0, 0.0, -1.0)) == math.inf


def test_the_load_is_weight_and_inertia_without_what_bears_it_elsewhere() -> None:
    body = HeldBody(2.0, (0.0, 0.0, 0.1), (0.01, 0.02, 0.03, 0.0, 0.0, 0.0))
    still = (0.0, 0.0, -9.81, 0.0, 0.0, 0.0)
    nothing = (0.0,) * 6
    assert load_on_grip(still, (0.0, 0.0, 0.0), body, nothing) == pytest.approx((0.0, 0.0, -19.62, 0.0, 0.0, 0.0))
    lies = (0.0, 0.0, -19.62, 0.0, 0.0, 0.0)
    assert load_on_grip(still, (0.0, 0.0, 0.0), body, lies) == pytest.approx((0.0,) * 6)
    spun = load_on_grip((0.0, 0.0, 0.0, 3.0, 0.0, 0.0), (0.0, 4.0, 0.0), body, nothing)
    assert spun == pytest.approx((2.0 * 4.0 * 0.1, 0.0, -2.0 * 9.0 * 0.1, 0.0, 0.02 * 4.0, 0.0))


def test_a_pad_counts_as_a_disc_of_its_area() -> None:
    assert math.pi * pad_radius(0.022) ** 2 == pytest.approx(0.022**2)
