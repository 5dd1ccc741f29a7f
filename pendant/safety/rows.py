"""Rows of the event table: protective stops of a robot that does not do what it should (RL-1, RL-3, RL-5)."""

from pendant.events.event import Kind
from pendant.events.event_row import EXCESS, EventRow, protected

MET = ("part", "force", "speed", "x", "y", "z", "posture")
"""Values of an event of what the arm meets: with which part, the force [N], the speed of that part at the contact [mm/s], the
place of the tool centre point in B [m], and the joint angles."""

PROTECTION: dict[Kind, EventRow] = {
    Kind.PATH_LEFT: protected(
        "Protective stop: the arm does not follow",
        "{joint} is off by {value:.1f}°, limit {limit:.1f}°, the tool by {distance:.0f} mm. Free the arm, then reset.",
        ("joint", "value", "limit", "distance", *MET),
        variant=(
            "part",
            "{part}: {force:.0f} N. {joint} is off by {value:.1f}°, the tool by {distance:.0f} mm. Reset, then jog it away.",
        ),
    ),
    Kind.COLLISION: protected(
        "Protective stop: collision",
        "{part}: {force:.0f} N at {speed:.0f} mm/s, limit {limit:.0f} N. Reset, then jog it away.",
        ("joint", "limit", *MET),
    ),
    Kind.LIMIT_EXCEEDED: protected(
        "Protective stop: {parameter} too large",
        "{part}: {value:.2f} {unit}, allowed {limit:.2f} in {mode}. Reset, then move more slowly.",
        (*EXCESS, "mode", "position"),
        variant=(
            "position",
            "{part}: {value:.1f}{unit}, allowed {limit:.1f}{unit} in {mode}. Reset, then move it back.",
        ),
    ),
}
