"""The walls tab and its handles: what goes to the desk, what is shown, who may move what."""

from collections.abc import Callable
from typing import Any

import pytest
from msgspec.structs import replace

from app.web.server import Served
from app.web.walls.made_walls import REACTIONS, REDUCES
from app.web.walls.wall_handles import NAME
from app.web.walls.walls_tab import NONE
from pendant.all_settings import apply
from pendant.events.event import Kind
from pendant.tick.modes import Mode, Phase
from pendant.tick.pose import Pose
from pendant.walls.barrier import placed
from pendant.walls.definitions import AnyBorder, Area, Wall
from pendant.walls.settings import Reaction
from pendant.walls.shapes import Box, HalfSpace, Sphere
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]
BALL = Area(name="ball", part="tcp", shape=Sphere(radius=0.2), position=(0.4, 0.0, 0.3))
FLOOR = Area(name="floor", shape=HalfSpace(normal=(0.0, 0.0, -1.0)), reaction=Reaction.STOP)
ROUND = Wall(name="round", shape=Box(size=(0.4, 0.4, 0.4)))


def have(loop: FakeLoop, *borders: AnyBorder) -> None:
    """The robot has these walls and areas."""
    areas = [border for border in borders if isinstance(border, Area)]
    loop.borders, loop.places = borders, tuple((area, placed(area, area.position, 1.0, Pose())) for area in areas)


def wished(loop: FakeLoop, true: Callable[[tuple[AnyBorder, ...]], bool], what: str) -> tuple[AnyBorder, ...]:
    """Wait for a list that goes to the desk, and have the robot take it."""

    def seen() -> bool:
        loop.advance()
        fenced = loop.wishes[-1].inputs.borders
        if fenced is None:
            return False
        have(loop, *fenced)
        return True

    until(seen, what)
    assert loop.borders is not None
    assert true(loop.borders), loop.borders
    return loop.borders


