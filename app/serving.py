"""Serves a prepared simulation until the user stops it."""

import webbrowser
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from app.ending import ending
from app.files.checked import BadInput
from app.files.library import own_robots, robots
from app.kept_setup import Cell, Keeper, check_cell, keeper_for
from app.log.live import LiveRecording
from app.log.recording_plan import ALL, RecordingPlan
from app.log_reading.playback import Player
from app.log_reading.reader import files_of, read
from app.mcap_file.mending import repair
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.program_folder import ProgramFolder
from app.robot_interface.interfaces import JOINTS, RobotInterfaces
from app.robot_serving import FINISHED, STOOD, Network, end_in_turn, get_ready, open_interfaces
from app.runs.runner import simulate
from app.runs.warm_up import warm_up
from app.session.prepare import Prepared, prepare
from app.session.session_file import FIRST_START
from app.urscript.running.script_runner import ScriptRunner
from app.web.access.listening import Access, access_through, free_port
from app.web.access.site import Site
from app.web.arm_change import BroughtArm, ReadyArm, meshes_of
from app.web.replay import Replay
from app.web.server import Served
from app.web.server import serve as serve_web
from pendant.inputs import NOTHING
from sim.arm.arm_file import Arm
from sim.exchange.desk import Wishes
from sim.run.loop import Loop
from sim.run.troubles import reason_of

if TYPE_CHECKING:
    from app.real_logs.against import Against


class Serving(NamedTuple):
    """What is being served."""

    site: Site  # the page
    interfaces: RobotInterfaces | None  # the robot on the network


@contextmanager
def serve_until_interrupted(
    prepared: Prepared,
    *,
    host: str,
    port: int | None,
    usual: int,
    open_browser: bool,
    record: Path | None,
    plan: RecordingPlan = ALL,
    network: Network | None = None,
    keeper: Keeper | None = None,
    cell: Cell | None = None,
) -> Iterator[Serving]:
    """Serve; the body runs once the page is up; then wait for Ctrl-C or SIGTERM, which end all in seconds.

    Args:
        prepared: what to simulate.
        host: address to listen on.
        port: to listen on, 0 for any free one; None: `usual` when it is free, else any.
        usual: the port that a user's bookmark knows.
        open_browser: open the page too.
        record: record from the start, into this folder.
        plan: how often what is recorded, and how long a file of it is.
        network: where the robot's network interfaces are to be; None for the page alone.
        keeper: as `app.web.server.serve`.
        cell: as `app.web.server.serve`.

    Raises:
        BadInput: an address cannot be used.
    """
    get_ready(prepared.arm)
    loop = Loop(lambda: simulate(prepared))
    with ending() as end:
        recording = LiveRecording(loop, record or Path(), plan)
        end.see_to(recording.close)
        arms = ServedArms(loop, recording, network=network, folder=None if keeper is None else keeper.path.parent)
        interfaces = arms.open(prepared)
        try:
            loop.start()
            if record is not None:
                recording.start().result()
            scripts = arms.scripts(prepared.arm)
            robot = partial(serve_web, loop, prepared.arm, prepared.scenario, recording=recording, interfaces=interfaces)
            page = partial(robot, scripts=scripts, keeper=keeper, cell=cell, arms=arms)
            served = _serve(partial(page, host=host, open_browser=open_browser), port=port, usual=usual)
            try:
                yield Serving(served, interfaces)
                end.asked.wait()
            finally:
                end_in_turn(lambda: recording.close(FINISHED), served.close)
        finally:
            end_in_turn(lambda: recording.close(FINISHED), arms.close, lambda: loop.stop(STOOD))


@contextmanager
def replay_until_interrupted(path: Path, *, host: str, port: int | None, usual: int, open_browser: bool) -> Iterator[Site]:
    """Show a recording, as `serve_until_interrupted` serves a simulation; a file without its end is repaired first.

    Raises:
        BadInput: the log cannot be read or repaired, or the address cannot be used.
    """
    for file in files_of(path):
        repair(file)
    player = Player(read(path))
    meshes = meshes_of(player.log.arm)
    with _shown(partial(Replay, player, meshes), host=host, port=port, usual=usual) as shown:
        if open_browser:
            webbrowser.open(shown.link)
        yield shown


@contextmanager
def log_shown_until_interrupted(found: "Against", prepared: Prepared, *, usual: int) -> Iterator[Site]:
    """Show what became of a log that was held against the controller, on this machine alone.

    Args:
        found: of the log.
        prepared: what the controller believed in.
        usual: port, when it is free; else any.

    Raises:
        BadInput: no model can be built of it, or no port is free.
    """
    from app.web.log_replay import LogReplay  # draws with matplotlib, which is of the extra [logs]

    simulation = simulate(prepared)
    simulation.tick(Wishes(NOTHING, (), ()))
    snapshot = replace(simulation.snapshot(), scenario=prepared.scenario)
    page = partial(LogReplay, found, snapshot, meshes=meshes_of(found.arm))

    def at(access: Access, port: int) -> LogReplay:
        return page(access=access, port=port)

    with _shown(at, host="127.0.0.1", port=None, usual=usual) as shown:
        yield shown


