"""`pendant fit` as a user has it: logs as text in, an arm's file out, and what they could not tell is said."""

import numpy as np
import pytest
from typer.testing import CliRunner

from app.cli import app
from app.files.bad_input import BadInput
from app.files.library import load_arm
from app.real_logs.fitting import deviations, fit_logs
from app.real_logs.log_reader import read_log
from benchmarks.fits.drawn_arms import DrawnArm
from tests.app.real_logs.synthetic_logs import header, text

ARM = load_arm("ur10e")
COLUMNS = header(("actual_q", "actual_qd", "actual_current_as_torque"))


def log_of(arm, path, loaded=False, still=()):
    path.write_text(text(np.column_stack(arm.log(loaded, still)), COLUMNS))
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder, arm = tmp_path_factory.mktemp("logs"), DrawnArm(ARM, 72, seconds=30.0)
    log_of(arm, folder / "bare.csv")
    log_of(arm, folder / "loaded.csv", loaded=True)
    log_of(arm, folder / "other.csv")
    lines = (folder / "other.csv").read_text().splitlines()
    (folder / "brief.csv").write_text("\n".join(lines[: len(lines) // 6]))
    log_of(arm, folder / "half.csv", still=[0, 1, 4])
    log_of(arm, folder / "still.csv", still=range(6))
    return folder


def fitted(folder, *names, judge=(), loads=None):
    logs, judged = ([read_log(folder / name, ARM) for name in each] for each in (names, judge))
    return fit_logs(ARM, logs, judged, loads=loads or {}, name="mine")


def said(*options):
    return CliRunner().invoke(app, ["fit", *options, "--robot", "ur10e"], catch_exceptions=True)


def test_the_command_writes_an_arm_that_can_be_used(folder):
    out = folder / "My arm.yaml"
    logs = [str(folder / name) for name in ("bare.csv", "loaded.csv")]
    judges = [word for name in ("other.csv", "brief.csv") for word in ("--judge", str(folder / name))]
    result = said(*logs, "--load", "loaded.csv=?", "--out", str(out), *judges)
    assert result.exit_code == 0, result.output
    for words in (
        "Load:",
        "other.csv, RMS",
        "left by the fit",
        "brief.csv, in which no joint moves for 10 s: not judged",
        "torque constants stand on the filed masses",
    ):
        assert words in result.output
    made = load_arm(str(out))
    assert made.name == "my-arm"
    assert made.frictions.status == "measured"
    assert "bare.csv, loaded.csv (60 s)" in made.frictions.source
    assert "# motors.rotor_inertia" in out.read_text()


def test_another_log_judges(folder):
    found = fitted(folder, "bare.csv", judge=["other.csv"])
    (judged,) = found.judged
    assert judged.name == "other.csv"
    assert (judged.after < 0.5 * judged.before).all()
    assert (judged.after < 1.5 * judged.best).all()
    assert len(deviations(found.found)) == 10


def test_what_no_log_tells_is_said_and_stays(folder):
    found = fitted(folder, "half.csv")
    assert any("base, shoulder, wrist_2 hardly moved" in line for line in found.told)
    assert any("no load was named" in line for line in found.told)
    assert found.arm.motors.rotor_inertia[0] == pytest.approx(ARM.motors.rotor_inertia[0], abs=1e-3)
    assert found.arm.frictions.torque[4] == pytest.approx(ARM.frictions.torque[4], abs=1e-3)


def test_logs_without_motion_are_refused(folder):
    with pytest.raises(BadInput, match="no joint moves for 10 s"):
        fitted(folder, "still.csv")


def test_two_masses_of_the_one_load_are_refused(folder):
    with pytest.raises(BadInput, match="the same mass in all"):
        fitted(folder, "bare.csv", "loaded.csv", loads={"bare.csv": 1.0, "loaded.csv": 2.0})


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--load", "bare.csv"), "expected LOG=KG or LOG=?"),
        (("--load", "none.csv=1"), "with a log of bare.csv"),
        (("--load", "bare.csv=heavy"), "expected a mass in kilograms, or ?"),
        (("--load", "bare.csv=-1"), "more than 0 and at most 100 kg"),
        (("--effort", "force"), "expected torque or current"),
        (("--judge", "nowhere.csv"), "is no file"),
    ],
)
def test_a_wrong_option_is_said(folder, options, words):
    result = said(str(folder / "bare.csv"), *options)
    assert result.exit_code != 0
    assert words in str(result.exception)
