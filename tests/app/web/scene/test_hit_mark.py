"""Where the arm hit is marked at the arm, until the stop is reset."""

import numpy as np
import pytest

from app.web.scene.hit_mark import where
from app.web.server import Served
from pendant.events.event import Kind, posture_text
from pendant.tick.modes import Mode, Safety
from sim.arm.frames import joint_frames
from tests.app.web.fake_loop import ARM, HOME, FakeLoop

MET = {"force": 180.0, "speed": 250.0, "x": 0.5, "y": -0.1, "z": 0.2, "posture": posture_text(HOME)}
ORIGINS = joint_frames(ARM, HOME)[:, :3, 3]
SHOULDER, ELBOW, WRIST = 1, 2, 3


@pytest.mark.parametrize(
    ("part", "place"),
    [
        ("tool", (0.5, -0.1, 0.2)),
        ("elbow", ORIGINS[ELBOW]),
        ("elbow or forearm", 0.75 * ORIGINS[ELBOW] + 0.25 * ORIGINS[WRIST]),
        ("forearm", (ORIGINS[ELBOW] + ORIGINS[WRIST]) / 2),
    ],
)
def test_a_hit_is_where_the_part_was(part: str, place: tuple[float, ...]) -> None:
    assert where(ARM, MET | {"part": part}) == pytest.approx(np.array(place), abs=1e-3)


@pytest.mark.parametrize("part", ["wrist", "wrist or tool"])
def test_a_hit_on_a_wrist_is_beyond_the_forearm(part: str) -> None:
    place = where(ARM, MET | {"part": part})
    assert all(np.linalg.norm(place - each) < 0.15 for each in ORIGINS[WRIST:])


@pytest.mark.parametrize(
    ("kind", "more"),
    [
        (Kind.COLLISION, {"joint": "elbow", "limit": 50.0}),
        (Kind.PATH_LEFT, {"joint": "elbow", "value": 1.0, "limit": 0.8, "distance": 3.0}),
    ],
)
def test_the_mark_tells_force_and_speed_and_goes_with_the_reset(
    loop: FakeLoop, still: Served, kind: Kind, more: dict[str, float | str]
) -> None:
    mark = still.panel.hit
    loop.mode, loop.safety = Mode.STOP, Safety.PROTECTIVE_STOP
    loop.note(kind, **MET, **more, part="forearm")
    still.docks.show(loop.latest())
    assert (mark.ball.visible, mark.label.visible) == (True, True)
    assert mark.label.text == "Forearm: 180 N at 250 mm/s"
    assert np.asarray(mark.ball.position) == pytest.approx((ORIGINS[ELBOW] + ORIGINS[WRIST]) / 2, abs=1e-3)
    assert not still.docks.show(loop.latest())
    loop.mode, loop.safety = Mode.TEACH, Safety.NORMAL
    loop.tick += 1
    still.docks.show(loop.latest())
    assert (mark.ball.visible, mark.label.visible) == (False, False)


def test_nothing_is_marked_where_nothing_tells_what_holds_the_arm(loop: FakeLoop, still: Served) -> None:
    loop.mode = Mode.STOP
    loop.note(Kind.PATH_LEFT, **MET, part="", joint="elbow", value=1.0, limit=0.8, distance=3.0)
    still.docks.show(loop.latest())
    assert not still.panel.hit.ball.visible
