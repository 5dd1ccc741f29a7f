"""Text that clients send to the client interfaces: lines that a controller knows by themselves; programs are not run here."""

from collections.abc import Callable

from app.robot_interface.controller.cabinet import Ask
from app.robot_interface.dashboard.dashboard_commands import DashboardCommands, Pending

LINES = {
    "power on": ("power on",),
    "power off": ("power off",),
    "set robotmode run": ("power on", "brake release"),
    "set unlock protective stop": ("unlock protective stop",),
    "stop program": ("stop",),
}
"""What each line does, in the dashboard's words."""

LONGEST = 1 << 20
"""Of a program [bytes]."""

NO_SCRIPT = "URScript is not run by this version: load a program by name (dashboard), or use the control channel"


class TextCommands:
    """Takes the text of one connection.

    Args:
        commands: what the lines do.
        ask: hands a wish to the robot.
        complain: tells the client what cannot be done: line, column, text.
    """

    def __init__(
        self, commands: DashboardCommands, ask: Callable[[Ask], object], complain: Callable[[int, int, str], None]
    ) -> None:
        self._commands, self._ask, self._complain = commands, ask, complain
        self._left = b""
        self._inside = False  # of a program: its lines are passed over up to its end

    def hear(self, data: bytes, remote: bool) -> bool:
        """Do the lines that are whole; False: the text is too long.

        Args:
            data: as it came.
            remote: the robot is in remote control; otherwise nothing is done.
        """
        *lines, self._left = (self._left + data).split(b"\n")
        if len(self._left) > LONGEST:
            return False
        for number, line in enumerate(lines, 1):
            text = line.decode("utf-8", "replace").rstrip()
            if text.strip():
                self._do(text, number, remote)
        return True

    def _do(self, text: str, number: int, remote: bool) -> None:
        if self._inside:
            self._inside = text != "end"
            return
        if not remote:
            self._complain(number, 1, "the robot is in local control")
            return
        if text.strip() in LINES:
            for command in LINES[text.strip()]:
                answer = self._commands.answer(command, remote)
                if isinstance(answer, Pending):
                    self._ask(answer.ask)
            return
        self._inside = text.startswith(("def ", "sec "))
        self._complain(number, 1, NO_SCRIPT)
