"""Clients of the network interfaces in a session: the same state, commands and fields, without a network and its time."""

from collections.abc import Callable, Sequence

from app.files.bad_input import BadInput
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.program_folder import ProgramFolder
from app.robot_interface.controller.rtde_fields import OUTPUTS
from app.robot_interface.dashboard.dashboard_commands import DashboardCommands, Pending
from app.session.actions import AskForFreeDrive, DashboardLine, OfClient, ReadField, SendScript
from app.session.expectation_watch import Verdict
from app.session.session_file import Session
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running.script_runner import ScriptRunner
from app.urscript.running.told import Telling, Told
from app.urscript.running.whole_text import run_text
from pendant.decision import Decision
from pendant.events.event import Event
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.exchange.desk import Wishes
from sim.exchange.snapshot import Snapshot
from sim.simulation import Simulation

JOINTS = 6
"""Number of joints that an arm must have for RTDE."""


class NetworkRun:
    """Does in a session what `Cabinet` does in the loop.

    Args:
        session: session whose clients act.
        simulation: the session's simulation, at its start.

    Raises:
        BadInput: a field does not exist, or the arm has not six joints.
    """

    def __init__(self, session: Session, simulation: Simulation) -> None:
        for i, action in enumerate(session.timeline):
            if isinstance(action, ReadField) and action.field not in OUTPUTS:
                raise BadInput(session.title, f"timeline[{i}].field", action.field, "an output field of RTDE, such as robot_mode")
            if isinstance(action, SendScript) and action.text.lstrip().startswith("sec "):
                allowed = "a program, such as def name(): ... end; of a secondary one no end is told"
                raise BadInput(session.title, f"timeline[{i}].text", action.text.split(":")[0], allowed)
        if simulation.arm.n != JOINTS:
            raise BadInput(session.title, "robot", simulation.arm.name, f"an arm of {JOINTS} joints for clients of the network")
        self._cabinet = Cabinet(lambda: simulation, simulation.arm.chain.joints, ProgramFolder())
        self._cabinet.listen(self)
        self._commands = DashboardCommands(self._cabinet, simulation.arm.name.upper().removesuffix("E"))
        self._asked: list[tuple[int, DashboardLine, str | Pending]] = []  # in this tick
        self._reads: list[tuple[int, ReadField]] = []
        self._scripts = ScriptRunner(self._cabinet)
        self._sent: list[tuple[int, SendScript, list[str]]] = []  # scripts with the lines that each has told
        self._running = 0  # place in `_sent` of the script that runs now
        self._troubles: dict[int, ScriptTrouble | None] = {}  # how scripts ended, by their places in the time line
        self._scripts.listen(self._take)
        self._verdicts: list[Verdict] = []

    def close(self) -> None:
        """The session is over: a script that is not at its end counts as running."""
        self._scripts.forget(self._take)
        self._scripts.close()

    def tick(self, number: int) -> None:
        """Nothing to do: it only makes `Cabinet` write RTDE's fields, as it does if somebody listens."""

    def told(self, event: Event) -> None:
        """Nothing to do: the session keeps its own list of events."""

    def repeat(self) -> None:
        """Nothing to do: in a session the ticks never stop for a while."""

    def again(self) -> None:
        """Nothing to do: in a session no package is repeated because the loop is busy."""

    def wishes(self, tick: int, snapshot: Callable[[], Snapshot], actions: Sequence[tuple[int, OfClient]]) -> Wishes:
        """Wishes of the clients for the tick; `actions` are those that begin in this tick, with their places in the time line."""
        for place, action in actions:
            if isinstance(action, DashboardLine):
                answer = self._commands.answer(action.send, remote=self._cabinet.state.remote)
                self._asked.append((place, action, answer))
            elif isinstance(action, SendScript):
                self._send(place, action)
            elif isinstance(action, AskForFreeDrive):
                self._cabinet.free_drive_until = self._cabinet.ticks + ticks(action.length)
            else:
                self._reads.append((place, action))
        return self._cabinet.wishes(tick, snapshot)

    def _send(self, place: int, action: SendScript) -> None:
        self._sent.append((place, action, []))
        try:
            run_text(self._scripts, action.text)
        except ScriptTrouble as trouble:
            self._troubles[place] = trouble

    def _take(self, told: Told) -> None:
        if told.kind is Telling.STARTED:
            self._running = len(self._sent) - 1
        place, _, lines = self._sent[self._running]
        if told.kind is Telling.TEXT:
            lines.append(told.text)
        elif told.kind is Telling.ENDED:
            self._troubles[place] = self._scripts.trouble

    def verdicts(self) -> list[Verdict]:
        """Verdicts on the answers to the clients, when the session is over."""
        found = list(self._verdicts)
        for place, action, lines in self._sent:
            over, trouble = place in self._troubles, self._troubles.get(place)
            ended = "it still runs" if not over else "over" if trouble is None else str(trouble)
            wanted = f"timeline[{place}] the script ends " + (f'with "{action.trouble}"' if action.trouble else "by itself")
            as_it_should = over and (action.trouble in str(trouble) if action.trouble else trouble is None)
            found.append(Verdict(as_it_should, wanted, ended))
            for k, line in enumerate(action.tells):
                said = lines[k] if k < len(lines) else ""
                found.append(Verdict(said.startswith(line), f'timeline[{place}] the script says "{line}"', f'"{said}"'))
        return found

    def see(self, tick: int, decision: Decision) -> None:
        """Take the robot's decision, and judge the answers to the clients."""
        self._cabinet.see(tick, decision)
        for place, line, answer in self._asked:
            said = answer.answer(answer.asked.result(0.0)) if isinstance(answer, Pending) else answer
            wanted = f'timeline[{place}] "{line.send}" is answered "{line.reply}"'
            self._verdicts.append(Verdict(said.startswith(line.reply), wanted, f'"{said}" at {tick * TICK:.3f} s'))
        for place, read in self._reads:
            value = self._cabinet.record.get(read.field)
            number = value[read.index] if isinstance(value, list) else value
            low, high = (-float("inf") if read.min is None else read.min), (float("inf") if read.max is None else read.max)
            wanted = f"timeline[{place}] {read.field} from {low:g} to {high:g}"
            self._verdicts.append(Verdict(low <= number <= high, wanted, f"{number:g} at {tick * TICK:.3f} s"))
        self._asked, self._reads = [], []