@contextmanager
def _shown(page: Callable[[Access, int], Site], *, host: str, port: int | None, usual: int) -> Iterator[Site]:
    """A page on which nothing is simulated; the body runs once it is up; then wait for Ctrl-C or SIGTERM."""
    access = access_through(host)
    with ending() as end:
        shown = page(access, free_port(access.host, port, usual))
        try:
            yield shown
            end.asked.wait()
        finally:
            shown.close()


class ServedArms:
    """Brings one arm after the other into a loop: another begins as if the server had been started with it.

    Clients of the network are parted from the robot as from one that is switched off; the next one answers at the same ports, if
    these protocols can tell it. A recording goes on in a file of its own.

    Args:
        loop: that runs, or will.
        recording: of it.
        network: where the robot's network interfaces are to be; None: there are none.
        folder: where set-ups are kept; None: nothing is.
    """

    def __init__(
        self, loop: Loop, recording: LiveRecording, *, network: Network | None = None, folder: Path | None = None
    ) -> None:
        self._loop, self._recording, self._network, self._folder = loop, recording, network, folder
        self._interfaces: RobotInterfaces | None = None
        self._token: str | None = None  # of the control channel: who was told it keeps it, whichever arm is brought
        self._beside: ScriptRunner | None = None  # runs programs without a network

    @property
    def names(self) -> tuple[str, ...]:
        """The shipped arms, then the user's own."""
        return (*robots(), *own_robots())

    def open(self, prepared: Prepared) -> RobotInterfaces | None:
        """Open the network interfaces, where they are wanted. Raises BadInput as `open_interfaces`."""
        if self._network is not None:
            self._interfaces = open_interfaces(self._loop, prepared, self._network, self._recording, token=self._token)
            self._token = self._interfaces.token
        return self._interfaces

    def scripts(self, arm: Arm) -> ScriptRunner | None:
        """What runs programs in URScript: that of the network interfaces, else a new one beside the page."""
        if self._interfaces is not None:
            return self._interfaces.scripts
        self._beside = scripts_beside(self._loop, arm)
        return self._beside

    def close(self) -> None:
        """End the network interfaces, if they are open, and what programs have begun."""
        if self._interfaces is not None:
            self._interfaces.close()
            self._interfaces = None
        if self._beside is not None:
            self._loop.companion = None
            self._beside.close()
            self._beside = None

    def ready(self, name: str, held: Cell | None = None) -> ReadyArm:
        """See `ArmChange`."""
        shipped = prepare(msgspec.structs.replace(FIRST_START, robot=name), "the page")
        keeper = None if self._folder is None else keeper_for(shipped.arm, self._folder)
        prepared, cell = shipped, held
        try:
            if cell is None and keeper is not None:
                cell = keeper.read()
            if cell is not None:
                prepared = check_cell(cell, "kept")
        except BadInput:  # a file that cannot be used stays as it is, and nothing is kept
            keeper = cell = None
        if prepared.arm.n != self._loop.simulation.arm.n:  # else all is compiled
            warm_up(prepared.arm)
        simulate(prepared)
        return ReadyArm(prepared, keeper, cell, meshes_of(prepared.arm))

    def bring(self, arm: ReadyArm) -> BroughtArm:
        """See `ArmChange`."""
        loop, prepared = self._loop, arm.prepared
        told: list[str] = []
        self.close()
        try:
            loop.begin(lambda: simulate(prepared)).result()
        except (Exception, CancelledError) as error:
            allowed = f"an arm that can be simulated: {reason_of(error)}"
            raise BadInput("the page", "arm", prepared.arm.name, allowed) from error
        if self._recording.on:
            told.append("The recording goes on in a file of its own.")
        if self._network is not None:
            try:
                self.open(prepared)
                told.append("Network clients were parted from the last arm and can come again.")
            except BadInput as refusal:
                told.append(f"The network interfaces have ended: {refusal}.")
        return BroughtArm(self._interfaces, self.scripts(prepared.arm), " ".join(told))


def scripts_beside(loop: Loop, arm: Arm) -> ScriptRunner | None:
    """Runs programs in URScript beside the page, without a network; None for an arm that the language does not know."""
    if arm.n != JOINTS:
        return None
    cabinet = Cabinet(
        lambda: loop.simulation,
        arm.chain.joints,
        ProgramFolder(),
        lambda: loop.desk.high,
        between=loop.between_ticks,
        remote=False,
    )
    loop.companion = cabinet
    return ScriptRunner(cabinet)


def _serve(page: Callable[..., Served], *, port: int | None, usual: int) -> Served:
    """The page at `port`; without one at the `usual` port if it is free, else at any."""
    try:
        return page(port=usual if port is None else port)
    except BadInput as taken:
        if port is not None or taken.field != "--port":
            raise
        return page(port=0)
