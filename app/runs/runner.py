"""Runs a session without a window, as fast as possible or in real time. The same seed gives the same events in both."""

import time
from collections.abc import Callable
from contextlib import closing, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import msgspec
import mujoco
import numpy as np

from app.files.bad_input import ABSENT, BadInput
from app.files.disk_room import must_have_room
from app.log.events_file import EventsFile
from app.log.recorder import Recorder
from app.runs.network_run import NetworkRun
from app.session.actions import OfClient
from app.session.expectation_watch import Verdict, Watch
from app.session.measures import ComparedWatch, watch
from app.session.prepare import Prepared, prepare
from app.session.session_file import Session
from app.session.timeline import Timeline
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK, Mode
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario, ToolModel
from sim.exchange.desk import Wishes
from sim.exchange.scoring import Scored
from sim.exchange.snapshot import Snapshot
from sim.simulation import Simulation

Progress = Callable[[float], None]


def silent(seconds: float) -> None:
    """A `Progress` that does nothing."""


class Simulated(Protocol):
    """The part of a simulation that the runner needs."""

    def tick(self, wishes: Wishes) -> Decision:
        """One control tick."""
        ...

    def snapshot(self) -> Snapshot:
        """A copy of the last tick."""
        ...

    def glance(self) -> Scored:
        """Values of the last tick for scoring, valid until the next tick."""
        ...


@dataclass(slots=True)
class RunOutcome:
    """The result of a session."""

    modes: list[tuple[float, Mode]] = field(default_factory=list)  # time at which each mode began [s], the mode
    events: list[Event] = field(default_factory=list)
    verdicts: list[Verdict] = field(default_factory=list)
    seconds: float = 0.0  # simulated
    took: float = 0.0  # on the wall clock [s]

    def see(self, tick: int, decision: Decision) -> None:
        """Add one tick."""
        self.events += decision.events
        if not self.modes or self.modes[-1][1] is not decision.mode:
            self.modes.append((tick * TICK, decision.mode))

    @property
    def passed(self) -> bool:
        """Whether every expectation was met."""
        return all(verdict.passed for verdict in self.verdicts)

    @property
    def unmet(self) -> bool:
        """True if an expectation is `missed`."""
        return any(map(missed, self.verdicts))


def missed(verdict: Verdict) -> bool:
    """True if the expectation failed because of what was seen. One whose moment or interval never came does not count."""
    return verdict.looked and not verdict.passed


BROKEN = (ArithmeticError, np.linalg.LinAlgError, mujoco.FatalError)
"""Errors with which a simulation breaks down; they do not mean an error in the code."""

MOMENT = 200
"""A model that cannot be simulated breaks down within this many ticks, even if nobody touches it."""


def simulate(prepared: Prepared) -> Simulation:
    """The simulation that a session or a configuration asks for.

    Raises:
        BadInput: no model can be built.
    """
    try:
        return Simulation(prepared.arm, prepared.scenario, prepared.settings)
    except (*BROKEN, ValueError) as error:  # MuJoCo's compiler says ValueError
        raise _unable(prepared, "", error) from error


def try_out(prepared: Prepared, ticks: int = MOMENT) -> None:
    """Simulate for a moment what a file describes, in a simulation of its own.

    Raises:
        BadInput: it cannot be simulated.
    """
    simulation = simulate(prepared)
    for _ in range(ticks):
        _tick(simulation, prepared, Wishes(NOTHING, (), ()))
    told = simulation.estimate
    if not all(np.isfinite(values).all() for values in (told.q, told.qd, told.tau_J, told.tau_ext, told.F_user, told.v_F)):
        raise _unable(prepared, "", FloatingPointError("what the sensors tell is not finite"))


def try_tool(arm: Arm, tool: ToolModel, where: str) -> None:
    """Simulate a tool on the arm for a tick, in a simulation of its own. Raises BadInput: the tool cannot be simulated."""
    try_out(Prepared(arm, Scenario(tool=tool), Settings(), None, where), ticks=1)


def _tick(simulation: Simulated, prepared: Prepared, wishes: Wishes) -> Decision:
    try:
        return simulation.tick(wishes)
    except BROKEN as error:
        raise _unable(prepared, "while it runs", error) from error


def _unable(prepared: Prepared, when: str, error: Exception) -> BadInput:
    reason = " ".join(str(error).split()) or type(error).__name__
    return BadInput(prepared.where, when, ABSENT, f"cannot be simulated ({reason})")


def record(session: Session, prepared: Prepared, out: Path, *, realtime: bool = False, progress: Progress = silent) -> RunOutcome:
    """Run a session as `run`, and record it into `out`/log.mcap.

    Raises:
        BadInput: a file cannot be written, or the simulation breaks down; then the recording ends with the cause.
    """
    must_have_room(out)
    simulation = simulate(prepared)
    with Recorder(out / "log.mcap", simulation, session.title, planned=session.duration) as recorder:
        try:
            return run(
                session,
                prepared,
                simulation,
                out,
                realtime=realtime,
                progress=progress,
                see=lambda now: recorder.see(simulation, now),
            )
        except BadInput as error:
            recorder.note(Event(Kind.BROKEN_DOWN, simulation.tick_count, {"reason": error.allowed}))
            raise


