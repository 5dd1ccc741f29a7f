"""What the picture shows of a snapshot, and that it says nothing twice."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from app.web.scene.arm_picture import frames_of
from app.web.scene.touch_arrow import LONGEST, SHORTEST
from app.web.server import Served, serve
from pendant.equipment.load import Load
from pendant.equipment.tools import BARE
from pendant.tooling.tool_in_use import Fitting
from sim.arm.scenario import BoxObject, Pad, Plane, Scenario, ToolModel
from sim.exchange.snapshot import Snapshot
from tests.app.web.fake_loop import ARM, FakeLoop, links

WORLD = Scenario(
    tool=ToolModel(name="rod", mass=0.5, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, 0.2], length=0.2),
    world=[
        Plane(name="floor", position=[0.0, 0.0, 0.0]),
        BoxObject(name="table", position=[0.5, 0.0, 0.2], size=[0.4, 0.6, 0.4]),
        Pad(name="pad", position=[0.5, 0.0, 0.42], size=[0.2, 0.2, 0.04]),
    ],
)


@pytest.fixture
def still(loop: FakeLoop) -> Iterator[Served]:
    """A web app with a world, whose painter does not run."""
    loop.latest = lambda: snapshot(loop)  # type: ignore[method-assign]
    loop.scenario = WORLD
    app = serve(loop, ARM, WORLD)
    app.stop_drawing()
    yield app
    app.close()


def snapshot(loop: FakeLoop, **changes: object) -> Snapshot:
    objects = np.array([[*thing.position, 1.0, 0.0, 0.0, 0.0] for thing in WORLD.world])
    return replace(FakeLoop.latest(loop), truth_objects=objects, **changes)


def test_every_part_stands_where_it_truly_is(loop: FakeLoop, still: Served) -> None:
    loop.q = loop.q + 0.3
    assert still.scene.show(snapshot(loop))
    poses = links(loop.q)
    for part, handle in still.scene.draggable.items():
        assert handle.position == pytest.approx(poses[frames_of(ARM)[part]][:3], abs=1e-5)
        assert handle.wxyz == pytest.approx(poses[frames_of(ARM)[part]][3:], abs=1e-5)
    assert set(still.scene.draggable) == {"foot", *ARM.chain.joints, "tool"}


def test_nothing_is_sent_while_nothing_moves(loop: FakeLoop, still: Served) -> None:
    still.scene.show(snapshot(loop))
    assert not still.scene.show(snapshot(loop))
    loop.q = loop.q + 1e-6
    assert not still.scene.show(snapshot(loop))
    loop.q = loop.q + 1e-3
    assert still.scene.show(snapshot(loop))


def test_the_world_stands_where_it_is_and_moves(loop: FakeLoop, still: Served) -> None:
    moved = snapshot(loop)
    moved.truth_objects[1, :3] = (0.7, 0.1, 0.3)
    still.scene.show(moved)
    assert still.scene._nodes["object 1 table"].position == pytest.approx((0.7, 0.1, 0.3))
    assert still.scene._nodes["object 2 pad"].position == pytest.approx((0.5, 0.0, 0.42))


@pytest.mark.parametrize(
    ("force", "text", "length"),
    [((30.0, 40.0, 0.0), "50 N", 0.2), ((0.0, 0.0, -1.0), "1 N", SHORTEST), ((150.0, 0.0, 0.0), "150 N", LONGEST)],
)
def test_an_arrow_shows_a_touch_with_its_size(
    loop: FakeLoop, still: Served, force: tuple[float, ...], text: str, length: float
) -> None:
    still.scene.show(snapshot(loop, touches=(("wrist_3", (0.1, 0.2, 0.3), force, (0.0, 0.0, 0.0)),)))
    arrow, label = still.scene.arrows[0].arrow, still.scene.arrows[0].label
    tail, tip = np.asarray(arrow.points)[0]
    along = np.array(force)
    assert arrow.visible
    assert label.visible
    assert label.text == text
    assert tail == pytest.approx((0.1, 0.2, 0.3))
    assert tip - tail == pytest.approx(along / np.linalg.norm(along) * length, abs=1e-6)
    still.scene.show(snapshot(loop))
    assert not arrow.visible
    assert not label.visible


def test_a_torque_goes_round_its_axis_by_the_right_hand(loop: FakeLoop, still: Served) -> None:
    touch = ("wrist_3", (0.1, 0.2, 0.3), (0.0, 0.0, 0.0), (0.0, 3.0, 4.0))
    still.scene.show(snapshot(loop, touches=(touch,)))
    shown = still.scene.arrows[0]
    assert (shown.label.text, shown.arrow.visible, shown.arc.visible) == ("5.0 N·m", True, True)
    axis, centre = np.array([0.0, 0.6, 0.8]), np.array([0.1, 0.2, 0.3])
    pieces = np.concatenate([np.asarray(shown.arc.points), np.asarray(shown.arrow.points)])
    from_axis = pieces.reshape(-1, 3) - centre
    np.testing.assert_allclose(from_axis @ axis, 0.0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(from_axis, axis=1), 0.1, atol=1e-6)
    ways = pieces[:, 1] - pieces[:, 0]
    assert np.all(np.cross(pieces[:, 0] - centre, ways) @ axis > 0.0)
    still.scene.show(snapshot(loop, touches=(("wrist_3", (0.1, 0.2, 0.3), (10.0, 0.0, 0.0), (0.0, 0.0, 0.0)),)))
    assert (shown.arrow.visible, shown.arc.visible) == (True, False)


def test_a_payload_is_a_ball_of_its_weight_and_falls(loop: FakeLoop, still: Served) -> None:
    pose = np.array([0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0])
    still.scene.show(snapshot(loop, truth_payload=pose, truth_payload_mass=2.0))
    ball = still.scene._payload
    assert ball.visible
    assert ball.position == pytest.approx(pose[:3])
    assert 4.0 / 3.0 * np.pi * float(np.mean(ball.scale)) ** 3 * 1000.0 == pytest.approx(2.0, rel=0.01)
    pose = pose - np.array([0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.0])
    still.scene.show(snapshot(loop, truth_payload=pose, truth_payload_mass=0.0))
    assert ball.position == pytest.approx(pose[:3])
    assert 4.0 / 3.0 * np.pi * float(np.mean(ball.scale)) ** 3 * 1000.0 == pytest.approx(2.0, rel=0.01)
    still.scene.show(snapshot(loop))
    assert not ball.visible


def test_another_scenario_brings_its_own_tool_and_world(loop: FakeLoop, still: Served) -> None:
    still.scene.show(snapshot(loop))
    bare = replace(FakeLoop.latest(loop), scenario=Scenario())
    assert still.scene.show(bare)
    assert "tool" not in still.scene.draggable
    assert not [key for key in still.scene._nodes if key.startswith("object")]
    told: list[object] = []
    still.scene.on_tool = told.append
    still.scene.show(snapshot(loop))
    assert told == [still.scene.draggable["tool"]]
    assert [key for key in still.scene._nodes if key.startswith("object")] == ["object 1 table", "object 2 pad"]


def test_the_floor_lies_as_low_as_the_world_says(loop: FakeLoop, still: Served) -> None:
    deep = Scenario(world=[Plane(name="floor", position=[0.0, 0.0, -0.8])])
    still.scene.show(replace(FakeLoop.latest(loop), scenario=deep, truth_objects=np.zeros((1, 7))))
    assert still.scene._floor.position == pytest.approx((0.0, 0.0, -0.8))
    still.scene.show(replace(FakeLoop.latest(loop), scenario=Scenario()))
    assert still.scene._floor.position == pytest.approx((0.0, 0.0, 0.0))


def test_the_payload_that_the_controller_believes_in_stands_beside_the_true_one(loop: FakeLoop, still: Served) -> None:
    pose = np.array([0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0])
    fitting = Fitting(1, BARE, Load(mass=1.0, com=[0.0, 0.0, 0.1]), 1.0, 1.0)
    loop.fitting, loop.configured = fitting, 1.0
    still.scene.show(snapshot(loop, truth_payload=pose, truth_payload_mass=2.0))
    ghost = still.scene._believed
    assert ghost.visible
    assert still.scene._believed_label.text == "Configured: 1.0 kg"
    away = np.linalg.norm(np.asarray(ghost.position) - loop.latest().truth_links[-1][:3])
    assert away == pytest.approx(0.1, abs=1e-3)
    still.scene.show(snapshot(loop, truth_payload=pose, truth_payload_mass=1.0))
    assert not ghost.visible
