"""The HTTP control channel: what no client of a robot can do, a laboratory can. On this machine alone, and with a token."""

import asyncio
import hmac
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import Future
from http import HTTPStatus
from typing import TypeVar

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import Route

from app.files.bad_input import ABSENT, BadInput
from app.log.live import LiveRecording
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.callers import Ask
from app.robot_interface.controller.rtde_fields import OUTPUTS
from app.robot_interface.faults.channel_messages import WHERE, answer, body, refusal, whole
from app.robot_interface.faults.channel_requests import Asked, CableFault, ClockPace, ConveyorSpeed, Switched, Timed
from app.robot_interface.faults.served_loop import ServedLoop
from app.robot_interface.transport.peers import Peers
from app.robot_interface.transport.tcp_port import TcpPort
from app.runs.runner import simulate
from app.session.prepare import prepare
from app.session.session_file import AllowedFiles, Setup, located
from app.session.timeline_checks import Prepared, check_actions
from pendant.event_table import render
from pendant.inputs import Command
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.run.troubles import reason_of

LONGEST = 20.0
"""Time that a request may take, with all that its client has to say [s]."""

PATIENCE = 10.0
"""Time in which the loop must have done what a request asks of it [s]."""

T = TypeVar("T")
Handler = Callable[[Request], Awaitable[object]]