def run(
    session: Session,
    prepared: Prepared,
    simulation: Simulated,
    out: Path | None,
    *,
    realtime: bool = False,
    progress: Progress = silent,
    see: Callable[[Decision], None] = lambda decision: None,
    enough: Callable[[Verdict], bool] | None = None,
) -> RunOutcome:
    """Run a session to its end.

    Args:
        session: time line and expectations.
        prepared: the same session, checked.
        simulation: simulation of `prepared`, at its start.
        out: folder for events.jsonl; it is made if it is missing. None: no file.
        realtime: keep the pace of the wall clock.
        progress: called with the simulated seconds done, ten times in a simulated second.
        see: called with the decision of every tick; a recorder, for example.
        enough: called with each verdict that is known. When it returns True the run ends early, and has only the verdicts that
            are known by then.

    Raises:
        BadInput: the file cannot be written, or the simulation breaks down.
    """
    joints = prepared.arm.chain.joints
    timeline = Timeline(session.timeline, joints, prepared.program)
    clients = None
    if any(isinstance(action, OfClient) for action in session.timeline):
        assert isinstance(simulation, Simulation)
        clients = NetworkRun(session, simulation)
    watches = [watch(expectation, joints) for expectation in session.expectations]
    outcome = RunOutcome(seconds=session.duration)
    begun = time.perf_counter()
    with (
        nullcontext() if clients is None else closing(clients),
        nullcontext() if out is None else EventsFile(out / "events.jsonl") as file,
    ):
        last, tenth = ticks(session.duration), ticks(0.1)
        for tick in range(1, last + 1):
            wishes = timeline.wishes(tick, simulation.snapshot)
            if clients is not None:
                wishes = wishes.joined(clients.wishes(tick, simulation.snapshot, timeline.of_clients))
            decision = _tick(simulation, prepared, wishes)
            timeline.see(tick, decision)
            if clients is not None:
                clients.see(tick, decision)
            quiet = not decision.events
            for each in watches:
                if each.needs(tick, quiet) or tick == last:
                    each.see(tick, decision, simulation.glance)
            see(decision)
            if file is not None:
                file.write(tick, decision.events)
            outcome.see(tick, decision)
            if tick % tenth == 0:
                progress(tick * TICK)
                if enough is not None and any(map(enough, known := _known(watches, tick, decision, simulation.glance))):
                    outcome.verdicts, outcome.seconds, outcome.took = known, tick * TICK, time.perf_counter() - begun
                    return outcome
            if realtime:
                time.sleep(max(0.0, begun + tick * TICK - time.perf_counter()))
    _compare(watches, session, prepared)
    outcome.took = time.perf_counter() - begun
    outcome.verdicts = [each.verdict() for each in watches] + ([] if clients is None else clients.verdicts())
    for place, action in timeline.unstarted():
        seen = f'"{action.after}" never came (time {action.nth}), or too late'
        outcome.verdicts.append(Verdict(False, f"timeline[{place}] begins", seen, looked=False))
    return outcome


def _known(watches: list[Watch], tick: int, decision: Decision, glance: Callable[[], Scored]) -> list[Verdict]:
    """The verdicts that no later tick can change."""
    over = [each for each in watches if each.over(tick)]
    for each in over:
        if not each.settled() and each.last < tick:
            each.see(tick, decision, glance)
    return [each.verdict() for each in over]


def _compare(watches: list[Watch], session: Session, prepared: Prepared) -> None:
    """Give each comparison its value in the same session with its other settings. Equal settings share one run."""
    runs: list[list[ComparedWatch]] = []
    for each in watches:
        if isinstance(each, ComparedWatch):
            alike = next((run for run in runs if run[0].wanted.settings == each.wanted.settings), None)
            runs.append([each]) if alike is None else alike.append(each)
    for run in runs:
        for each, measured in zip(run, _of_other_run(session, prepared, run), strict=True):
            each.other = measured


def _of_other_run(session: Session, prepared: Prepared, watched: list[ComparedWatch]) -> list[float]:
    """Values of comparisons that have the same other settings, in a run with these settings."""
    other = msgspec.structs.replace(session, settings={**session.settings, **watched[0].wanted.settings})
    again = prepare(other, prepared.where)
    simulation = simulate(again)
    timeline = Timeline(other.timeline, again.arm.chain.joints, again.program)
    others = [watch(each.wanted, again.arm.chain.joints) for each in watched]
    for tick in range(1, ticks(session.duration) + 1):
        decision = _tick(simulation, again, timeline.wishes(tick, simulation.snapshot))
        timeline.see(tick, decision)
        for each in others:
            each.see(tick, decision, simulation.glance)
    return [each.measured for each in others if isinstance(each, ComparedWatch)]
