"""Jogging and the speed override on the page."""

import asyncio
import math
from collections.abc import Callable

import pytest

from app.web.server import Served
from app.web.tabs.jog_tab import HOLD_ON, HOME, LIFT_FIRST, NOT_NOW, STILL, STRAIGHT, THERE, JogTab, Which
from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.program.jog_move import JogMove, MoveStraight, MoveThere
from pendant.tick.modes import TICK_RATE, Mode
from tests.app.web.fake_loop import ARM, FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


class Hand:
    """Presses of client 3, straight into the tab's own callbacks."""

    client_id = 3
    client = None

    def __init__(self, tab: JogTab, loop: FakeLoop) -> None:
        self.tab, self.loop = tab, loop

    def word(self, axis: int, sign: int) -> None:
        """What a held button says again and again."""
        asyncio.run(self.tab._held((axis, sign))(self))  # type: ignore[arg-type]

    def hold(self, axis: int, sign: int) -> None:
        """Keep still on a button until that is meant."""
        self.word(axis, sign)
        self.loop.tick += round(STILL * TICK_RATE)
        self.word(axis, sign)

    def press(self, which: Which) -> None:
        """Keep still on the button of a posture until that is meant."""
        asyncio.run(self.tab._held(which)(self))  # type: ignore[arg-type]
        self.loop.tick += round(STILL * TICK_RATE)
        asyncio.run(self.tab._held(which)(self))  # type: ignore[arg-type]

    def lift(self) -> None:
        asyncio.run(self.tab._lifted(self))  # type: ignore[arg-type]


@pytest.fixture
def hand(served: Served, loop: FakeLoop) -> Hand:
    return Hand(served.docks.jog, loop)


def test_a_held_button_jogs_and_letting_go_stops(hand: Hand, loop: FakeLoop) -> None:
    hand.hold(2, -1)
    assert loop.desk.take().inputs.jog == JogMove(frame="joint", axis=2, sign=-1)
    hand.lift()
    inputs = loop.desk.take().inputs
    assert inputs.jog is None
    assert inputs.jog_released


def test_a_finger_that_only_begins_on_a_button_moves_nothing(served: Served, join: Join, hand: Hand, loop: FakeLoop) -> None:
    join()
    hand.word(2, -1)
    loop.tick += round(0.9 * STILL * TICK_RATE)
    hand.word(2, -1)
    assert loop.desk.take().inputs.jog is None
    hand.lift()
    until(lambda: HOLD_ON in hand.tab.said.shown, "told")


def test_the_tab_tells_what_became_of_the_last_press(served: Served, join: Join, hand: Hand, loop: FakeLoop) -> None:
    client = join()
    until(lambda: "Hold a button: the arm moves until you let go." in hand.tab.said.shown, "how")
    loop.note(Kind.JOG_ENDED, what="tool z +", moved="12 of 50 mm", reason="let go")
    until(lambda: "Jogging tool z + ended after 12 of 50 mm. Let go." in hand.tab.said.shown, "how it ended")
    for what, told in (("to home", "At home."), ("straight to the pose", "At the pose."), ("tool z +", "Done: 50 of 50 mm.")):
        loop.note(Kind.JOG_ENDED, what=what, moved="50 of 50 mm", reason="done")
        until(lambda told=told: told in hand.tab.said.shown, "it is there")
    loop.note(Kind.JOG_ENDED, what="tool z +", moved="12 of 50 mm", reason="no word from the button")
    until(lambda: "Lost contact with the page." in hand.tab.said.shown, "why")
    client.set(hand.tab.steps._impl.uuid, value="50 mm, 50°")
    until(lambda: "the arm stops after 50 mm or 50°" in hand.tab.said.shown, "how far")
    loop.mode = Mode.STOP
    until(lambda: NOT_NOW in hand.tab.said.shown, "why not")


def test_a_press_that_fell_silent_needs_the_pointer_up_first(hand: Hand, loop: FakeLoop) -> None:
    hand.hold(0, 1)
    loop.tick += 500
    hand.word(0, 1)
    assert loop.desk.take().inputs.jog is None
    hand.hold(0, 1)
    assert loop.desk.take().inputs.jog is None
    hand.tab.show(loop.latest(), [])
    assert LIFT_FIRST in hand.tab.said.shown
    hand.lift()
    hand.tab.show(loop.latest(), [])
    assert LIFT_FIRST not in hand.tab.said.shown
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
    client, slider = join(), served.panel.bar.speed
    client.set(slider._impl.uuid, value=40)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"program.speed": 0.4}, "the wish")
    loop.settings = apply(Settings(), {"program.speed": 0.7})
    until(lambda: slider.value == 70, "what holds")


def test_home_and_the_sliders_are_moved_to_while_their_button_is_held(
    served: Served, join: Join, hand: Hand, loop: FakeLoop
) -> None:
    client, tab = join(), hand.tab
    hand.press(HOME)
    assert loop.desk.take().inputs.jog == MoveThere(q=tuple(ARM.chain.home), name="home")
    hand.lift()
    assert loop.desk.take().inputs.jog_released
    client.set(tab.sliders[2]._impl.uuid, value=12.5)
    until(lambda: tab.sliders[2].value == 12.5, "moved")
    until(lambda: tab.ghost.posture is not None and tab.ghost.posture[2] == math.radians(12.5), "seen in the picture")
    hand.press(THERE)
    asked = loop.desk.take().inputs.jog
    assert isinstance(asked, MoveThere)
    assert asked.q[2] == math.radians(12.5)
    hand.lift()
    loop.q[2] = math.radians(30.0)
    client.set(tab.here._impl.uuid, value=True)
    until(lambda: tab.sliders[2].value == 30.0, "as the arm is now")


def test_nobody_slides_a_joint_beyond_its_range_by_a_message(served: Served, join: Join, hand: Hand) -> None:
    client, slider = join(), hand.tab.sliders[2]
    before = slider.value
    client.set(slider._impl.uuid, value=slider.max + 1.0)
    until(lambda: served.guard.refused["value not allowed"] == 1, "refused")
    assert slider.value == before


def test_a_typed_pose_is_moved_to_straight_while_its_button_is_held(
    served: Served, join: Join, hand: Hand, loop: FakeLoop
) -> None:
    client, tab = join(), hand.tab
    client.set(tab.at._impl.uuid, value=(400.0, -100.0, 300.0))
    client.set(tab.turned._impl.uuid, value=(180.0, 0.0, 0.0))
    until(lambda: tab.at.value == (400.0, -100.0, 300.0) and tab.turned.value == (180.0, 0.0, 0.0), "typed")
    hand.press(STRAIGHT)
    asked = loop.desk.take().inputs.jog
    assert isinstance(asked, MoveStraight)
    assert asked.position == (0.4, -0.1, 0.3)
    assert [round(abs(part), 9) for part in asked.quaternion] == [0.0, 1.0, 0.0, 0.0]
    hand.lift()
    assert loop.desk.take().inputs.jog_released
    client.set(tab.now._impl.uuid, value=True)
    until(lambda: tab.at.value == (0.0, 0.0, 0.0) and tab.turned.value == (0.0, 0.0, 0.0), "as the tool is now")
