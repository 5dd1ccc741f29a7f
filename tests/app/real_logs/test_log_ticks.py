"""A log as ticks: what is measured stays as it is, what is made up between rows is right, and a gap ends what was before."""

from dataclasses import replace

import numpy as np

from app.real_logs.log_mending import mend
from app.real_logs.log_ticks import BLOCK, SHORT, in_ticks, rows_are_ticks
from pendant.tick.modes import TICK
from tests.app.real_logs.synthetic_logs import ARM, columns, harmonics

INNER = slice(100, -100)
"""Filters know less at the ends."""


def log_of(values):
    return mend("log.csv", {**values, "t": values["t"][:, None]}, ARM, [])


def joined(log):
    blocks = list(in_ticks(log, ARM))
    return [np.concatenate([getattr(block, name) for block in blocks]) for name in ("t", "q", "tau_m")], blocks


def test_rows_that_are_ticks_stay_as_they_are():
    log = log_of(columns(seconds=24.0, rate=500.0))
    (t, q, torque), blocks = joined(log)
    assert rows_are_ticks(log)
    assert len(blocks) == 2
    assert len(t) == len(log.t) > BLOCK
    assert np.abs(q - log.q).max() < 1e-9
    assert np.abs(torque - log.motor_torque(ARM)).max() < 1e-6


def test_between_rows_is_the_motion_although_angles_are_rounded():
    values = columns(seconds=10.0, rate=95.0)
    log = log_of(values | {"q": values["q"].round(4), "qd": values["qd"].round(4)})
    (t, q, _), blocks = joined(log)
    assert np.abs(np.diff(t) - TICK).max() < 1e-9
    true_q, true_qd, true_qdd = (each[INNER] for each in harmonics(t))
    assert np.abs(q[INNER] - true_q).max() < 1e-4  # one step of the rounding
    _, speed, acceleration = (each[INNER] for each in blocks[0].planned)
    assert np.abs(speed - true_qd).max() < 1e-3
    assert np.abs(acceleration - true_qdd).max() < 0.05  # the angles alone would have noise of 1 rad/s²


def test_a_gap_begins_anew():
    values = columns(seconds=12.0, rate=125.0)
    kept = np.r_[0:500, 800:1500]
    _, blocks = joined(log_of({name: each[kept] for name, each in values.items()}))
    assert [block.run_in for block in blocks] == [SHORT, SHORT]
    assert blocks[1].t[0] - blocks[0].t[-1] > 2.0


def test_what_a_hand_leads_is_not_learned_from():
    log = log_of(columns(seconds=4.0, rate=125.0))
    guided = log.t > 2.0
    (block,) = in_ticks(replace(log, guided=guided), ARM)
    assert block.learns.tolist() == (block.t < 2.008 - 1e-9).tolist()  # the first row after it


def test_temperatures_that_are_missing_are_those_of_the_arms_file():
    log = log_of(columns(seconds=4.0, rate=125.0))
    warm = np.full_like(log.q, 50.0)
    warm[:10] = np.nan
    (block,) = in_ticks(replace(log, temperature=warm), ARM)
    assert block.temperature[0].tolist() == [ARM.frictions.temperature] * ARM.n
    assert block.temperature[-1].tolist() == [50.0] * ARM.n
