"""All network interfaces of one robot, on a thread of their own."""

import asyncio
import functools
import ipaddress
import logging
import secrets
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from app.files.bad_input import BadInput
from app.log.live import LiveRecording
from app.robot_interface.client_ports.client_session import PrimarySession, RealtimeSession, StreamSession, Talking
from app.robot_interface.client_ports.primary_packages import RobotState
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.program_folder import ProgramFolder
from app.robot_interface.dashboard.dashboard_commands import DashboardCommands
from app.robot_interface.dashboard.dashboard_session import DashboardSession
from app.robot_interface.gripper.gripper_session import GripperSession
from app.robot_interface.ports import CONTROL, DASHBOARD, GRIPPER, PORTS, PRIMARY, READ_ONLY, REALTIME, RTDE, SECONDARY
from app.robot_interface.rtde.rtde_inputs import RtdeInputs
from app.robot_interface.rtde.rtde_session import RtdeSession
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peer, Peers
from app.robot_interface.transport.tcp_port import Conversation, TcpPort
from app.session.session_file import SHIPPED_ALONE, AllowedFiles
from app.urscript.running.script_runner import ScriptRunner
from sim.arm.arm_file import Arm
from sim.run.loop import Loop

JOINTS = 6
"""Of every arm that these protocols can tell."""

PARTING = 1.0
"""Time in which all connections must have ended [s]."""

HEARTBEAT = 0.1
"""While nothing is simulated, the last packages are sent again with this period [s]: after 2.5 s of silence clients leave."""


