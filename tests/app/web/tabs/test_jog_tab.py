"""Jogging and the speed override on the page."""

import asyncio
import math
from collections.abc import Callable

import pytest

from app.web.server import Served
from app.web.tabs.jog_tab import JogTab
from pendant.all_settings import Settings, apply
from pendant.program.jog_move import JogMove
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


class Hand:
    """Presses of client 3, straight into the tab's own callbacks."""

    client_id = 3
    client = None

    def __init__(self, tab: JogTab) -> None:
        self.tab = tab

    def hold(self, axis: int, sign: int) -> None:
        asyncio.run(self.tab._held((axis, sign))(self))  # type: ignore[arg-type]

    def lift(self) -> None:
        asyncio.run(self.tab._lifted(self))  # type: ignore[arg-type]


@pytest.fixture
def hand(served: Served) -> Hand:
    return Hand(served.docks.jog)


def test_a_held_button_jogs_and_letting_go_stops(hand: Hand, loop: FakeLoop) -> None:
    hand.hold(2, -1)
    assert loop.desk.take().inputs.jog == JogMove(frame="joint", axis=2, sign=-1)
    hand.lift()
    inputs = loop.desk.take().inputs
    assert inputs.jog is None
    assert inputs.jog_released


def test_a_press_that_fell_silent_needs_the_pointer_up_first(hand: Hand, loop: FakeLoop) -> None:
    hand.hold(0, 1)
    loop.tick += 500
    hand.hold(0, 1)
    assert loop.desk.take().inputs.jog is None
    hand.hold(0, 1)
    assert loop.desk.take().inputs.jog is None
    hand.lift()
    hand.hold(0, 1)
    assert loop.desk.take().inputs.jog is not None


def test_who_loses_control_jogs_no_more(hand: Hand, loop: FakeLoop) -> None:
    hand.hold(0, 1)
    hand.tab.let_go(3)
    assert loop.desk.take().inputs.jog_released
    hand.hold(0, 1)
    assert loop.desk.take().inputs.jog is None


def test_a_step_has_its_length_in_metres_or_radians(served: Served, join: Join, hand: Hand, loop: FakeLoop) -> None:
    client, tab = join(), hand.tab
    client.set(tab.steps._impl.uuid, value="50 mm, 50°")
    client.set(tab.frame._impl.uuid, value="Axes of the tool")
    until(lambda: tab.chosen == "tool" and tab.steps.value == "50 mm, 50°", "chosen")
    hand.hold(2, 1)
    assert loop.desk.take().inputs.jog == JogMove(frame="tool", axis=2, sign=1, length=0.05)
    hand.hold(3, 1)
    assert loop.desk.take().inputs.jog == JogMove(frame="tool", axis=3, sign=1, length=math.radians(50.0))


def test_only_at_rest_in_teach_and_normal_the_buttons_can_be_used(served: Served, join: Join, loop: FakeLoop) -> None:
    join()
    button = served.docks.jog.buttons[0, 1]
    until(lambda: not button.disabled, "in TEACH")
    loop.mode = Mode.STOP
    until(lambda: button.disabled, "in STOP")


def test_the_speed_override_goes_to_the_desk_and_shows_what_holds(served: Served, join: Join, loop: FakeLoop) -> None:
    client, slider = join(), served.panel.speed
    client.set(slider._impl.uuid, value=40)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"program.speed": 0.4}, "the wish")
    loop.settings = apply(Settings(), {"program.speed": 0.7})
    until(lambda: slider.value == 70, "what holds")
