"""Axis locks from the settings, and the words for singularities (FD-4)."""

import math

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.inputs import NOTHING, Button, Inputs
from pendant.limits.axis_locks import AXES, JOINTS, PRESETS, axis_locks, freeing, freeing_joints, with_joints
from pendant.limits.nearness import Nearness
from pendant.limits.settings import AxisSettings, LockFrame
from pendant.supervisor import Supervisor
from pendant.tick.modes import Mode
from pendant.tick.motion_status import MotionStatus
from pendant.tick.pose import from_rpy
from sim.arm.frames import rotation_from_rpy
from tests.pendant.estimates import estimate


def test_presets_free_what_they_say() -> None:
    assert PRESETS["all"] == set(AXES)
    assert PRESETS["plane"] == {"x", "y", "rz"}
    assert PRESETS["translation"] == {"x", "y", "z"}
    assert PRESETS["rotation"] == {"rx", "ry", "rz"}


@pytest.mark.parametrize("name", [name for name in PRESETS if name != "all"])
def test_a_preset_becomes_settings_and_those_locks(name: str) -> None:
    settings = apply(Settings(), freeing(PRESETS[name]))
    locks = axis_locks(settings.axes)
    assert locks is not None
    assert locks.locked == tuple(axis not in PRESETS[name] for axis in AXES)
    assert axis_locks(apply(settings, freeing(PRESETS["all"])).axes) is None


def test_switched_off_nothing_is_locked() -> None:
    assert axis_locks(AxisSettings(x=False)) is not None
    assert axis_locks(AxisSettings(x=False, on=False)) is None


def test_locked_joints_become_locks_alone_or_with_axes() -> None:
    settings = apply(Settings(), freeing_joints(frozenset({2}), 6))
    alone = with_joints(None, settings.joints)
    assert alone is not None
    assert (alone.locked, alone.near) == ((False,) * 6, 0.0)
    assert alone.joints == (True, True, False, True, True, True, *(False,) * 6)
    axes = axis_locks(AxisSettings(x=False))
    assert axes is not None
    assert with_joints(axes, settings.joints) == axes._replace(joints=alone.joints)
    assert with_joints(axes, apply(settings, {"joints.on": False}).joints) is axes
    assert with_joints(None, apply(settings, freeing_joints(frozenset(range(6)), 6)).joints) is None
    assert len(JOINTS) == len(set(JOINTS)) == 12


def test_locked_joints_are_published_in_free_drive_whatever_a_script_locks() -> None:
    robot = Robot()
    decision = robot.step(Inputs(settings={"joints.j3": False}))
    assert decision.mode is Mode.FREE_DRIVE
    locks = robot.step().locks
    assert locks is not None
    assert locks.joints[2] is True
    robot.step(Inputs(settings={"joints.j3": True}))
    assert robot.step().locks is None


def test_the_frame_is_turned_by_roll_pitch_yaw() -> None:
    for rpy in ((0.3, 0.0, 0.0), (0.0, -0.7, 0.0), (0.0, 0.0, 2.0), (0.4, -1.1, 2.5)):
        np.testing.assert_allclose(np.reshape(from_rpy(*rpy), (3, 3)), rotation_from_rpy(rpy), atol=1e-12)
    locks = axis_locks(AxisSettings(x=False, yaw=0.5, frame=LockFrame.TOOL))
    assert locks is not None
    assert locks.tool
    assert from_rpy(0.0, 0.0, 0.5) == locks.R_BU


def test_without_resistance_singularities_resist_nowhere() -> None:
    with_it, without = axis_locks(AxisSettings(x=False)), axis_locks(AxisSettings(x=False, resistance=False))
    assert with_it is not None
    assert without is not None
    assert (with_it.near, with_it.too_near) == (0.04, 0.01)
    assert without.near == 0.0


class Robot:
    """A supervisor whose button is held until free-drive, at a singularity's distance that a test sets."""

    def __init__(self) -> None:
        self.supervisor = Supervisor(apply(Settings(), {"activation.period": 0.0}), 6)
        self.tick = -1
        self.near = math.inf
        for _ in range(60):
            self.step()
        for _ in range(800):
            decision = self.step(Inputs(held=frozenset({Button.FREE_DRIVE})))
            assert decision.locks is None
            if decision.mode is Mode.FREE_DRIVE:
                break

    def step(self, inputs: Inputs = NOTHING):
        self.tick += 1
        return self.supervisor.step(estimate(self.tick), inputs, MotionStatus(singularity=self.near))


def test_locks_hold_in_free_drive_and_can_be_changed_in_it() -> None:
    robot = Robot()
    robot.step(Inputs(settings=freeing(PRESETS["plane"])))
    locks = robot.step().locks
    assert locks is not None
    assert locks.locked == (False, False, True, True, True, False)
    robot.step(Inputs(settings={"axes.z": True}))
    locks = robot.step().locks
    assert locks is not None
    assert locks.locked == (False, False, False, True, True, False)
    robot.step(Inputs(settings=freeing(PRESETS["all"])))
    assert robot.step().locks is None


def test_a_singularity_is_published_and_told_where_an_axis_is_locked() -> None:
    robot = Robot()
    robot.near = 0.03
    decision = robot.step()
    assert decision.singularity is Nearness.NEAR
    assert not decision.events
    robot.step(Inputs(settings={"axes.x": False}))
    robot.near = 0.004
    decision = robot.step()
    assert decision.singularity is Nearness.TOO_NEAR
    assert [(event.kind, event.values) for event in decision.events] == [
        (Kind.SINGULARITY, {"status": "too near", "value": 0.004, "limit": 0.04})
    ]
    assert not robot.step().events
