"""What other threads want of the script runner, until its next tick takes it."""

import threading
from typing import NamedTuple

from app.urscript.language.trouble import NOWHERE, ScriptTrouble
from app.urscript.running.script_robot import OfferedScript

MOST_SECONDARIES = 8
"""Secondary programs that wait or run."""


class Ordered(NamedTuple):
    """All that was ordered since the tick before."""

    script: OfferedScript | None = None  # to run in place of the one that does
    stop: bool = False  # the one that runs
    halt: bool | None = None  # it is to wait, or to go on; None: as it is
    beside: tuple[OfferedScript, ...] = ()  # secondary programs


NOTHING_ORDERED = Ordered()


class Orders:
    """Every method may be called from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._now = NOTHING_ORDERED
        self._over: list[OfferedScript] = []

    def run(self, script: OfferedScript) -> None:
        """Run a script; one that waits to be run is dropped."""
        with self._lock:
            if self._now.script is not None:
                self._over.append(self._now.script)
            self._now = self._now._replace(script=script, halt=None)

    def run_beside(self, script: OfferedScript, running: int) -> None:
        """Run a secondary program; `running` are there already. Raises ScriptTrouble: that is as many as may be."""
        with self._lock:
            if len(self._now.beside) + running >= MOST_SECONDARIES:
                raise ScriptTrouble(NOWHERE, f"more than {MOST_SECONDARIES} secondary programs at once")
            self._now = self._now._replace(beside=(*self._now.beside, script))

    def stop(self) -> None:
        """End the script that runs, and the one that waits."""
        with self._lock:
            if self._now.script is not None:
                self._over.append(self._now.script)
            self._now = self._now._replace(script=None, stop=True)

    def halt(self, wait: bool) -> None:
        """Let the script wait, or go on."""
        with self._lock:
            self._now = self._now._replace(halt=wait)

    def take(self) -> Ordered:
        """What was ordered; it is taken with that."""
        if self._now is NOTHING_ORDERED:  # in nearly every tick
            return NOTHING_ORDERED
        with self._lock:
            found, self._now = self._now, NOTHING_ORDERED
        return found

    def used_up(self, script: OfferedScript) -> None:
        """A script is used no more."""
        with self._lock:
            self._over.append(script)

    def let_go(self) -> None:
        """Let go of those that are used no more: of a long one that takes a while, so whoever makes the next script does it."""
        with self._lock:
            found, self._over = self._over, []
        for script in found:
            script.machine.let_go()
