"""The arrow of the user's force and the ellipsoid round its tip: place, size and direction in the picture (FD-19)."""

from collections.abc import Iterator

import numpy as np
import pytest

from app.web.scene.force_ellipsoid import BELOW, LEAST_FORCE, METRES_PER_NEWTON, THINNEST
from app.web.server import Served, serve
from sim.arm.frames import matrix_from_quaternion
from sim.arm.scenario import Scenario
from sim.exchange.told_force import WITHIN_95, UncertainForce
from tests.app.web.fake_loop import ARM, FakeLoop

QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # about z
VARIANCES = np.diag([1.0, 4.0, 9.0])


@pytest.fixture
def still(loop: FakeLoop) -> Iterator[Served]:
    """A web app whose painter does not run."""
    app = serve(loop, ARM, Scenario())
    app.stop_drawing()
    yield app
    app.close()


def test_both_are_there_while_a_force_is_told(loop: FakeLoop, still: Served) -> None:
    drawn = still.scene.user
    still.scene.show(loop.latest())
    assert [node.visible for node in (drawn.arrow, drawn.ellipsoid, drawn.label)] == [False] * 3
    loop.user = UncertainForce((0.0, 30.0, 0.0), VARIANCES)
    assert still.scene.show(loop.latest())
    assert not still.scene.show(loop.latest())
    assert [node.visible for node in (drawn.arrow, drawn.ellipsoid, drawn.label)] == [True] * 3
    assert drawn.label.text == "Estimated hand force: 30 N"
    loop.user = None
    assert still.scene.show(loop.latest())
    assert [node.visible for node in (drawn.arrow, drawn.ellipsoid, drawn.label)] == [False] * 3


@pytest.mark.parametrize("turned", [False, True])
def test_both_have_one_scale_and_lie_as_the_base_is_turned(loop: FakeLoop, still: Served, turned: bool) -> None:
    loop.user = UncertainForce((0.0, 30.0, 0.0), VARIANCES, (0.0, 0.0, 0.2))
    snapshot, R_WB = loop.latest(), QUARTER if turned else np.eye(3)
    if turned:
        snapshot.truth_links[0, 3:] = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
    still.scene.show(snapshot)
    drawn, face = still.scene.user, snapshot.truth_links[-1]
    point = face[:3] + matrix_from_quaternion(face[3:]) @ [0.0, 0.0, 0.2]
    tail, tip = np.asarray(drawn.arrow.points)[0]
    assert tail == pytest.approx(point, abs=1e-3)
    assert tip - tail == pytest.approx(R_WB @ [0.0, 30.0 * METRES_PER_NEWTON, 0.0], abs=2e-3)
    assert drawn.ellipsoid.position == pytest.approx(tip, abs=1e-3)
    lowest = tip[2] - METRES_PER_NEWTON * np.sqrt(WITHIN_95 * VARIANCES[2, 2])
    assert drawn.label.position[2] == pytest.approx(min(tail[2], lowest) - BELOW, abs=2e-3), "it covers neither"
    R, axes = matrix_from_quaternion(drawn.ellipsoid.wxyz), np.array(drawn.ellipsoid.scale)
    squares = R @ np.diag(axes**2) @ R.T / (WITHIN_95 * METRES_PER_NEWTON**2)
    np.testing.assert_allclose(squares, R_WB @ VARIANCES @ R_WB.T, atol=0.5)


def test_a_force_too_small_for_an_arrow_has_its_ellipsoid_at_the_tool(loop: FakeLoop, still: Served) -> None:
    loop.user = UncertainForce((0.5 * LEAST_FORCE, 0.0, 0.0), np.zeros((3, 3)))
    still.scene.show(loop.latest())
    drawn = still.scene.user
    assert (drawn.arrow.visible, drawn.label.visible, drawn.ellipsoid.visible) == (False, False, True)
    assert np.array(drawn.ellipsoid.scale) == pytest.approx(THINNEST)


def test_a_force_that_the_joints_tell_is_an_arrow_alone(loop: FakeLoop, still: Served) -> None:
    loop.user = UncertainForce((0.0, 30.0, 0.0), None)
    still.scene.show(loop.latest())
    drawn = still.scene.user
    assert (drawn.arrow.visible, drawn.label.visible, drawn.ellipsoid.visible) == (True, True, False)
    still.docks.show(loop.latest())
    assert "30.0 N, by the joints alone" in still.docks.panel.numbers.shown


def test_the_figures_tell_both_and_what_they_mean(loop: FakeLoop, still: Served) -> None:
    panel = still.docks.panel
    still.docks.show(loop.latest())
    assert "Estimated hand force" not in panel.numbers.shown
    loop.user = UncertainForce((0.0, 3.0, 4.0), VARIANCES / WITHIN_95)
    still.docks.show(loop.latest())
    assert "5.0 N (± 1.0 to 3.0 N)" in panel.numbers.shown
    assert 'title="The force that free-drive takes for your hand' in panel.numbers.shown
