"""The way back after what went wrong: told in joints, and shown."""

import numpy as np
import pytest

from app.web.panel.way_back import LENGTH
from app.web.server import Served
from pendant.events.event import Event, Kind, posture_text
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import HOME, FakeLoop

THEN = HOME + np.array([0.1, 0.0, -0.2, 0.0, 0.0, 0.0])
LIMIT = {"parameter": "joint speed", "part": "elbow", "value": 1.2, "limit": 1.0, "unit": "rad/s"}
WALL = {"wall": "fence", "part": "tcp", "distance": 12.0, "way": "-y"} | dict(
    zip(("x", "y", "z", "px", "py", "pz"), (0.0, -1.0, 0.0, 0.3, 0.098, 0.3), strict=True)
)
BACK = {"joints": "elbow -11.5°, base +5.7°", "posture": posture_text(THEN)}


def show(loop: FakeLoop, still: Served, *events: tuple[Kind, dict[str, object]]) -> bool:
    loop.tick += 1
    fresh = [Event(kind, loop.tick, values) for kind, values in events]  # type: ignore[arg-type]
    return still.panel.back.show(loop.latest(), fresh)


def test_after_a_limit_the_joints_and_a_ghost_lead_back_until_the_arm_is_there(loop: FakeLoop, still: Served) -> None:
    back = still.panel.back
    assert show(loop, still, (Kind.LEFT_LIMIT, LIMIT), (Kind.WAY_BACK, BACK))
    assert back.ghost.posture == pytest.approx(tuple(THEN), abs=1e-4)
    assert "elbow -11.5°, base +5.7°" in back.text.shown
    assert not show(loop, still)
    loop.q = HOME + np.array([0.1, 0.0, -0.1, 0.0, 0.0, 0.0])
    assert show(loop, still, (Kind.ENTERED, {"from": "TEACH", "gain": 1.0}))
    assert "elbow -5.7°" in back.text.shown
    assert "base" not in back.text.shown
    loop.q = THEN + 0.04
    show(loop, still)
    assert back.ghost.posture is not None
    loop.q = THEN - 0.04
    loop.q[2:] += 0.04
    show(loop, still)
    assert back.ghost.posture is not None
    loop.q = THEN + 0.01
    assert show(loop, still)
    assert back.ghost.posture is None
    assert back.text.shown == ""


@pytest.mark.parametrize(
    "ended",
    [
        (Kind.LEFT_PERIOD, {"limit": 3.0}),  # nobody moved it: that is how free-drive ends
        (Kind.LEFT_RESTART, {"limit": 3.0}),
    ],
)
def test_after_an_end_that_is_none_to_mend_nothing_leads_back(
    loop: FakeLoop, still: Served, ended: tuple[Kind, dict[str, object]]
) -> None:
    assert not show(loop, still, ended, (Kind.WAY_BACK, BACK))
    assert still.panel.back.ghost.posture is None


@pytest.mark.parametrize("end", ["user", "program", "start over"])
def test_it_goes_when_the_user_has_another_wish(loop: FakeLoop, still: Served, end: str) -> None:
    show(loop, still, (Kind.LEFT_LIMIT, LIMIT), (Kind.WAY_BACK, BACK))
    assert still.panel.back.ghost.posture is not None
    if end == "program":
        loop.mode = Mode.RUN
    elif end == "start over":
        loop.tick = -1
    assert show(loop, still, *([(Kind.LEFT_PRESS, {"value": 0.2, "limit": 0.4})] if end == "user" else []))
    assert still.panel.back.ghost.posture is None


def test_behind_a_wall_an_arrow_leads_the_part_back(loop: FakeLoop, still: Served) -> None:
    back, snapshot = still.panel.back, loop.latest()
    snapshot.estimate.tcp[:3] = (0.4, 0.1, 0.3)
    snapshot.truth_links[0] = (0.0, 0.0, 1.0, np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))  # the base's -y is the world's x
    assert back.show(snapshot, [Event(Kind.LEFT_WALL, 1, WALL)])
    assert back.arrow.visible
    assert back.label.visible
    tail, tip = np.asarray(back.arrow.points)[0]
    assert tail == pytest.approx((-0.1, 0.4, 1.3), abs=1e-6)
    assert tip - tail == pytest.approx((LENGTH, 0.0, 0.0), abs=1e-6)
    assert back.label.text == "fence: 14.0 mm back"  # it has run on by 2 mm since
    assert not back.show(snapshot, [])
    snapshot.estimate.tcp[:3] = (0.5, 0.0865, 0.3)
    assert back.show(snapshot, [])
    assert back.label.text == "fence: 0.5 mm back"
    snapshot.estimate.tcp[1] = 0.085
    assert back.show(snapshot, [])
    assert not back.arrow.visible
    snapshot.estimate.tcp[1] = 0.1
    assert back.show(snapshot, [])
    assert back.arrow.visible
    assert back.show(snapshot, [Event(Kind.ENTERED, 2, {"from": "TEACH", "gain": 1.0})])
    assert not back.arrow.visible
    assert not back.label.visible


def test_where_the_way_cannot_be_told_there_is_no_arrow(loop: FakeLoop, still: Served) -> None:
    show(loop, still, (Kind.LEFT_WALL, WALL | {"distance": 0.0, "way": "unknown", "y": 0.0, "px": 9.0}))
    assert not still.panel.back.arrow.visible
