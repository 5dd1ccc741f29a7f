"""Ready-made scenarios: bundled sessions that say what to watch, set up with one click, or shown by their own time line."""

import functools

import viser

from app.files.checked import load
from app.runs.runner import simulate
from app.session.prepare import prepare
from app.session.session_file import Session, bundled, folder
from app.session.timeline import Timeline
from app.web.running import Running
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from sim.arm.arm_file import Arm


@functools.cache
def scenarios() -> dict[str, Session]:
    """The bundled sessions that say what to watch, by file name."""
    found = {name: load(folder("sessions") / f"{name}.yaml", Session) for name in bundled("sessions")}
    return {name: session for name, session in found.items() if session.watch}


class Scenarios:
    """The scenarios' part of the laboratory; there may be none for an arm."""

    def __init__(self, gui: viser.GuiApi, loop: Running, arm: Arm) -> None:
        self._loop = loop
        self._names = {session.title: name for name, session in scenarios().items() if session.robot == arm.name}
        self.text = Html(gui)
        if not self._names:
            return
        with gui.add_folder("Scenario"):
            self.choice = gui.add_dropdown("Show", tuple(self._names))
            self.text = Html(gui)
            self.begin = gui.add_button_group("Begin", ("Set up", "Play"))
        self._tell()

        @self.choice.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._tell()

        @self.begin.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._begin(play=self.begin.value == "Play")

    def _tell(self) -> None:
        session = scenarios()[self._names[self.choice.value]]
        self.text.show(svg.note("What to watch", session.watch, Colour.GREY))

    def _begin(self, play: bool) -> None:
        name = self._names[self.choice.value]
        session = scenarios()[name]
        prepared = prepare(session, name)
        actions = session.timeline if play else []
        joints = prepared.arm.chain.joints
        self._loop.paused = False
        self._loop.begin(lambda: simulate(prepared), lambda: Timeline(actions, joints, prepared.program))