class RobotInterfaces:
    """Serves the robot of a loop.

    Args:
        loop: that runs, or will.
        arm: in it.
        host: address to listen on.
        offset: added to all ports.
        programs: folder of programs that clients can load, beside the bundled ones.
        token: of the control channel; None for a new one.
        recording: the switch of recordings; None for one of its own, into the working folder.
        files: that a set-up of the control channel may name.

    Raises:
        BadInput: a port is taken, or the arm has not six joints.
    """

    def __init__(
        self,
        loop: Loop,
        arm: Arm,
        *,
        host: str,
        offset: int = 0,
        programs: Path | None = None,
        token: str | None = None,
        recording: LiveRecording | None = None,
        files: AllowedFiles = SHIPPED_ALONE,
    ) -> None:
        # Here, for a page without a network does without the extra that has them.
        import uvicorn

        from app.robot_interface.faults.control_channel import ControlChannel
        from app.robot_interface.faults.timed_http import TimedHttp

        if arm.n != JOINTS or arm.chain.origins:
            allowed = f"an arm of {JOINTS} joints with Denavit-Hartenberg parameters: these protocols know no other"
            raise BadInput("--interfaces", "robot", arm.name, allowed)
        self.host, self.ports = host, {name: number + offset for name, number in PORTS.items()}
        self.token = token or secrets.token_urlsafe(16)
        self.peers = Peers()
        self.cabinet = Cabinet(
            lambda: loop.simulation,
            arm.chain.joints,
            ProgramFolder(programs),
            lambda: loop.desk.high,
            between=loop.between_ticks,
        )
        self.scripts = ScriptRunner(self.cabinet)
        self._loop = loop
        self._sockets = {name: _listening(host, number) for name, number in self.ports.items()}
        self._tcp = self._conversations(arm)
        hosts = frozenset(f"{name}:{self.ports[CONTROL]}" for name in (host.lower(), "localhost", "127.0.0.1"))
        channel = ControlChannel(
            loop,
            self.cabinet,
            self.peers,
            self._tcp,
            recording=recording or LiveRecording(loop, Path()),
            token=self.token,
            hosts=hosts,
            files=files,
        )
        logging.getLogger("uvicorn.error").setLevel(logging.ERROR)  # what strangers send is no news
        config = uvicorn.Config(
            channel.app,
            http=functools.partial(TimedHttp, waiting={}),  # type: ignore[arg-type]
            log_config=None,
            access_log=False,
            server_header=False,
            timeout_keep_alive=10,
            ws="none",
            lifespan="off",
        )
        self._http = uvicorn.Server(config)
        self._ended = asyncio.Event()
        self._network: asyncio.AbstractEventLoop | None = None
        self._thread = threading.Thread(target=self._run, name="network", daemon=True)

    @property
    def on_a_network(self) -> bool:
        """Others than this machine reach it."""
        return self.host != "localhost" and not ipaddress.ip_address(self.host).is_loopback

    def start(self) -> None:
        """Begin to answer; the loop's next tick is the first that is told."""
        self._loop.companion = self.cabinet
        self._loop.log.listen(self.cabinet.note)
        self._thread.start()

    def close(self) -> None:
        """End scripts and all connections; requests that are still done are left to themselves."""
        self._loop.companion = None
        self._loop.log.forget(self.cabinet.note)
        self.scripts.close()
        if self._network is not None:
            with suppress(RuntimeError):  # it has ended already
                self._network.call_soon_threadsafe(self._ended.set)
            self._thread.join(PARTING)

    def _conversations(self, arm: Arm) -> dict[str, TcpPort]:
        """What is said on each port."""
        cabinet, peers = self.cabinet, self.peers
        commands = DashboardCommands(cabinet, arm.name.upper().removesuffix("E"))
        inputs, state = RtdeInputs(cabinet), RobotState(cabinet, arm)
        talking = Talking(cabinet, commands, peers, self.scripts)

        def dashboard(peer: Peer, outbox: Outbox) -> Conversation:
            return DashboardSession(cabinet, commands, peers, peer, outbox=outbox)

        def rtde(peer: Peer, outbox: Outbox) -> Conversation:
            return RtdeSession(cabinet, inputs, peers, peer, outbox=outbox)

        def stream(messages: bool, writable: bool) -> Callable[[Peer, Outbox], StreamSession]:
            def open_(peer: Peer, outbox: Outbox) -> StreamSession:
                return PrimarySession(talking, peer, outbox=outbox, writable=writable, state=state, messages=messages)

            return open_

        def realtime(writable: bool) -> Callable[[Peer, Outbox], StreamSession]:
            return lambda peer, outbox: RealtimeSession(talking, peer, outbox=outbox, writable=writable)

        def gripper(peer: Peer, outbox: Outbox) -> Conversation:
            return GripperSession(self.scripts.gripper, peers, peer, outbox)

        opened: dict[str, Callable[[Peer, Outbox], Conversation]] = {DASHBOARD: dashboard, RTDE: rtde, GRIPPER: gripper}
        for name, writable in (("", True), (READ_ONLY, False)):
            opened[PRIMARY + name] = stream(True, writable)
            opened[SECONDARY + name] = stream(False, writable)
            opened[REALTIME + name] = realtime(writable)
        return {name: TcpPort(name, peers, open_, self._loop.troubles) for name, open_ in opened.items()}

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except Exception as error:  # noqa: BLE001
            self._loop.troubles.failed("the network", error, for_good=True)

    async def _serve(self) -> None:
        self._network = asyncio.get_running_loop()
        tasks = [asyncio.create_task(port.listen(self._sockets[name])) for name, port in self._tcp.items()]
        tasks.append(asyncio.create_task(self._keep_alive()))
        http = asyncio.create_task(self._http.serve(sockets=[self._sockets[CONTROL]]))
        for task, name in zip((*tasks, http), (*self._tcp, "what keeps clients waiting", CONTROL), strict=True):
            task.add_done_callback(functools.partial(self._ended_early, name))
        await self._ended.wait()
        self._http.should_exit = self._http.force_exit = True
        for task in tasks:
            task.cancel()
        for task in (*tasks, http):
            with suppress(asyncio.CancelledError):
                await task

    def _ended_early(self, name: str, task: asyncio.Task[None]) -> None:
        """A task that serves is over: a robot whose port is dead must not look as if it answered."""
        if not task.cancelled() and (error := task.exception()) is not None:
            self._loop.troubles.failed(f"the network interface {name}", error, for_good=True)

    async def _keep_alive(self) -> None:
        last, asked = -1, None
        while True:
            await asyncio.sleep(HEARTBEAT)
            if self.cabinet.ticks == last:
                if asked is None or asked.done():
                    asked = self._loop.between_ticks(self.cabinet.repeat)
                else:  # it has not come to the last one
                    self.cabinet.again()
            last = self.cabinet.ticks


def _listening(host: str, number: int) -> socket.socket:
    listening = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listening.setblocking(False)
    try:
        listening.bind((host, number))
        listening.listen(16)
    except OSError as error:
        listening.close()
        raise BadInput(
            "--interfaces", "port", number, f"a port that is free at {host}; --port-offset moves all ({error.strerror})"
        ) from None
    return listening
