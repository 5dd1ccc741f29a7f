"""A log held against the controller: its own classes say what they said, and of a log that is known, what must come out."""

import csv

import numpy as np
import pytest
from typer.testing import CliRunner

from app.api import read, run, session
from app.cli import app
from app.files.bad_input import BadInput
from app.real_logs.against import ROWS, after_learning, hold_against
from app.real_logs.against_page import sentences, tables, write
from app.real_logs.log_controller import LogController
from app.real_logs.log_mending import mend
from app.real_logs.log_reader import believed, read_log
from app.real_logs.log_ticks import in_ticks
from app.session.prepare import prepare
from app.session.session_file import Setup
from tests.app.real_logs.synthetic_logs import ARM, columns, header, rows, text

THERE, BACK = [0.4, -1.0, 1.3, -1.6, -1.3, 0.4], [-0.4, -1.4, 1.7, -2.1, -1.8, -0.4]
RECORDED = {
    "title": "to and fro, then a push",
    "duration": 6.0,
    "seed": 3,
    "settings": {"contact.on": True},
    "program": {
        "name": "to and fro",
        "steps": [{"kind": "joint", "q": q, "speed": 0.4, "acceleration": 0.5} for q in (THERE, BACK, THERE, BACK)],
    },
    "timeline": [
        {"at": 0.1, "do": "change", "change": {"kind": "friction", "factor": 1.4}},
        {"at": 0.2, "do": "program", "command": "start"},
        {"at": 5.2, "do": "push", "part": "elbow", "for": 0.3, "force": [40.0, 0.0, 0.0]},
    ],
}
PUSH = 2400
"""Tick before the push from which on the arm stands."""
NOISE = 0.05 * 101 * 0.1
"""Of the torque in a synthetic log, about [N·m]."""


def prepared(**more):
    return prepare(Setup(robot="ur10e", mismatch="nominal", **more), "test")


def log_of(values, name="log.csv"):
    return mend(name, {**values, "t": values["t"][:, None]}, ARM, [])


def quiet(_done, _of):
    pass


class TestOwnRecording:
    """What a recording lacks is its plan and the accelerometers: filters that follow the motion itself stand for the one, the
    model for the others. So estimates come back to less than the sensors' own errors."""

    @pytest.fixture(scope="class")
    @classmethod
    def recorded(cls, tmp_path_factory):
        out = tmp_path_factory.mktemp("own")
        run(session(RECORDED), out)
        path = out / "log.mcap"
        own = believed(path, prepare(Setup(), "test"), chosen=False)
        log = read_log(path, own.arm)
        blocks = [LogController(own, two_angles=True).follow(ticks) for ticks in in_ticks(log, own.arm)]
        return read(path), own, blocks

    @pytest.mark.parametrize(
        ("ours", "theirs", "share"),
        [("friction", "friction", 0.002), ("tau_J", "tau_J", 0.002), ("external", "tau_ext", 0.005)],
    )
    def test_estimates_come_back(self, recorded, ours, theirs, share):
        log, own, ((out, _),) = recorded
        wrong = getattr(out, ours)[:PUSH] - log.state[theirs][:PUSH]
        assert (np.sqrt((wrong**2).mean(axis=0)) < share * np.array(own.arm.limits.torque)).all()

    def test_the_force_on_the_flange_comes_back(self, recorded):
        log, _, ((out, _),) = recorded
        assert np.abs(out.force - log.state["F_user"])[:PUSH].max() < 1.0

    def test_a_contact_is_told_when_it_was_told(self, recorded):
        log, _, ((_, told),) = recorded
        theirs = [(e.kind.replace("_", " "), e.values["part"], e.t) for e in log.events if e.kind.startswith("contact_")]
        assert [(each.what, each.part) for each in told] == [each[:2] for each in theirs]
        assert len(told) == 2
        assert np.abs([each.t - other[2] for each, other in zip(told, theirs, strict=True)]).max() <= 0.01


class TestKnownLog:
    """Currents of the rigid model and a friction that the arm's file does not have, with noise: all that is left is the noise."""

    @pytest.fixture(scope="class")
    @classmethod
    def found(cls):
        return hold_against(log_of(columns(seconds=16.0, rate=125.0)), prepared(), quiet)

    def test_from_half_to_double_of_what_is_true_it_learns_most_of_the_difference(self, found):
        """The file's friction is so of the elbow and the wrists, double of it is so of the wrists."""
        learned, started = after_learning(found, 8.0)
        assert sorted(started) == ["double", "half"]
        assert (learned[3] < 0.5 * learned[2])[2:].all()
        assert (started["double"][3] < 0.5 * learned[2])[3:].all()

    def test_a_fit_leaves_no_more(self, found):
        assert (found.residuals.fitted() < 1.2 * NOISE).all()

    def test_nothing_is_told_where_nothing_touches(self, found):
        assert found.told == []

    def test_it_says_what_the_log_lacks(self, found):
        said = " ".join(sentences(found))
        for words in ("125 rows a second", "one encoder", "no force at the flange", "no temperatures", "when a hand led"):
            assert words in said

    def test_page_and_tables(self, found, tmp_path):
        write(found, tmp_path)
        page = (tmp_path / "against.html").read_text()
        assert page.count("<svg") == ARM.n + 1
        assert all(joint in page for joint in ARM.chain.joints)
        lines = list(csv.reader((tmp_path / "against.csv").open()))
        assert lines[0][:2] == ["t", "q_base"]
        assert {len(line) for line in lines} == {1 + 5 * ARM.n + 3}
        assert len(lines) <= ROWS + 1
        assert [len(row) == len(head) for _, head, rows_ in tables(found) for row in rows_].count(False) == 0


