"""The fingers' drive: where it goes, how fast, within what it can."""

import pytest

from sim.arm.scenario import Cup, Fingers
from sim.gripping.finger_drive import FingerDrive, vacuum_force


def test_it_begins_open_and_goes_where_it_is_told() -> None:
    drive = FingerDrive(Fingers())
    assert (drive.opening, drive.moving) == (0.085, False)
    drive.order(0.05, 0.1, 40.0)
    drive.step(0.1)
    assert drive.opening == pytest.approx(0.075)
    drive.step(1.0)
    assert (drive.opening, drive.moving, drive.closing) == (0.05, False, True)
    drive.order(0.06, None, None)
    drive.step(1.0)
    assert (drive.opening, drive.closing) == (0.06, False)


def test_what_is_beyond_its_range_is_its_limit() -> None:
    drive = FingerDrive(Fingers())
    drive.order(9.0, 9.0, 9000.0)
    assert (drive.wanted, drive.speed, drive.force) == (0.085, 0.15, 235.0)
    drive.order(0.0, 0.001, 1.0)
    assert (drive.wanted, drive.speed, drive.force) == (0.0, 0.02, 20.0)
    drive.stop()
    assert not drive.moving


def test_a_cup_is_pressed_on_by_the_air() -> None:
    assert vacuum_force(Cup(radius=0.02, vacuum=60e3)) == pytest.approx(75.4, abs=0.01)
