"""Who has control: taken, shown to everybody, given back, left behind."""

from collections.abc import Callable

import pytest

from app.web.access.control import Strip
from app.web.access.guard import Guard
from app.web.access.operator import SILENCE
from app.web.server import Served
from pendant.inputs import Button
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


class Clock:
    """The guard's clock, set by hand."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(served: Served, monkeypatch: pytest.MonkeyPatch) -> Clock:
    """The clock of the served app."""
    clock = Clock()
    monkeypatch.setattr(served.guard, "_clock", clock)
    return clock


@pytest.fixture
def two(served: Served, join: Join, clock: Clock) -> tuple[RawClient, RawClient, dict[int, Strip]]:
    """An operator who has just taken control, a watcher, and what both see."""
    first, second = join(), join()
    strips = served.control._strips
    until(lambda: len(strips) == 2, "both have a strip")
    assert "Nobody has control" in strips[0].text.shown
    press(first, strips[0].take)
    until(lambda: shown(strips, "You have control", "Window 1 has control"), "client 1 has it")
    until(lambda: not strips[1].take.visible, "nobody can take it")
    return first, second, strips


def join_again(served: Served) -> RawClient:
    """One more client, after one has gone."""
    until(lambda: len(served.control._strips) == 1, "one has gone")
    client = RawClient(served.url)
    until(lambda: len(served.control._strips) == 2, "another is there")
    return client


def press(client: RawClient, button: object) -> None:
    client.set(button._impl.uuid, value=True)  # type: ignore[attr-defined]


def shown(strips: dict[int, Strip], *texts: str) -> bool:
    return all(text in strip.text.shown for strip, text in zip(strips.values(), texts, strict=True))


def buttons(strip: Strip) -> tuple[bool, bool]:
    """Whether the one to take and the one to release are there."""
    return strip.take.visible, strip.release.visible


Two = tuple[RawClient, RawClient, dict[int, Strip]]


def test_control_is_taken_shown_and_given_back(served: Served, two: Two, loop: FakeLoop) -> None:
    first, second, strips = two
    assert (buttons(strips[0]), buttons(strips[1])) == ((False, True), (False, False))
    assert strips[1].ask.visible
    first.drag("start")
    until(lambda: bool(loop.desk.take().touches), "a touch")
    press(first, strips[0].release)
    until(lambda: served.guard.operator.holder is None, "given back")
    assert loop.desk.take().touches == ()
    until(lambda: strips[1].take.visible and not strips[1].take.disabled, "it can be taken")
    press(second, strips[1].take)
    until(lambda: shown(strips, "Window 2 has control", "You have control"), "client 2 has it")


def test_after_ten_silent_seconds_and_not_before_somebody_else_takes_over(
    served: Served, two: Two, clock: Clock, loop: FakeLoop
) -> None:
    first, second, strips = two
    clock.now += SILENCE - 0.01
    press(second, strips[1].take)
    second.set(served.lab.force._impl.uuid, value=90.0)
    until(lambda: served.guard.refused.total() == 2, "refused")
    assert served.guard.operator.holder == 0
    clock.now += 0.02
    until(lambda: strips[1].take.visible and not strips[1].take.disabled, "it can be taken")
    press(second, strips[1].take)
    until(lambda: shown(strips, "Window 2 took control", "You have control"), "client 2 has it")
    first.drag("start")
    first.hold(served.panel.free_drive._impl.uuid)
    until(lambda: served.guard.refused["not the operator"] >= 2, "the former operator is refused")
    loop.advance()
    assert (loop.wishes[-1].touches, loop.wishes[-1].inputs.held) == ((), frozenset())


def test_a_watcher_is_told_when_it_may_act_and_who_lost_control_that_it_has(served: Served, two: Two, clock: Clock) -> None:
    _, second, strips = two
    until(lambda: shown(strips, "You have control", "Free in 10 s"), "the time until it is free")
    assert "data-pd-watching" in strips[1].text.shown
    assert "data-pd-watching" not in strips[0].text.shown
    clock.now += SILENCE
    until(lambda: shown(strips, "Idle: others may take it.", "Press anything to take over."), "the warning")
    press(second, strips[1].take)
    until(lambda: shown(strips, "Window 2 took control", "You have control"), "the former operator is told")


def test_who_is_left_is_told_that_the_connection_of_who_had_control_closed(served: Served, two: Two) -> None:
    first, second, strips = two
    first.close()
    until(lambda: shown(strips, "The connection closed. Any press takes it."), "free")
    press(second, strips[1].take)
    until(lambda: shown(strips, "You have control"), "taken")
    press(second, strips[1].release)
    until(lambda: "Nobody has control" in strips[1].text.shown and "closed" not in strips[1].text.shown, "given back")


def test_whoever_acts_first_after_the_silence_takes_over_by_that(served: Served, two: Two, clock: Clock) -> None:
    _, second, strips = two
    clock.now += SILENCE
    second.set(served.lab.force._impl.uuid, value=90.0)
    until(lambda: served.hand.cap == 90.0, "it counts")
    until(lambda: shown(strips, "Window 2 took control", "You have control"), "client 2 has it")


def test_who_holds_the_arm_is_not_silent(served: Served, two: Two, clock: Clock, loop: FakeLoop) -> None:
    first, second, strips = two
    first.drag("start")
    until(lambda: bool(loop.desk.take().touches), "a touch")
    clock.now += 100.0 * SILENCE
    press(second, strips[1].take)
    until(lambda: served.guard.refused.total() == 1, "refused")
    assert bool(loop.desk.take().touches)
    first.drag("end")
    until(lambda: loop.desk.take().touches == (), "let go")
    clock.now += SILENCE
    until(lambda: strips[1].take.visible and not strips[1].take.disabled, "it can be taken")
    press(second, strips[1].take)
    until(lambda: served.guard.operator.holder == 1, "client 2 has it")


def test_who_leaves_leaves_nothing_held_and_control_to_others(served: Served, two: Two, loop: FakeLoop) -> None:
    first, second, strips = two
    first.drag("start")
    first.hold(served.panel.free_drive._impl.uuid)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].touches), "a touch")
    first.close()
    until(lambda: loop.advance() is None and Button.FREE_DRIVE in loop.wishes[-1].inputs.released, "released")
    assert loop.desk.take().touches == ()
    until(lambda: shown(strips, "Nobody has control"), "it is free")
    press(second, strips[1].take)
    until(lambda: shown(strips, "You have control"), "client 2 has it")


def test_a_picture_between_a_press_and_what_it_does_does_not_turn_it_round(
    served: Served, two: Two, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, _, strips = two
    admit = Guard.admit

    def admit_and_draw(guard: Guard, client: int, raw: str | bytes) -> bytes | None:
        admitted = admit(guard, client, raw)
        served.control.show()
        return admitted

    press(first, strips[0].release)
    until(lambda: not strips[0].take.disabled and strips[0].take.visible, "it can be taken")
    monkeypatch.setattr(Guard, "admit", admit_and_draw)
    press(first, strips[0].take)
    until(lambda: buttons(strips[0]) == (False, True), "taken")
    first.set(served.lab.force._impl.uuid, value=90.0)
    until(lambda: served.hand.cap == 90.0, "what came after it is done")
    assert served.guard.operator.holder == 0


def test_the_strip_of_another_client_cannot_be_pressed(served: Served, join: Join) -> None:
    join()
    second = join()
    until(lambda: len(served.control._strips) == 2, "both have a strip")
    press(second, served.control._strips[0].take)
    until(lambda: served.guard.refused["unknown control"] == 1, "refused")
    assert served.guard.operator.holder is None


def test_who_watches_asks_for_control_and_the_holder_gives_it(served: Served, two: Two, clock: Clock) -> None:
    first, second, strips = two
    press(second, strips[1].ask)
    until(lambda: shown(strips, "Window 2 asks for control", "Asked. Wait for an answer."), "both are told")
    assert served.guard.operator.holder == 0
    assert strips[0].release.label == "Give"
    assert strips[1].ask.disabled
    second.set(served.lab.force._impl.uuid, value=90.0)
    until(lambda: served.guard.refused["not the operator"] == 1, "to ask is not to have")
    press(first, strips[0].release)
    until(lambda: shown(strips, "Window 2 has control", "You have control"), "given")
    assert strips[1].release.label == "Release"
    second.set(served.lab.force._impl.uuid, value=90.0)
    until(lambda: served.hand.cap == 90.0, "client 2 may act")


def test_a_request_ends_with_who_asked_and_with_who_was_asked(served: Served, two: Two, clock: Clock) -> None:
    _, second, strips = two
    press(second, strips[1].ask)
    until(lambda: shown(strips, "asks for control", "Asked."), "asked")
    second.close()
    until(lambda: "You have control" in strips[0].text.shown, "who asked has gone")
    third = join_again(served)
    press(third, strips[2].ask)
    until(lambda: "Window 3 asks" in strips[0].text.shown, "asked again")
    clock.now += SILENCE
    until(lambda: strips[2].take.visible, "it is free")
    press(third, strips[2].take)
    until(lambda: "took control" in strips[0].text.shown and "You have control" in strips[2].text.shown, "taken")
    third.close()


def test_the_request_of_another_client_cannot_be_pressed(served: Served, two: Two) -> None:
    first, _, strips = two
    press(first, strips[1].ask)
    until(lambda: served.guard.refused["unknown control"] == 1, "refused")
    assert "asks" not in strips[0].text.shown