def test_what_is_added_is_chosen_has_handles_and_is_undone(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.walls
    until(lambda: tab.delete.disabled and not tab.delete.visible, "there is none")
    assert tab.choice.options == (NONE,)
    assert "stops programs and jogging at its border" in tab.list.shown
    client.set(tab.add._impl.uuid, value="Box")
    wished(loop, lambda walls: [wall.name for wall in walls] == ["box 1"], "the box")
    until(lambda: tab.choice.value == "box 1" and tab.handles._gizmo is not None, "chosen, with handles")
    assert [control.value for control in tab.size] == [400.0, 400.0, 400.0]
    assert "box 1" in tab.list.shown
    assert "No wall yet" not in tab.list.shown
    client.set(tab.undo._impl.uuid, value=True)
    wished(loop, lambda walls: walls == (), "undone")
    until(lambda: tab.handles._gizmo is None and tab.undo.disabled, "nothing is left")


CHANGES: list[tuple[str, Any, AnyBorder]] = [
    ("on", False, replace(BALL, on=False)),
    ("side", "Keep out", replace(BALL, keep_out=True)),
    ("part", "Elbow", replace(BALL, part="elbow")),
    ("reaction", list(REACTIONS)[1], replace(BALL, reaction=Reaction.STAY)),
    ("reaction", REDUCES, replace(BALL, triggers_reduced=True)),
    ("size", 150.0, replace(BALL, shape=Sphere(radius=0.15))),
    ("spot", -250.0, replace(BALL, position=(-0.25, 0.0, 0.3))),
]


@pytest.mark.parametrize(("name", "value", "wanted"), CHANGES, ids=[change[0] for change in CHANGES])
def test_each_value_goes_to_the_desk_with_the_whole_list(
    served: Served, join: Join, loop: FakeLoop, name: str, value: Any, wanted: AnyBorder
) -> None:
    have(loop, FLOOR, BALL)
    client, tab = join(), served.docks.walls
    until(lambda: tab.choice.value == "ball" and tab.size[0].visible, "it is chosen")
    control = getattr(tab, name)
    control = control[0] if isinstance(control, list) else control
    client.set(control._impl.uuid, value=value)
    wished(loop, lambda walls: walls == (FLOOR, wanted), name)


def test_a_wall_round_a_part_is_switched_and_deleted_and_has_no_place(served: Served, join: Join, loop: FakeLoop) -> None:
    have(loop, ROUND)
    client, tab = join(), served.docks.walls
    until(lambda: tab.choice.value == "round" and tab.on.visible, "it is chosen")
    assert not any(control.visible for control in (tab.side, tab.here, tab.shown, *tab.size, *tab.spot))
    client.set(tab.on._impl.uuid, value=False)
    wished(loop, lambda walls: walls == (replace(ROUND, on=False),), "off")
    client.set(tab.delete._impl.uuid, value=True)
    wished(loop, lambda walls: walls == (), "deleted")


def test_nothing_changes_while_the_arm_is_free_or_a_program_runs(served: Served, join: Join, loop: FakeLoop) -> None:
    have(loop, BALL)
    client, tab = join(), served.docks.walls
    until(lambda: tab.shown.visible and not tab.on.disabled, "it is chosen")
    client.set(tab.shown._impl.uuid, value=True)
    until(lambda: tab.handles._gizmo is not None, "handles")
    for mode, phase in ((Mode.FREE_DRIVE, Phase.GUIDED), (Mode.RUN, Phase.OFF), (Mode.TEACH, Phase.ACTIVATION)):
        loop.mode, loop.phase = mode, phase
        until(lambda: tab.on.disabled and tab.delete.disabled, f"locked in {mode}")
        until(lambda: tab.handles._gizmo is None, "no handles")
        loop.mode, loop.phase = Mode.TEACH, Phase.OFF
        until(lambda: not tab.on.disabled and tab.handles._gizmo is not None, "free again")


def test_a_refusal_says_why_and_the_page_shows_what_holds(served: Served, join: Join, loop: FakeLoop) -> None:
    have(loop, BALL)
    client, tab = join(), served.docks.walls
    until(lambda: tab.on.visible and not tab.on.disabled, "it is chosen")
    client.set(tab.delete._impl.uuid, value=True)
    until(lambda: tab.borders == () and len(tab._before) == 1, "asked for")
    loop.note(Kind.WALLS_REFUSED, reason="no change of a wall in FREE_DRIVE")
    until(lambda: "no change of a wall in FREE_DRIVE" in tab.message.shown, "why")
    until(lambda: tab.choice.value == "ball" and tab._before == [], "it is there, and there is nothing to undo")
    loop.note(Kind.WALLS_CHANGED, change="x", count=1)
    until(lambda: tab.message.shown == "", "it is over")


def pose(client: RawClient, position: tuple[float, float, float], **changes: Any) -> None:
    message: dict[str, Any] = {"type": "TransformControlsUpdateMessage", "name": NAME, "wxyz": (2.0, 0.0, 0.0, 0.0)}
    client.send(**message | {"position": position, "owner": ""} | changes)


def take(client: RawClient, **changes: Any) -> None:
    client.send(**{"type": "TransformControlsDragStartMessage", "name": NAME, "owner": ""} | changes)


def let_go(client: RawClient) -> None:
    client.send(type="TransformControlsDragEndMessage", name=NAME, owner="")


def with_handles(served: Served, join: Join, loop: FakeLoop) -> RawClient:
    have(loop, BALL)
    client, tab = join(), served.docks.walls
    until(lambda: tab.shown.visible and not tab.shown.disabled, "it is chosen")
    client.set(tab.shown._impl.uuid, value=True)
    until(lambda: tab.handles._gizmo is not None, "handles")
    return client


def test_handles_move_it_when_they_are_let_go(served: Served, join: Join, loop: FakeLoop) -> None:
    client = with_handles(served, join, loop)
    take(client)
    pose(client, (0.5, 0.1, 0.2))
    until(lambda: served.docks.walls.handles.mover == 0, "somebody moves it")
    loop.advance()
    assert loop.wishes[-1].inputs.borders is None
    let_go(client)
    wished(loop, lambda walls: walls == (replace(BALL, position=(0.5, 0.1, 0.2)),), "moved")


def test_who_only_watches_moves_nothing_and_ends_nobody_s_move(served: Served, join: Join, loop: FakeLoop) -> None:
    client = with_handles(served, join, loop)
    other = join()
    take(client)
    pose(client, (0.5, 0.1, 0.2))
    take(other)
    pose(other, (0.0, 0.0, 0.9))
    let_go(other)
    until(lambda: served.guard.refused["not the operator"] == 2, "refused")
    gizmo = served.docks.walls.handles._gizmo
    assert gizmo is not None
    until(lambda: tuple(gizmo.position) == (0.5, 0.1, 0.2), "only the first moved it")
    assert served.docks.walls.handles.mover == 0
    told = other.messages_until(lambda message: message["type"] == "SetPositionMessage" and message.get("name") == NAME)
    assert told


def test_a_mover_that_leaves_has_moved_nothing(served: Served, join: Join, loop: FakeLoop) -> None:
    client = with_handles(served, join, loop)
    take(client)
    pose(client, (0.5, 0.1, 0.2))
    handles = served.docks.walls.handles
    until(lambda: handles._gizmo is not None and tuple(handles._gizmo.position) == (0.5, 0.1, 0.2), "moved so far")
    client.close()
    until(lambda: handles._gizmo is not None and tuple(handles._gizmo.position) == BALL.position, "back")
    loop.advance()
    assert loop.wishes[-1].inputs.borders is None


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"name": "/arm/wrist_3"}, "not movable"),
        ({"owner": "1"}, "not movable"),
        ({"position": (1e9, 0.0, 0.0)}, "number out of bounds"),
        ({"wxyz": (float("nan"), 0.0, 0.0, 0.0)}, "number out of bounds"),
    ],
)
def test_a_bad_move_is_refused(served: Served, join: Join, loop: FakeLoop, changes: dict[str, Any], reason: str) -> None:
    client = with_handles(served, join, loop)
    pose(client, **{"position": (0.1, 0.1, 0.1)} | changes)
    until(lambda: served.guard.refused[reason] == 1, reason)


