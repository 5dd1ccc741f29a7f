"""Rows of the event table: protective stops of a robot that does not do what it should (RL-1, RL-3)."""

from pendant.events.event import Kind
from pendant.events.event_row import EventRow, protected

PROTECTION: dict[Kind, EventRow] = {
    Kind.PATH_LEFT: protected(
        "Protective stop: the arm does not follow",
        "{joint} is off by {value:.1f}°, limit {limit:.1f}°, the tool by {distance:.0f} mm. Free the arm, then reset.",
        ("joint", "value", "limit", "distance"),
    ),
    Kind.COLLISION: protected(
        "Protective stop: collision",
        "{part}: {force:.0f} N at {speed:.0f} mm/s, limit {limit:.0f} N. Reset, then jog or guide it away.",
        ("part", "force", "limit", "speed"),
    ),
}
