"""The tool centre point from poses that touch one point."""

from collections.abc import Callable

import numpy as np
import pytest

from app.web.server import Served
from app.web.tool_point.touching_poses import FlangePose, TouchingPoses, flange_of, tip_of
from sim.arm.frames import rotation_from_rpy
from sim.exchange.snapshot import Snapshot
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

TIP = np.array([0.012, -0.034, 0.187])
POINT = np.array([-0.4, 0.1, 0.05])
TURNED = [(3.1, 0.0, 0.0), (2.6, 0.0, 0.3), (3.6, 0.4, -0.2), (3.1, -0.5, 1.0)]
"""Roll, pitch, yaw of a tool that points down, more or less."""


def poses(turns: list[tuple[float, float, float]], off: float = 0.0) -> list[FlangePose]:
    """Flange poses that bring the tip to the point, or up to `off` [m] beside it."""
    rng = np.random.default_rng(5)
    made = []
    for turn in turns:
        R = rotation_from_rpy(turn)
        aside = rng.normal(size=3)
        made.append(FlangePose(POINT + off * aside / np.linalg.norm(aside) - R @ TIP, R))
    return made


def test_four_exact_touches_tell_the_tip() -> None:
    found = tip_of(poses(TURNED))
    assert found is not None
    np.testing.assert_allclose(found.tcp, TIP, atol=1e-12)
    assert found.worst < 1e-12


def test_touches_a_millimetre_off_move_it_by_five_at_most_and_that_is_told() -> None:
    found = tip_of(poses(TURNED, off=0.001))
    assert found is not None
    assert 0.0 < float(np.linalg.norm(np.array(found.tcp) - TIP)) < 0.005
    assert 0.0002 < found.worst < 0.002


@pytest.mark.parametrize(
    "turns",
    [
        [(3.1, 0.0, 0.0)] * 4,
        [(3.1, 0.0, yaw) for yaw in (0.0, 1.0, 2.0, 3.0)],
        [(3.1 + k / 100.0, 0.0, k / 50.0) for k in range(4)],
    ],
    ids=["not turned", "about one axis", "hardly turned"],
)
def test_poses_that_cannot_tell_are_refused(turns: list[tuple[float, float, float]]) -> None:
    assert tip_of(poses(turns)) is None


def test_on_the_page_the_tools_tcp_is_set(
    served: Served, join: Callable[[], RawClient], loop: FakeLoop, monkeypatch: pytest.MonkeyPatch
) -> None:
    client, folder = join(), served.docks.tools.touching
    assert isinstance(folder, TouchingPoses)
    wanted = iter(poses(TURNED))
    module = "app.web.tool_point.touching_poses.flange_of"
    monkeypatch.setattr(module, lambda _: next(wanted))
    for count in range(1, 5):
        client.set(folder.take._impl.uuid, value=True)
        until(lambda count=count: len(folder._poses) == count, "taken")
    until(lambda: "TCP found" in folder.said.shown and not folder.use.disabled, "found")
    client.set(folder.use._impl.uuid, value=True)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].inputs.tools), "asked for")
    np.testing.assert_allclose(loop.wishes[-1].inputs.tools[0].tcp, TIP, atol=5e-5)


def test_the_flange_is_where_the_controller_knows_it(loop: FakeLoop) -> None:
    snapshot: Snapshot = loop.latest()
    snapshot.estimate.p_BF[:] = (0.1, 0.2, 0.3)
    np.testing.assert_allclose(flange_of(snapshot).p, (0.1, 0.2, 0.3))