class ControlChannel:
    """Answers the requests; an ASGI application.

    Args:
        loop: that runs.
        cabinet: the robot.
        peers: who is connected.
        ports: by the name of their interface.
        recording: of the loop.
        token: that every request must bring.
        hosts: names and addresses, with port, that a request may call this machine.
        files: that a set-up may name.
    """

    def __init__(
        self,
        loop: ServedLoop,
        cabinet: Cabinet,
        peers: Peers,
        ports: Mapping[str, TcpPort],
        *,
        recording: LiveRecording,
        token: str,
        hosts: frozenset[str],
        files: AllowedFiles,
    ) -> None:
        self._loop, self._cabinet, self._peers, self._ports = loop, cabinet, peers, ports
        self._recording, self._token, self._hosts, self._files = recording, token, hosts, files
        get = {"state": self._state, "events": self._events, "connections": self._connections, "messages": self._messages}
        post: dict[str, Handler] = {
            "actions": self._act,
            "network": self._network,
            "pace": self._pace,
            "begin": self._begin,
            "restart": self._restart,
            "remote": self._remote,
            "free-drive": self._free_drive,
            "recording": self._record,
            "conveyor": self._turn,
        }
        routes = [Route(f"/{name}", self._guarded(handler), methods=["GET"]) for name, handler in get.items()]
        routes += [Route(f"/{name}", self._guarded(handler), methods=["POST"]) for name, handler in post.items()]
        routes.append(Route("/field/{name}", self._guarded(self._field), methods=["GET"]))
        self.app = Starlette(routes=routes, exception_handlers={HTTPException: _nothing})

    def _guarded(self, handler: Handler) -> Callable[[Request], Awaitable[Response]]:
        async def answered(request: Request) -> Response:
            why_not = self._why_not(request)
            if why_not is not None:
                return refusal(*why_not)
            try:
                return answer(await asyncio.wait_for(handler(request), LONGEST))
            except BadInput as error:
                return refusal(HTTPStatus.BAD_REQUEST, str(error))
            except ClientDisconnect:
                return refusal(HTTPStatus.BAD_REQUEST, f"{WHERE}: the client left")
            except asyncio.CancelledError:  # raised further it would be printed, though nothing is wrong
                return refusal(HTTPStatus.SERVICE_UNAVAILABLE, f"{WHERE}: the robot ends")
            except TimeoutError:
                return refusal(HTTPStatus.REQUEST_TIMEOUT, f"{WHERE}: a request that takes more than {LONGEST:g} s")
            except Exception as error:  # noqa: BLE001 - of this request alone
                self._loop.troubles.failed("a request of the control channel", error)
                return refusal(HTTPStatus.INTERNAL_SERVER_ERROR, f"{WHERE}: {reason_of(error)}")

        return answered

    def _why_not(self, request: Request) -> tuple[HTTPStatus, str] | None:
        """Why a request is turned away: what a page of somebody else sends, and what has no token."""
        host = request.headers.get("host", "").lower()
        if host not in self._hosts:
            return HTTPStatus.FORBIDDEN, "Host: another machine's name"
        origins = request.headers.getlist("origin")
        if origins and origins != [f"http://{host}"]:
            return HTTPStatus.FORBIDDEN, "Origin: a page of somebody else"
        brought = request.headers.get("authorization", "").removeprefix("Bearer ")
        if not hmac.compare_digest(brought.encode(), self._token.encode()):
            return HTTPStatus.UNAUTHORIZED, "Authorization: expected Bearer and the token"
        return None

    async def _state(self, _: Request) -> object:
        state, recording = self._cabinet.state, self._recording
        return {
            "tick": state.tick,
            "time": state.tick * TICK,
            "mode": state.mode,
            "safety": state.safety.name,
            "phase": state.phase,
            "robot_mode": state.robot_mode.name,
            "safety_mode": state.safety_mode.name,
            "runtime_state": state.runtime.name,
            "remote": state.remote,
            "program": state.program,
            "popup": state.popup,
            "question": "" if state.question is None else state.question.text,
            "refusal": state.refusal,
            "failure": self._loop.failure,
            "broken": self._loop.troubles.now(),
            "recording": str(recording.path) if recording.on and recording.path is not None else None,
            "recording_failure": recording.failure,
        }

    async def _events(self, request: Request) -> object:
        after = whole(request, "after")
        return [
            {
                "number": number,
                "tick": event.tick,
                "kind": event.kind,
                "values": event.values,
                "text": " ".join(render(event)).strip(),
            }
            for number, event in enumerate(self._loop.events(after), after + 1)
        ]

    async def _connections(self, _: Request) -> object:
        return [
            {
                "number": peer.number,
                "interface": peer.interface,
                "address": peer.address,
                "about": peer.about,
                "sent": peer.outbox.sent,
            }
            for peer in self._peers.all()
        ]

    async def _messages(self, request: Request) -> object:
        return [
            {"number": said.number, "interface": said.interface, "peer": said.peer, "text": said.text}
            for said in self._peers.said(whole(request, "after"))
        ]

    async def _field(self, request: Request) -> object:
        name = request.path_params["name"]
        if name not in OUTPUTS:
            raise BadInput(WHERE, "field", name, "an output field of RTDE, such as actual_q")
        (value,) = await self._in_time(self._cabinet.look(name))
        return value

    async def _act(self, request: Request) -> object:
        wanted = await body(request, Timed)
        loop = self._loop
        check_actions(wanted.actions, Prepared(loop.simulation.arm, loop.scenario, loop.settings, None, WHERE))
        begun = self._cabinet.act(wanted.actions)
        if loop.paused or loop.failure:  # no tick comes before somebody asks for one
            return {"after": self._cabinet.state.tick}
        return {"after": await self._in_time(begun)}

    async def _network(self, request: Request) -> object:
        wanted = await body(request, CableFault)
        if wanted.interface != "all" and wanted.interface not in self._ports:
            raise BadInput(WHERE, "interface", wanted.interface, f"one of all, {', '.join(self._ports)}")
        for name, port in self._ports.items():
            if wanted.interface in ("all", name):
                if wanted.delay is not None:
                    port.delay = wanted.delay
                if wanted.cut is not None:
                    port.cut(wanted.cut)
        return {}

    async def _turn(self, request: Request) -> object:
        wanted = await body(request, ConveyorSpeed)
        await self._in_time(self._cabinet.turn_conveyor(wanted.encoder, wanted.ticks_per_second))
        return {}

    async def _pace(self, request: Request) -> object:
        wanted, loop = await body(request, ClockPace), self._loop
        if wanted.speed is not None:
            loop.speed = wanted.speed
        if wanted.paused is not None:
            loop.paused = wanted.paused
        for _ in range(wanted.ticks):
            loop.step_once()
        return {"speed": loop.speed, "paused": loop.paused}

    async def _begin(self, request: Request) -> object:
        setup = located(await body(request, Setup), self._files, WHERE)
        prepared = await asyncio.to_thread(prepare, setup, WHERE)
        if prepared.arm.name != self._loop.simulation.arm.name:
            raise BadInput(
                WHERE, "robot", prepared.arm.name, f"{self._loop.simulation.arm.name}: another arm needs another start"
            )
        simulation = await asyncio.to_thread(simulate, prepared)
        made = [simulation]
        await self._in_time(self._loop.begin(lambda: made.pop() if made else simulate(prepared)))
        return {"tick": self._cabinet.state.tick}

    async def _restart(self, _: Request) -> object:
        await self._in_time(self._loop.reset())
        return {"tick": self._cabinet.state.tick}

    async def _in_time(self, asked: "Future[T]") -> T:
        """What the loop gives. Raises BadInput: it fails, is given up, or does not come in time, and is withdrawn then."""
        waiting = asyncio.wrap_future(asked)
        done, _ = await asyncio.wait((waiting,), timeout=PATIENCE)
        if not done or waiting.cancelled():
            waiting.cancel()
            why = "another start, or the end, came between" if done else f"the robot did not come to it in {PATIENCE:g} s"
            raise BadInput(WHERE, "", ABSENT, why)
        try:
            return waiting.result()
        except BadInput:
            raise
        except Exception as error:
            raise BadInput(WHERE, "", ABSENT, f"it failed: {reason_of(error)}") from error

    async def _remote(self, request: Request) -> object:
        wanted = await body(request, Switched)
        self._cabinet.ask(Ask((Command.REMOTE if wanted.on else Command.TEACH,)))
        return {}

    async def _free_drive(self, request: Request) -> object:
        wanted = await body(request, Asked)
        self._cabinet.free_drive_until = self._cabinet.ticks + ticks(wanted.seconds) if wanted.seconds else 0
        return {}

    async def _record(self, request: Request) -> object:
        wanted, recording = await body(request, Switched), self._recording
        if wanted.on:
            await self._in_time(recording.start())
        else:
            await asyncio.to_thread(recording.close)
        return {"path": None if recording.path is None else str(recording.path), "failure": recording.failure}


async def _nothing(_: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else HTTPStatus.NOT_FOUND
    return refusal(HTTPStatus(status), f"{WHERE}: no such request; docs/reference/control-channel.md lists all")
