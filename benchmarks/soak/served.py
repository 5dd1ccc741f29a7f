"""The app, as a process of its own that tells how it is: a line of JSON on its standard output every PERIOD.

The first line says where the page is. It ends when its standard input ends. Whatever goes wrong is on its standard error.
"""

import json
import logging
import resource
import sys
import threading
import time
from collections import deque
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from app.files.library import load_arm
from app.runs.warm_up import warm_up
from app.serving import scripts_beside
from app.urscript.language.trouble import ScriptTrouble
from app.web.server import serve
from pendant.all_settings import Settings
from pendant.tick.modes import TICK
from sim.arm.scenario import Scenario
from sim.run.loop import Loop
from sim.simulation import Simulation

PERIOD = 0.5  # [s]
TALK = 'sec talk():\n  i = 0\n  while i < 20:\n    textmsg("so far ", i)\n    i = i + 1\n  end\nend\n'
"""What is said on the page each PERIOD, beside all that its users do; it takes no time of the arm's."""

BUILD = 10  # periods that building a scenario may take: the arm stands still meanwhile


@dataclass(slots=True)
class State:
    """How it is, PERIOD after the last one."""

    at: float = 0.0  # since it began [s]
    memory: float = 0.0  # resident [MB]
    simulated: float = 0.0  # in the stretches that count, so far [s]
    real: float = 0.0  # how long those took [s]
    dropped: float = 0.0  # by stalls [s]
    resets: int = 0
    events: int = 0
    clients: int = 0
    failed: bool = False


class Pace:
    """Simulated over real time, counted where the clock was neither paused nor slowed, and no scenario was being built."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._last = (time.monotonic(), loop.simulation.tick_count, loop.simulation)
        self._plain = False  # at the last look
        self._held: deque[tuple[float, float]] = deque()  # stretches that a new scenario would still take back

    def look(self, state: State) -> None:
        """Take in the stretch since the last look."""
        loop = self._loop
        now, ticks, simulation = time.monotonic(), loop.simulation.tick_count, loop.simulation
        then, before, former = self._last
        plain = not loop.paused and loop.speed == 1.0
        if simulation is not former:
            state.resets += 1
            self._held.clear()
            plain = False
        elif plain and self._plain:
            self._held.append(((ticks - before) * TICK, now - then))
        while len(self._held) > BUILD:
            simulated, real = self._held.popleft()
            state.simulated += simulated
            state.real += real
        self._last, self._plain = (now, ticks, simulation), plain


def resident() -> float:
    """Memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 2**20


def run(seed: int) -> None:
    """Serve until standard input ends."""
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING)
    arm = load_arm("ur5e")
    warm_up()  # as the app does
    loop = Loop(lambda: Simulation(arm, Scenario(seed=seed), Settings()))
    loop.start()
    ended = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
    scripts = scripts_beside(loop, arm)
    assert scripts is not None
    served = serve(loop, arm, loop.scenario, scripts=scripts)
    print(served.url, flush=True)
    start, state, pace = time.monotonic(), State(), Pace(loop)
    while not ended.wait(PERIOD):
        with suppress(ScriptTrouble):  # an arm that is off runs none
            scripts.offer(TALK)
        pace.look(state)
        state.at, state.memory, state.dropped = time.monotonic() - start, resident(), loop.dropped
        state.events, state.clients = len(loop.events(0)), len(served.server.get_clients())
        state.failed = bool(loop.failure) or served._painter.done()
        print(json.dumps(asdict(state)), flush=True)
    served.close()
    loop.stop()


if __name__ == "__main__":
    run(int(sys.argv[1]))
