"""The main bar: run, pause, stop, the way to the start, and what is told of the program."""

import asyncio
from collections.abc import Callable

from app.web.server import Served
from pendant.events.event import Kind
from pendant.inputs import Command
from pendant.program.jog_move import MoveThere
from pendant.program.steps import ProgramState
from pendant.tick.modes import Mode
from pendant.tooling.payload_wizard import Progress
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


def commands(loop: FakeLoop) -> list[Command]:
    """What was asked for since."""
    loop.advance()
    return list(loop.wishes[-1].inputs.commands)


def test_run_pause_go_on_and_stop(served: Served, join: Join, loop: FakeLoop) -> None:
    client, bar, teach = join(), served.panel.bar, served.docks.teach
    assert bar.run.disabled
    assert "No program yet" in bar.line.shown
    teach.mark()
    until(lambda: not bar.run.disabled, "there is a step")
    until(lambda: "Program: 1 step<" in bar.line.shown, "its line")
    client.set(bar.run._impl.uuid, value=True)
    until(lambda: Command.START_PROGRAM in commands(loop), "started")
    loop.mode, loop.program, loop.step = Mode.RUN, ProgramState.RUNNING, 1
    loop.note(Kind.PROGRAM_LOADED, name="taught", steps=1)
    until(lambda: not bar.pause.disabled and not bar.stop.disabled and bar.run.disabled, "it runs")
    until(lambda: "Program &quot;taught&quot;, step 1" in bar.line.shown, "told")
    client.set(bar.pause._impl.uuid, value=True)
    until(lambda: Command.PAUSE_PROGRAM in commands(loop), "paused")
    loop.program = ProgramState.PAUSED
    until(lambda: not bar.run.disabled and bar.pause.disabled, "it waits")
    client.set(bar.run._impl.uuid, value=True)
    until(lambda: Command.RESUME_PROGRAM in commands(loop), "goes on")
    client.set(bar.stop._impl.uuid, value=True)
    until(lambda: Command.STOP_PROGRAM in commands(loop), "ended")


def test_stop_ends_the_payload_wizard(served: Served, join: Join, loop: FakeLoop) -> None:
    client, bar = join(), served.panel.bar
    loop.wizard = Progress(doing="turns to posture 2")
    until(lambda: not bar.stop.disabled, "it turns the wrist")
    client.set(bar.stop._impl.uuid, value=True)
    until(lambda: Command.WIZARD_CLEAR in commands(loop), "ended")


def test_the_way_to_the_start_is_held(loop: FakeLoop, still: Served) -> None:
    jog, teach = still.docks.jog, still.docks.teach
    assert jog._asked("start") is None
    teach.mark()
    still.docks.show(loop.latest())
    assert not still.panel.bar.start.disabled
    asked = jog._asked("start")
    assert isinstance(asked, MoveThere)
    assert (asked.q, asked.name) == (tuple(teach.lesson.waypoints[0].q), "P1")
    loop.mode = Mode.STOP
    still.docks.show(loop.latest())
    assert still.panel.bar.start.disabled


def test_its_button_moves_only_where_there_is_a_start(loop: FakeLoop, still: Served) -> None:
    class Press:
        client_id = 0

    async def hold() -> None:
        held = still.docks.jog._held("start")
        await held(Press())  # type: ignore[arg-type]
        loop.tick += 200
        await held(Press())  # type: ignore[arg-type]

    asyncio.run(hold())
    loop.advance()
    assert loop.wishes[-1].inputs.jog is None
