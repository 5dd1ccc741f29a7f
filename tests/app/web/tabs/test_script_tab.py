"""The tab Script: what its controls do to a robot without a network, and what it shows."""

import sys
import threading
import time
from collections.abc import Iterator

import pytest
import viser

from app.urscript.running.told import Telling, Told
from app.web.tabs.script_tab import EXAMPLE, MOST, ScriptTab
from pendant.tick.modes import Mode
from tests.app.urscript.script_bench import ScriptBench


class Stage:
    """A robot in local control, and the tab."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self.bench = ScriptBench()
        self.bench.robot.cabinet.set(remote=False)
        self.tab = ScriptTab(gui, self.bench.runner)

    def begin(self, text: str) -> None:
        self.tab.text.value = text
        self.tab.act("Run")

    def after(self, ticks: int) -> str:
        self.bench.robot.step(ticks)
        self.tab.show()
        return "".join(each.shown for each in (self.tab.message, self.tab.listing, self.tab.variables, self.tab.said))


@pytest.fixture
def stage() -> Iterator[Stage]:
    server = viser.ViserServer(port=0, verbose=False)
    yield Stage(server.gui)
    server.stop()


def test_the_example_moves_the_arm_and_shows_where_it_is(stage: Stage) -> None:
    stage.begin(EXAMPLE)
    shown = stage.after(150)
    assert stage.bench.robot.step().mode is Mode.RUN
    assert '<li value=5 class="pd-now">  movej(q, a=1.4, v=0.5) <em>playing</em></li>' in shown
    assert "<dt>begin</dt>" in shown
    shown = stage.after(2000)
    assert "turned by 0.3" in shown
    assert "pd-now" not in shown


def test_it_waits_goes_on_and_stops(stage: Stage) -> None:
    stage.begin("def on():\n  while True:\n    sync()\n  end\nend")
    stage.after(10)
    stage.tab.act("Pause")
    assert "<em>paused</em>" in stage.after(10)
    stage.tab.act("Go on")
    assert "<em>playing</em>" in stage.after(10)
    stage.tab.act("Stop")
    assert "<em>" not in stage.after(10)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("def bad():\n  x = )\nend", "line 2, column"),
        ("def bad():\n  nothing()\nend", "line 2, column"),
        ("x" * (MOST + 1), f"The program has {MOST + 1} characters, allowed: {MOST} at most."),
    ],
)
def test_what_is_wrong_is_told_in_a_line(stage: Stage, text: str, told: str) -> None:
    stage.begin(text)
    assert told in stage.after(20)


def test_where_it_went_wrong_is_marked(stage: Stage) -> None:
    stage.begin("def far():\n  movej([9,0,0,0,0,0])\nend")
    assert '<li value=2 class="pd-now">' in stage.after(400)


def test_in_remote_control_the_page_runs_nothing(stage: Stage) -> None:
    stage.bench.robot.cabinet.set(remote=True)
    stage.begin(EXAMPLE)
    assert "remote control" in stage.after(5)
    assert stage.bench.state is None


def test_texts_of_a_program_are_text(stage: Stage) -> None:
    stage.begin('def evil():\n  x = "<img src=y>"\n  textmsg("<script>")\n  sleep(9)\nend')
    shown = stage.after(20)
    assert "<img" not in shown
    assert "<script" not in shown
    assert "&lt;script&gt;" in shown


def test_files_are_read_or_refused(stage: Stage) -> None:
    stage.tab.read(b"def mine():\nend\n")
    assert stage.tab.text.value == "def mine():\nend\n"
    for content, told in ((b"\xff", "no text in UTF-8"), (b"x" * (MOST + 1), f"more than {MOST} characters")):
        stage.tab.read(content)
        assert told in stage.after(1)
        assert stage.tab.text.value == "def mine():\nend\n"


def test_it_is_drawn_while_scripts_talk_begin_and_end(stage: Stage) -> None:
    """A list of messages that grew while the page went through it ended the page for good; so did a script that ended."""
    runner, over, failed = stage.bench.runner, threading.Event(), list[Exception]()

    def talk() -> None:
        while not over.is_set():
            runner.tell(Told(Telling.TEXT, "x"))

    def run() -> None:
        try:
            while not over.is_set():
                runner.offer("def on():\n  global a = [1, 2, 3]\n  textmsg(a)\n  sync()\nend")
                stage.bench.robot.step(4)
        except Exception as error:  # noqa: BLE001
            failed.append(error)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(2e-5)
    threads = [threading.Thread(target=work) for work in (talk, run)]
    try:
        for thread in threads:
            thread.start()
        end = time.monotonic() + 3.0
        while time.monotonic() < end and not failed:
            stage.tab.show()
            runner.pause()
            runner.resume()
            assert (runner.state, runner.name, runner.line, runner.variables()) is not None
    finally:
        over.set()
        for thread in threads:
            thread.join()
        sys.setswitchinterval(interval)
    assert failed == []
