"""Logs as people have them: what is read is what was written; of a broken log, a told repair or one clear line."""

import numpy as np
import pytest
from mcap_ros2.writer import Writer

from app.files.bad_input import BadInput
from app.real_logs.log_reader import read_log
from tests.app.real_logs.synthetic_logs import ARM, columns, header, rows, text

VALUES = columns()
MAP = "t,q,qd,current"


def written(tmp_path, content, name="log.csv"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def same(log, *, within=2e-6):
    for what in ("q", "qd", "current"):
        assert np.abs(getattr(log, what) - VALUES[what]).max() < within
    assert np.abs(log.t - VALUES["t"]).max() < within


def changed(**what):
    return VALUES | what


class TestForms:
    def test_of_ur_rtde(self, tmp_path):
        same(read_log(written(tmp_path, text(rows(VALUES), header())), ARM))

    def test_of_record_py_with_spaces_and_more_columns(self, tmp_path):
        names = [*header(), "target_q_0", "robot_status_bits"]
        table = np.column_stack([rows(VALUES), VALUES["q"][:, 0], np.ones(len(VALUES["t"]))])
        same(read_log(written(tmp_path, text(table, names, " ")), ARM))

    def test_without_a_header_with_a_map(self, tmp_path):
        table = np.column_stack([rows(VALUES), np.zeros((len(VALUES["t"]), 12))])
        log = read_log(written(tmp_path, text(table)), ARM, columns=f"{MAP},-12")
        same(log)
        assert log.told == ()

    def test_with_semicolons_and_decimal_commas(self, tmp_path):
        content = text(rows(VALUES), header(), ";").replace(".", ",")
        same(read_log(written(tmp_path, content), ARM))

    def test_with_units_in_the_map(self, tmp_path):
        table = rows(changed(t=VALUES["t"] * 1e3, q=np.degrees(VALUES["q"]), qd=np.degrees(VALUES["qd"])))
        same(read_log(written(tmp_path, text(table, digits=9)), ARM, columns="t:ms,q:deg,qd:deg/s,current"))

    @pytest.mark.parametrize("rate", [50.0, 95.0, 125.0, 500.0, 1000.0])
    def test_at_any_rate(self, tmp_path, rate):
        log = read_log(written(tmp_path, text(rows(columns(4.0, rate)), header())), ARM)
        assert log.rate == pytest.approx(rate, rel=0.01)

    def test_a_bag_of_ros_2(self, tmp_path):
        log = read_log(bag(tmp_path), ARM, effort="current")
        same(log)
        assert log.wrench is not None
        assert np.array_equal(log.wrench[5], [1.0, 2.0, 3.0, 0.0, 0.0, 0.0])
        assert log.told == ("effort is taken as current [A]",)


JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
WRENCH = """std_msgs/Header header
geometry_msgs/Wrench wrench
================================================================================
MSG: geometry_msgs/Wrench
geometry_msgs/Vector3 force
geometry_msgs/Vector3 torque
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
UR_ORDER = [2, 1, 0, 3, 4, 5]  # by the alphabet, as ROS publishes them
UR_NAMES = ["elbow_joint", "shoulder_lift_joint", "shoulder_pan_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]


def bag(tmp_path, names=UR_NAMES, efforts=True, joint_states=True):
    path = tmp_path / "bag.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        other = writer.register_msgdef("geometry_msgs/msg/WrenchStamped", WRENCH)
        for k, t in enumerate(VALUES["t"]):
            nanoseconds = round(t * 1e9)
            stamp = {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}
            head = {"stamp": stamp, "frame_id": ""}
            force = {"force": {"x": 1.0, "y": 2.0, "z": 3.0}, "torque": {"x": 0.0, "y": 0.0, "z": 0.0}}
            writer.write_message("/wrench", other, {"header": head, "wrench": force}, nanoseconds, nanoseconds, k)
            if joint_states:
                position, velocity, effort = (VALUES[what][k][UR_ORDER].tolist() for what in ("q", "qd", "current"))
                message = {"header": head, "name": names, "position": position, "velocity": velocity}
                message["effort"] = effort if efforts else []
                writer.write_message("/joint_states", schema, message, nanoseconds, nanoseconds, k)
        writer.finish()
    return path


def gap(table):
    return np.delete(table, slice(200, 320), axis=0)


def out_of_order(table):
    return np.concatenate([table[:100], table[200:300], table[100:200], table[300:]])


def twice(table):
    return np.concatenate([table[:100], table[99:]])


def with_nan(table):
    table = table.copy()
    table[50:60, 3] = np.nan
    return table


def still(table):
    table = table.copy()
    table[:, 3], table[:, 9] = 1.0, 0.0
    return table


def scaled(part, factor):
    def change(table):
        table = table.copy()
        table[:, part] *= factor
        return table

    return change


Q, QD, CURRENT = slice(1, 7), slice(7, 13), slice(13, 19)
DEGREES = 180.0 / np.pi

MENDED = [
    (gap, "1 gap, the longest of 0.97 s at 1.59 s"),
    (out_of_order, "times went back 1 time: rows are sorted"),
    (twice, "1 row of the same time as the one before left out"),
    (with_nan, "10 rows without a number left out"),
    (still, "elbow did not move: nothing is told of the friction there"),
    (scaled(0, 1e3), "times are milliseconds, by their distance"),
    (scaled(0, 1e6), "times are microseconds, by their distance"),
    (scaled(0, 1e9), "times are nanoseconds, by their distance"),
    (scaled(Q, DEGREES), "angles are degrees"),
    (scaled(QD, DEGREES), "speeds are degrees a second, by angles and speeds together"),
    (scaled(slice(1, 13), DEGREES), "speeds are degrees a second, by angles and speeds together"),
    (scaled(CURRENT, 1e3), "currents are milliamperes, by their range"),
]


@pytest.mark.parametrize(("change", "told"), MENDED)
def test_what_is_mended_is_told(tmp_path, change, told):
    log = read_log(written(tmp_path, text(change(rows(VALUES)), header())), ARM)
    assert any(told in each for each in log.told), log.told
    if change.__name__ == "change":
        same(log, within=1e-5)
    assert np.all(np.diff(log.t) > 0.0)


def test_a_gap_ends_a_stretch(tmp_path):
    log = read_log(written(tmp_path, text(gap(rows(VALUES)), header())), ARM)
    assert [part.start for part in log.stretches] == [0, 200]


def test_a_broken_line_is_left_out(tmp_path):
    lines = text(rows(VALUES), header()).splitlines()
    lines[300] = lines[300][:60]
    log = read_log(written(tmp_path, "\n".join(lines)), ARM)
    assert log.told == ("1 line with another number of columns left out",)


def test_speeds_that_lack_are_derived(tmp_path):
    content = text(rows(VALUES, ("t", "q", "current")), header(("actual_q", "actual_current")))
    log = read_log(written(tmp_path, content), ARM)
    assert np.abs(log.qd - VALUES["qd"])[1:-1].max() < 0.01
    assert "it has no speeds: they are derived from the angles, and are noisier" in log.told


PLAIN = text(rows(VALUES), header())
BROKEN = {
    "empty": (b"", "log.csv: is empty"),
    "header alone": (",".join(header()), "log.csv: has a header and no row"),
    "comments alone": ("# a log\n#\n", "log.csv: has no row"),
    "binary": (b"\x7fELF\0\0\0", "log.csv: is no table of text"),
    "no header": (text(rows(VALUES)), "log.csv: has no header; say what its columns are"),
    "no angles": (
        text(rows(VALUES, ("t", "qd", "current")), header(("actual_qd", "actual_current"))),
        "has no column of joint ang",
    ),
    "no times": (text(rows(VALUES), header(time="row")), "log.csv: has no column of times (t)"),
    "no torque": (
        text(rows(VALUES, ("t", "q", "qd")), header(("actual_q", "actual_qd"))),
        "has no motor currents and no torques",
    ),
    "five joints": (text(rows(VALUES)[:, :18], header()[:18]), "actual_current: has 5 columns; expected 6, numbered 0 to 5"),
    "a column twice": (text(rows(VALUES), [*header()[:-1], "actual_q_0"]), "actual_q_0: stands in the header twice"),
    "a word among numbers": (PLAIN.replace("\n0.80", "\noops0.80", 1), "oops0.80"),
    "two rows": ("\n".join(PLAIN.splitlines()[:3]), "has 2 rows; expected 2 s of motion or more"),
    "too short": ("\n".join(PLAIN.splitlines()[:100]), "is 0.78 s long; expected 2 s or more"),
    "ten times a second": (text(rows(VALUES)[::12], header()), "has 10.4 rows a second; expected 50 to 1000"),
    "half of the rows empty": (
        text(rows(VALUES) * np.where(np.arange(750) % 2 == 0, 1.0, np.nan)[:, None], header()),
        "rows lack a num",
    ),
    "half of the lines cut": (
        "\n".join(line[: 99 if k % 2 else None] for k, line in enumerate(PLAIN.splitlines())),
        "of 750 lines do not have 19 columns",
    ),
    "speeds of another unit": (text(scaled(QD, 3.0)(rows(VALUES)), header()), "the angles change 0.333 times as fast"),
    "currents of another arm": (text(scaled(CURRENT, 14.0)(rows(VALUES)), header()), "times the rated torque"),
    "faster than it can": (text(scaled(0, 0.2)(scaled(QD, 5.0)(rows(columns(12.0)))), header()), "another arm, or another unit"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_what_cannot_be_mended_is_one_line(tmp_path, case):
    content, line = BROKEN[case]
    with pytest.raises(BadInput) as refused:
        read_log(written(tmp_path, content), ARM)
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


BAGS = {
    "of no joints": ({"joint_states": False}, "has no topic of sensor_msgs/JointState"),
    "of other joints": ({"names": [f"axis_{k}" for k in range(6)]}, "expected one joint of base, shoulder"),
    "without efforts": ({"efforts": False}, "all messages are without angle, speed and effort of all joints"),
}


@pytest.mark.parametrize("case", BAGS)
def test_a_bag_that_cannot_be_used_is_one_line(tmp_path, case):
    changes, line = BAGS[case]
    with pytest.raises(BadInput, match=line):
        read_log(bag(tmp_path, **changes), ARM)


def test_a_bag_that_is_cut_is_one_line(tmp_path):
    path = bag(tmp_path)
    path.write_bytes(path.read_bytes()[:20_000])
    with pytest.raises(BadInput, match="damaged bag"):
        read_log(path, ARM)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("t,q,speed", "expected columns in order"),
        ("t,t", "each once"),
        ("t:h", "expected one of s, ms, us, ns"),
        (f"{MAP},torque", "the table has 19"),
    ],
)
def test_a_map_that_does_not_fit_is_one_line(tmp_path, words, line):
    with pytest.raises(BadInput, match=line):
        read_log(written(tmp_path, text(rows(VALUES))), ARM, columns=words)


def test_a_file_that_is_not_there_or_of_sqlite_is_one_line(tmp_path):
    with pytest.raises(BadInput, match="is no file"):
        read_log(tmp_path / "none.csv", ARM)
    with pytest.raises(BadInput, match="ros2 bag convert"):
        read_log(written(tmp_path, b"SQLite", "bag.db3"), ARM)