def test_handles_that_are_put_away_move_nothing(served: Served, join: Join, loop: FakeLoop) -> None:
    client = with_handles(served, join, loop)
    loop.mode = Mode.FREE_DRIVE
    until(lambda: served.docks.walls.handles._gizmo is None, "put away")
    take(client)
    until(lambda: served.guard.refused["not movable"] == 1, "refused")


def test_a_wall_gets_another_name_once_it_is_typed(served: Served, join: Join, loop: FakeLoop) -> None:
    have(loop, BALL, FLOOR)
    client, tab = join(), served.docks.walls
    until(lambda: tab.name.visible and tab.choice.value in ("ball", "floor"), "one is chosen")
    client.set(tab.choice._impl.uuid, value="ball")
    until(lambda: tab.name.value == "ball", "its name")
    for text in ("r", "round", " round the part "):
        client.set(tab.name._impl.uuid, value=text)
    wished(loop, lambda walls: walls == (replace(BALL, name="round the part"), FLOOR), "renamed once")
    until(lambda: tab.choice.value == "round the part", "and chosen")
    client.set(tab.name._impl.uuid, value="floor")
    until(lambda: "name of its own" in tab.message.shown, "another one has it")
    until(lambda: tab.name.value == "round the part", "as it was")
    assert loop.borders == (replace(BALL, name="round the part"), FLOOR)


def test_who_types_slowly_is_not_interrupted(served: Served, join: Join, loop: FakeLoop) -> None:
    """An emptied field is no name yet, and a blank before the next word stays."""
    have(loop, BALL)
    client, tab = join(), served.docks.walls
    until(lambda: tab.name.value == "ball", "its name")
    client.set(tab.name._impl.uuid, value="")
    until(lambda: tab._typed._waiting is not None, "it is emptied")
    until(lambda: tab._typed._waiting is None, "for a while")
    assert (tab.name.value, tab.message.shown) == ("", "")
    client.set(tab.name._impl.uuid, value="round ")
    wished(loop, lambda walls: walls == (replace(BALL, name="round"),), "renamed")
    until(lambda: tab.choice.value == "round", "and chosen")
    assert tab.name.value == "round "


def test_walls_that_are_switched_off_at_all_are_told(served: Served, loop: FakeLoop) -> None:
    have(loop, BALL)
    tab = served.docks.walls
    until(lambda: "stay inside" in tab.list.shown, "it holds")
    loop.settings = apply(loop.settings, {"walls.on": False})
    until(lambda: "All walls are off" in tab.list.shown and "stay inside" not in tab.list.shown, "it does not")


def test_a_wall_is_fixed_to_the_flange_and_not_to_what_it_watches(served: Served, join: Join, loop: FakeLoop) -> None:
    have(loop, BALL)
    client, tab = join(), served.docks.walls
    until(lambda: tab.fixed.visible and tab.fixed.value == "Base", "it lies in the base")
    assert "with" not in tab.list.shown
    client.set(tab.fixed._impl.uuid, value="Tool")
    until(lambda: "cannot move with that" in tab.message.shown and tab.fixed.value == "Base", "it watches the tool")
    client.set(tab.fixed._impl.uuid, value="Flange")
    wished(loop, lambda walls: walls[0].reference == "flange", "fixed to the flange")
    until(lambda: "with flange" in tab.list.shown, "listed")