class TestPushed:
    def test_a_push_that_moves_the_currents_of_a_moving_arm_is_told_when_it_comes(self):
        values = columns(seconds=6.0, rate=125.0)
        torque = 60.0 * ((values["t"] > 4.0) & (values["t"] < 4.6))  # two thirds of the elbow's largest friction above its own
        motor = ARM.motors.gear[2] * ARM.motors.torque_constant[2]
        values["current"][:, 2] += torque / motor
        found = hold_against(log_of(values), prepared(), quiet)
        first = {each.what: each.t for each in reversed(found.told)}
        assert 4.0 < first["contact gained"] < 4.2
        assert found.told[0].t > 4.0  # 100 N are a collision, too, and nothing is told before

    def test_a_collision_that_stops_the_arm_is_told_once_however_it_goes_on(self):
        """The force rises on after it was told, and ends while a robot would still stand; the next one comes after a reset."""
        values = columns(seconds=12.0, rate=125.0)
        since = values["t"][:, None] - [4.0, 10.0]
        torque = 60.0 * ((since > 0.0) & (since < 0.6)).any(axis=1)
        values["current"][:, 2] += torque / (ARM.motors.gear[2] * ARM.motors.torque_constant[2])
        told = [each.t for each in hold_against(log_of(values), prepared(), quiet).told if each.what == "collision"]
        assert [round(t, 1) for t in told] == [4.0, 10.0]


class TestSaid:
    def test_that_gaps_leave_nothing(self):
        values = columns(seconds=9.0, rate=125.0)
        kept = np.flatnonzero(np.arange(len(values["t"])) % 30 < 20)
        with pytest.raises(BadInput, match=r"no stretch of 0\.2 s"):
            hold_against(log_of({name: each[kept] for name, each in values.items()}), prepared(), quiet)

    def test_of_little_motion(self):
        found = hold_against(log_of(columns(seconds=3.0, rate=125.0)), prepared(), quiet)
        assert after_learning(found) is None
        assert "nothing is told of friction" in " ".join(sentences(found))

    def test_a_force_on_the_flange(self):
        values = columns(seconds=3.0, rate=125.0)
        force = np.zeros((len(values["t"]), 6))
        force[:, 2] = -20.0
        found = hold_against(log_of(values | {"wrench": force}), prepared(), quiet)
        assert found.force is not None
        assert 15.0 < found.force[0] < 30.0  # the plate's weight and motion are a few newtons
        assert "force on the flange" in " ".join(sentences(found))

    def test_what_was_chosen_goes_before_what_a_recording_says(self, tmp_path):
        own = prepared()
        assert believed(tmp_path / "none.mcap", own, chosen=False) is own
        (tmp_path / "bag.mcap").write_bytes(b"no recording")
        assert believed(tmp_path / "bag.mcap", own, chosen=False) is own
        assert believed(tmp_path / "bag.mcap", own, chosen=True) is own


class TestCommand:
    def test_prints_and_writes(self, tmp_path):
        path = tmp_path / "log.csv"
        path.write_text(text(rows(columns(seconds=3.0)), header()))
        done = CliRunner().invoke(app, ["against", str(path), "--robot", "ur10e", "--out", str(tmp_path / "out")])
        assert done.exit_code == 0, done.output
        assert "log.csv against the ur10e" in done.output
        assert "wrist_3" in done.output
        assert sorted(each.name for each in (tmp_path / "out").iterdir()) == ["against.csv", "against.html", "contacts.csv"]

    @pytest.mark.parametrize(
        ("options", "words"),
        [
            (["--effort", "force"], "torque or current"),
            (["--set", "contact.sensitivity=99"], "contact.sensitivity"),
            (["--columns", "t,q"], "no motor currents"),
        ],
    )
    def test_refuses_in_a_line(self, tmp_path, options, words):
        path = tmp_path / "log.csv"
        path.write_text(text(rows(columns(seconds=3.0)), header()))
        done = CliRunner().invoke(app, ["against", str(path), "--robot", "ur10e", *options])
        assert isinstance(done.exception, BadInput)
        assert words in str(done.exception)
