"""Who is connected to the robot's network interfaces, what they say, and who has control."""

import viser

from app.robot_interface.controller.callers import Ask
from app.robot_interface.interfaces import RobotInterfaces
from app.robot_interface.transport.peers import Said
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.inputs import Command

LENGTH = 40
"""Messages shown."""


class NetworkTab:
    """The tab with the switch of control, the connections and the messages."""

    def __init__(self, gui: viser.GuiApi, interfaces: RobotInterfaces) -> None:
        self._interfaces = interfaces
        self._said: list[Said] = []
        cabinet = interfaces.cabinet
        self.control = gui.add_button_group("Control", ("Local", "Remote"), hint="Who starts programs and free-drive.")
        self.status = Html(gui)
        self.peers = Html(gui)
        self.messages = Html(gui, svg.table(()))

        @self.control.on_click
        async def _(_: viser.GuiEvent) -> None:
            cabinet.ask(Ask((Command.REMOTE if self.control.value == "Remote" else Command.TEACH,)))

    def show(self) -> bool:
        """Bring it up to date; True if anything changed."""
        interfaces, state = self._interfaces, self._interfaces.cabinet.state
        fresh = interfaces.peers.said(self._said[-1].number if self._said else 0)
        self._said = (self._said + fresh)[-LENGTH:]
        facts = [
            ("Control", "remote" if state.remote else "local"),
            ("Robot mode", state.robot_mode.name),
            ("Safety mode", state.safety_mode.name),
            ("Program", f"{state.runtime.name} {state.program}".strip()),
            ("Address", f"{interfaces.host}, RTDE {interfaces.ports['RTDE']}"),
        ]
        if state.question is not None:
            facts.append(("Question", state.question.text))
        if state.popup:
            facts.append(("Popup", state.popup))
        there = [(peer.interface, f"{peer.address} {peer.about}".strip()) for peer in interfaces.peers.all()]
        return any(
            [
                self.status.show(svg.facts(facts)),
                self.peers.show(svg.facts(there or [("Connected", "nobody")])),
                self.messages.show(svg.table((said.interface, said.text, Colour.GREY) for said in reversed(self._said))),
            ]
        )
