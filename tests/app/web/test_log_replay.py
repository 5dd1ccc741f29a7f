"""A log on the page: the arm as it was measured, the model's beside it, and plots that follow both time and the chosen joint."""

from dataclasses import replace

import numpy as np
import pytest

from app.files.library import mesh_path
from app.real_logs.against import hold_against
from app.session.prepare import prepare
from app.session.session_file import Setup
from app.web.access.listening import HERE
from app.web.log_replay import WINDOW, LogReplay
from pendant.equipment.load import Load
from pendant.inputs import NOTHING
from sim.arm.frames import joint_frames
from sim.exchange.desk import Wishes
from sim.simulation import Simulation
from tests.app.real_logs.synthetic_logs import ARM, columns
from tests.app.real_logs.test_against import log_of, quiet

LOAD = Load(mass=2.0, com=[0.0, 0.0, 0.05])
PUSHED = 120.0
"""On the elbow from 4 s on, which the model does not know of [N·m]."""


@pytest.fixture(scope="module")
def found():
    values = columns(seconds=14.0, rate=125.0)
    motor = ARM.motors.gear[2] * ARM.motors.torque_constant[2]
    values["current"][:, 2] += PUSHED * ((values["t"] > 4.0) & (values["t"] < 4.6)) / motor
    return hold_against(log_of(values), prepare(Setup(robot="ur10e", mismatch="nominal"), "test"), quiet)


@pytest.fixture
def site(found):
    prepared = prepare(Setup(robot="ur10e", mismatch="nominal", payload_true=LOAD, payload_configured=LOAD), "test")
    simulation = Simulation(prepared.arm, prepared.scenario, prepared.settings)
    simulation.tick(Wishes(NOTHING, (), ()))
    meshes = {part: mesh_path(ARM, part).read_bytes() for part in ("foot", *ARM.chain.joints)}
    first = replace(simulation.snapshot(), scenario=prepared.scenario)
    shown = LogReplay(found, first, meshes=meshes, access=HERE, port=0)
    shown.stop_drawing()
    yield shown
    shown.close()


def at(site, seconds):
    site.moment.jump(seconds)
    site.show()
    site.plot()


def test_the_arm_is_where_it_was_measured_and_carries_its_load(site, found):
    at(site, 7.0)
    snapshot = site._measured(site.row)
    row = found.table[site.row]
    assert row[0] == pytest.approx(7.0, abs=0.002)
    flange = joint_frames(ARM, row[1:7])[-1]
    assert snapshot.truth_links[-1][:3] == pytest.approx(flange[:3, 3], abs=1e-9)
    assert snapshot.truth_payload[:3] == pytest.approx(flange[:3, 3] + flange[:3, :3] @ LOAD.com, abs=0.01)


def test_the_models_arm_parts_from_it_under_a_torque_that_it_does_not_know(site, found):
    """The motor gives more and the arm moves as before: the model would have gone ahead of it."""
    at(site, 3.9)
    before = np.array(site.predicted.posture) - found.table[site.row, 1:7]
    at(site, 4.4)
    apart = np.array(site.predicted.posture) - found.table[site.row, 1:7]
    assert apart[2] > 0.2
    assert apart[2] > 5.0 * np.abs(before).max()


def test_the_plots_are_of_the_chosen_joint_and_mark_the_time(site, found):
    at(site, 9.0)
    site.joint.value = "elbow"
    site.plot()
    t, measured, predicted, external, now = site.torque.data
    assert t[int(np.argmax(now))] == pytest.approx(9.0, abs=0.05)
    assert t[-1] - t[0] == pytest.approx(WINDOW, abs=0.1)
    row = int(np.searchsorted(found.table[:, 0], t[0]))
    assert measured[0] == found.table[row, 1 + 6 + 2]
    assert predicted[0] == found.table[row, 1 + 12 + 2]
    assert external[0] == found.table[row, 1 + 24 + 2]
    assert len(site.apart.data) == 3


def test_what_would_have_been_told_leads_to_its_moment(site, found):
    first = found.told[0]
    site.time_line.marks.choice.value = next(name for name in site.time_line.marks._times)
    at(site, first.t)
    assert f"{first.t:.2f} of" in site.facts.shown
    assert "predicted" in site.facts.shown
