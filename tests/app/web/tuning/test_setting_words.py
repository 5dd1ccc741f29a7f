"""Settings in the words of the field."""

import pytest

from app.web.tuning.setting_words import setting_change
from pendant.events.event import Event, Kind

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")


@pytest.mark.parametrize(
    ("name", "new", "text"),
    [
        ("program.speed", 0.25, "Speed 25 %"),
        ("joints.j3", True, "Elbow: free"),
        ("joints.j4", True, "Wrist 1: free"),
        ("joints.j12", False, "Joint 12: locked"),
        ("axes.x", False, "Moving along x: locked"),
        ("axes.rz", True, "Turning about z: free"),
        ("joints.on", False, "Locked joints: off"),
        ("free_drive.period", 8.0, "Free-drive, no motion: 8 s"),
        ("limits.activation.flange_speed.max", 0.03, "Limits of the check, flange speed: 0.03 m/s"),
    ],
)
def test_a_change_is_told_by_what_it_is_called_on_the_page(name: str, new: object, text: str) -> None:
    assert setting_change(Event(Kind.SETTING_CHANGED, 0, {"name": name, "old": 0.0, "new": new}), JOINTS) == text  # type: ignore[dict-item]


def test_a_refused_change_says_so_and_has_the_name_that_was_sent_where_there_is_no_such_setting() -> None:
    def refused(name: str, value: object) -> str:
        return setting_change(Event(Kind.SETTING_REFUSED, 0, {"name": name, "value": value, "reason": "no"}), JOINTS)  # type: ignore[dict-item]

    assert refused("free_drive.period", 900.0) == "Free-drive, no motion: 900 s refused"
    assert refused("program.speed", "fast") == "Programs, speed: fast refused"
    assert refused("no.such", 1.0) == "no.such: 1.0 refused"
