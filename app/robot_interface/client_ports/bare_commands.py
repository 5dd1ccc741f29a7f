"""Lines that a controller knows by themselves, and the programs that clients send to the client interfaces."""

import asyncio
from collections.abc import Callable

from app.robot_interface.dashboard.dashboard_commands import DashboardCommands
from app.urscript.language.program_text import LONGEST, ProgramText
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running.script_runner import ScriptRunner

LINES = {
    "power on": ("power on",),
    "power off": ("power off",),
    "set robotmode run": ("power on", "brake release"),
    "set unlock protective stop": ("unlock protective stop",),
    "stop program": ("stop",),
}
"""What each line does, in the dashboard's words."""

UNFINISHED = 2.0
"""Time without anything more after which a program without its end is read as it is [s]."""

__all__ = ["LINES", "LONGEST", "TextCommands"]


class TextCommands:
    """Takes the text of one connection.

    Args:
        commands: what the lines do.
        complain: tells the client what cannot be done.
        note: notes what cannot be done where the client has been told already.
        scripts: runs programs; tells all clients why one cannot be begun.
        hosts: that the client's programs may connect to: where it is.
    """

    def __init__(
        self,
        commands: DashboardCommands,
        complain: Callable[[str], None],
        note: Callable[[str], None],
        *,
        scripts: ScriptRunner,
        hosts: frozenset[str],
    ) -> None:
        self._commands, self._scripts, self._hosts = commands, scripts, hosts
        self._complain, self._note = complain, note
        self._text = ProgramText()
        self._heard = 0
        self._waiting: asyncio.Task[None] | None = None

    async def hear(self, data: bytes, remote: Callable[[], bool]) -> bool:
        """Do the lines and programs that are whole; False: the text is too long.

        Args:
            data: as it came.
            remote: tells whether the robot is in remote control; otherwise nothing is done.
        """
        self._heard += 1
        found = self._text.hear(data)
        if found is None:
            return False
        for text in found:
            await self._do(text, remote())
        if self._text.unfinished and self._waiting is None:
            self._waiting = asyncio.create_task(self._wait(remote))
        return True

    def over(self) -> None:
        """The connection is over."""
        if self._waiting is not None:
            self._waiting.cancel()

    async def _wait(self, remote: Callable[[], bool]) -> None:
        """Read a program whose end does not come as it is, to say what is wrong with it."""
        heard = -1
        while self._text.unfinished and heard != self._heard:
            heard = self._heard
            await asyncio.sleep(UNFINISHED)
        self._waiting = None
        if self._text.unfinished:
            await self._do(self._text.all(), remote())

    async def _do(self, text: str, remote: bool) -> None:
        line = text.strip()
        if not remote:
            self._complain("the robot is in local control")
            return
        if line in LINES:
            for command in LINES[line]:
                self._commands.answer(command, remote)
            return
        try:
            await asyncio.to_thread(self._scripts.offer, text, self._hosts)
        except ScriptTrouble as trouble:
            self._note(trouble.text)
