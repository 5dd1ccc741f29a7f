"""The reason of a refusal as a picture at the arm."""

import numpy as np

from app.web.server import Served
from pendant.events.event import Kind
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import FakeLoop

BEYOND = {"value": 0.031, "limit": 0.02, "unit": "m/s", "time": 0.1, "parameter": "joint speed"}


def test_the_parts_beyond_their_limits_are_marked_until_the_next_try(loop: FakeLoop, still: Served) -> None:
    for part in ("elbow", "wrist_1", "flange", "elbow"):
        loop.note(Kind.ENTRY_PREVENTED, part=part, **BEYOND)
    loop.note(Kind.REFUSED_LIMIT, part="elbow", **{name: BEYOND[name] for name in ("parameter", "value", "limit", "unit")})
    still.docks.show(loop.latest())
    marked = {mark.part: mark.text for mark in still.panel.marks.marked}
    assert set(marked) == {"elbow", "wrist_1", "flange"}
    assert marked["elbow"] == "joint speed: 0.031 m/s, limit 0.02"
    loop.note(Kind.ACTIVATION_STARTED, period=1.0)
    still.docks.show(loop.latest())
    assert still.panel.marks.marked == ()


def test_the_force_that_stays_is_an_arrow_that_follows_the_force(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.REFUSED_PAYLOAD, mass=1.9, force=18.0, way="down", zero=False, parameter="payload force")
    snapshot = loop.latest()
    still.panel.show(snapshot, loop.events(0))
    marks = still.panel.marks
    assert not marks.force.visible  # nothing is felt any more
    snapshot.estimate.F_user[:3] = (0.0, 0.0, 18.0)
    still.panel.show(snapshot, [])
    assert marks.force.visible
    assert marks.label.text == "Still 18 N"
    tail, tip = np.asarray(marks.force.points)[0]
    assert np.linalg.norm(tip - tail) > 0.05
    loop.mode = Mode.FREE_DRIVE
    still.docks.show(loop.latest())
    assert not marks.force.visible


def test_the_light_on_the_arm_has_the_colour_of_the_mode(loop: FakeLoop, still: Served) -> None:
    colours = set()
    for loop.mode in (Mode.TEACH, Mode.FREE_DRIVE, Mode.STOP):
        still.docks.show(loop.latest())
        colours.add(still.panel.marks._colour)
    assert len(colours) == 3
