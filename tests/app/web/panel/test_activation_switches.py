"""What starts free-drive, on the page."""

from collections.abc import Callable

import pytest

from app.web.panel.activation_switches import SWITCHES
from app.web.server import Served
from pendant.all_settings import Settings, apply, describe, find
from pendant.inputs import Button
from pendant.tick.modes import Mode, Phase
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]
NEEDED = apply(Settings(), {"enabling.on": True})


def hold(client: RawClient, served: Served, grip: str) -> None:
    client.set(served.panel.activation.grip._impl.uuid, value=grip)
    until(lambda: served.panel.activation.grip.value == grip, grip)


def seen(loop: FakeLoop) -> frozenset[Button]:
    loop.advance()
    return loop.wishes[-1].inputs.held


def test_every_source_has_its_switch() -> None:
    sources = {row.name for row in describe() if row.id == "FD-5" and row.low is None and row.name.startswith("signals.")}
    assert {name for name in sources if name.endswith(".on") or name.count(".") == 1} <= set(SWITCHES)
    assert all(find(name).id in ("FD-5", "FD-8", "FD-23") for name in SWITCHES)


@pytest.mark.parametrize("name", SWITCHES)
def test_a_switch_goes_to_the_desk_and_shows_what_holds(served: Served, join: Join, loop: FakeLoop, name: str) -> None:
    client, control = join(), served.panel.activation.switches[name]
    was = bool(find(name).default)
    until(lambda: control.value == was, "the default")
    client.set(control._impl.uuid, value=not was)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {name: not was}, "the wish")
    loop.settings = apply(Settings(), {name: was})  # refused
    until(lambda: control.value == was, "the truth")


def test_switches_are_locked_while_the_arm_is_free(loop: FakeLoop, still: Served) -> None:
    activation = still.panel.activation
    for mode, phase, locked in (
        (Mode.TEACH, Phase.OFF, False),
        (Mode.TEACH, Phase.SEQUENCE, True),
        (Mode.FREE_DRIVE, Phase.HELD, True),
        (Mode.RUN, Phase.OFF, True),
    ):
        loop.mode, loop.phase = mode, phase
        activation.show(loop.latest())
        assert {control.disabled for control in activation.switches.values()} == {locked}
    assert not activation.show(loop.latest())


def test_the_enabling_device_is_held_where_it_was_left(served: Served, join: Join, loop: FakeLoop) -> None:
    loop.settings = NEEDED
    client = join()
    until(lambda: not served.panel.activation.grip.disabled, "it is needed")
    hold(client, served, "in the middle")
    for _ in range(3):
        until(lambda: seen(loop) == {Button.ENABLING}, "kept alive")
    hold(client, served, "fully pressed")
    until(lambda: seen(loop) == {Button.ENABLING_FULL}, "pressed")
    hold(client, served, "released")
    until(lambda: loop.advance() is None and Button.ENABLING_FULL in loop.wishes[-1].inputs.released, "released")
    assert seen(loop) == frozenset()


@pytest.mark.parametrize("end", ["gone", "switched off", "taken over"])
def test_the_enabling_device_is_released_without_its_client(served: Served, join: Join, loop: FakeLoop, end: str) -> None:
    loop.settings = NEEDED
    client = join()
    until(lambda: not served.panel.activation.grip.disabled, "it is needed")
    hold(client, served, "in the middle")
    until(lambda: seen(loop) == {Button.ENABLING}, "held")
    if end == "gone":
        client.close()
    elif end == "switched off":
        loop.settings = Settings()
    else:
        served.guard.operator.leave(0)
    until(lambda: loop.advance() is None and Button.ENABLING in loop.wishes[-1].inputs.released, "released")
    until(lambda: served.panel.activation.grip.value == "released", "shown")


def test_while_a_confirmation_is_asked_for_the_button_says_so(loop: FakeLoop, still: Served) -> None:
    loop.phase = Phase.CONFIRM
    assert still.panel.show(loop.latest(), [])
    assert still.panel.free_drive.label == "Press to confirm"
    assert not still.panel.show(loop.latest(), [])
    loop.phase = Phase.OFF
    still.panel.show(loop.latest(), [])
    assert still.panel.free_drive.label == "Hold for free-drive"
