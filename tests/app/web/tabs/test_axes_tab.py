"""Axis locks and singularities on the page."""

from collections.abc import Callable

import pytest

from app.web.server import Served
from app.web.tabs.axes_tab import TOLD
from pendant.all_settings import Settings, apply
from pendant.limits.axis_locks import PRESETS, axis_locks, freeing, freeing_joints
from pendant.limits.nearness import Nearness
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]
PLANE = apply(Settings(), freeing(PRESETS["plane"]))


@pytest.mark.parametrize("name", list(PRESETS))
def test_a_preset_goes_to_the_desk(served: Served, join: Join, loop: FakeLoop, name: str) -> None:
    client, tab = join(), served.docks.axes
    client.set(tab.preset._impl.uuid, value=name.capitalize())
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == freeing(PRESETS[name]), "the wish")


def test_an_axis_and_the_frame_go_to_the_desk(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.axes
    client.set(tab.free["rz"]._impl.uuid, value=False)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"axes.rz": False}, "the axis")
    client.set(tab.tool._impl.uuid, value=True)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"axes.frame": "tool"}, "the frame")


def test_it_shows_what_holds(served: Served, join: Join, loop: FakeLoop) -> None:
    join()
    tab = served.docks.axes
    until(lambda: "none" in tab.now.shown, "all free")
    loop.settings = PLANE
    until(lambda: "z, rx, ry" in tab.now.shown and "hold in free-drive" in tab.now.shown, "what is locked")
    assert [axis for axis, control in tab.free.items() if control.value] == ["x", "y", "rz"]
    loop.locks, loop.mode = axis_locks(PLANE.axes), Mode.FREE_DRIVE
    until(lambda: "hold in free-drive" not in tab.now.shown, "they hold")
    for changes, text in (
        ({"axes.yaw": 0.3}, "base, turned"),
        ({"axes.frame": "tool"}, "tool, as it stands when locked"),
        ({"axes.on": False}, "off"),
    ):
        loop.settings = apply(PLANE, changes)
        until(lambda text=text: text in tab.now.shown, text)


def test_joints_go_to_the_desk_one_by_one_and_all_at_once(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.axes
    assert [control.label for control in tab.joints.values()][:3] == ["Base", "Shoulder", "Elbow"]
    client.set(tab.joints["j3"]._impl.uuid, value=False)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"joints.j3": False}, "the elbow")
    client.set(tab.all._impl.uuid, value="All locked")
    none = freeing_joints(frozenset(), 6)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == none, "all of them")
    client.set(tab.all._impl.uuid, value="All free")
    every = dict.fromkeys(none, True)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == every, "and free")


@pytest.mark.parametrize(("free", "told"), [({2}, "5 of 6"), ({0, 1, 2, 3}, "Wrist 2, Wrist 3"), (set(), "all")])
def test_it_shows_which_joints_are_locked(served: Served, join: Join, loop: FakeLoop, free: set[int], told: str) -> None:
    join()
    tab = served.docks.axes
    loop.settings = apply(Settings(), freeing_joints(frozenset(free), 6))
    until(lambda: told in tab.now.shown and "hold in free-drive" in tab.now.shown, "what is locked")
    assert [place for place, control in enumerate(tab.joints.values()) if control.value] == sorted(free)
    loop.settings = apply(loop.settings, {"joints.on": False})
    until(lambda: "switched off" in tab.now.shown, "off")


def test_it_tells_singularities_in_free_drive(served: Served, join: Join, loop: FakeLoop) -> None:
    join()
    tab = served.docks.axes
    until(lambda: "Shown during free-drive" in tab.singularity.shown, "not yet")
    for nearness in Nearness:
        loop.singularity = nearness
        until(lambda headline=TOLD[nearness][0]: headline in tab.singularity.shown, nearness)
