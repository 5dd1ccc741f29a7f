"""Records a run: copies a tick's numbers on the simulation's thread, and packs, compresses and writes them on one of its own."""

import math
import queue
import threading
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import msgspec
import numpy as np

from app.checked import ABSENT, BadInput
from app.events_file import line_of
from app.library import mesh_path
from app.log import foxglove, layout
from app.log.container import Container
from app.log.layout import CDR, CODES, STATE, TRUTH, WORDS
from app.versions import versions
from pendant.decision import Decision
from pendant.events import Event, Kind
from pendant.modes import Mode, Phase, Safety
from pendant.parameters import PARAMETERS
from pendant.program import ProgramState
from pendant.settings import Settings, describe, digest, limits_checksum, value_of
from pendant.table import TABLE, render
from sim.loop import SNAPSHOT_TICKS
from sim.plant import Plant
from sim.rows import fill_estimate, fill_truth
from sim.scenario import Plane, Scenario
from sim.simulation import Simulation

BLOCK = 125
"""Ticks in a chunk: a quarter of a second."""

AHEAD = 40
"""Blocks that may wait for a slow disk before the simulation waits for it."""

SINGLES = 4
"""Numbers of /state that come one by one: speeds of tcp and elbow, gain, configured mass."""

MODES = {mode: number for number, mode in enumerate(Mode)}
SAFETIES = {safety: number for number, safety in enumerate(Safety)}
PHASES = {phase: number for number, phase in enumerate(Phase)}
PROGRAMS = {state: number for number, state in enumerate(ProgramState)}
AT = {row.text: number for number, row in enumerate(PARAMETERS.values())}


class Picture(NamedTuple):
    """What is drawn of a tick. Poses are (7,): position [m], then quaternion wxyz, in W."""

    tick: int
    decision: Decision
    links: np.ndarray[Any, Any]  # (n + 2, 7)
    objects: np.ndarray[Any, Any]  # (m, 7)
    payload: np.ndarray[Any, Any] | None
    payload_mass: float  # [kg]
    touches: tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[float, ...]], ...]


class Block(NamedTuple):
    """Ticks on their way to the file."""

    ticks: np.ndarray[Any, Any]  # (k,)
    numbers: np.ndarray[Any, Any]  # (k, ...) of /state
    codes: list[tuple[int, ...]]  # of each tick
    singles: list[tuple[float, ...]]  # of each tick: numbers of /state that come one by one
    truth: np.ndarray[Any, Any]  # (k, ...) of /truth
    pictures: list[Picture]
    events: list[tuple[int, Event]]
    settings: list[tuple[int, Settings]]


class Recorder:
    """Writes log.mcap of one simulation. Call `see` after each tick, on the simulation's thread, and `close` at the end.

    Args:
        path: of the file; one that is there is replaced.
        simulation: at its start.
        title: of the session.

    Raises:
        BadInput: the file cannot be written.
    """

    def __init__(self, path: Path, simulation: Simulation, title: str) -> None:
        self.path = path
        self._names = ["foot", *simulation.arm.chain.joints, "flange"]
        self._n = n = simulation.arm.n
        self._file = Container(path, f"pendant {versions()['pendant']}")
        try:
            self._channels = self._declare(simulation, title)
        except OSError as error:
            raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None
        self._state_type = layout.record(layout.width(STATE, n), len(CODES))
        self._truth_type = layout.record(layout.width(TRUTH, n), 0)
        self._vectors = layout.width(STATE, n) - 2 * len(AT) - SINGLES  # numbers that come as arrays
        self._offset = self._last = 0
        self._full = 1  # the first tick goes by itself, so that a log can be shown as soon as it is there
        self._begin()
        self._settings.append((0, simulation.settings))
        self._queue: queue.Queue[Block | None] = queue.Queue(AHEAD)
        self._failure: OSError | None = None
        self._thread = threading.Thread(target=self._write, name="recorder", daemon=True)
        self._thread.start()

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def see(self, simulation: Simulation, decision: Decision) -> None:
        """Record the tick that `simulation` has just done; after a reset its ticks count on."""
        tick = self._offset + simulation.tick_count
        if tick <= self._last:
            self._offset = self._last
            tick = self._offset + simulation.tick_count
        self._last = tick
        k = self._count
        self._ticks[k] = tick
        self._take_state(simulation, decision, self._numbers[k])
        self._take_truth(simulation.plant, self._truth[k])
        if simulation.tick_count % SNAPSHOT_TICKS == 1:
            plant = simulation.plant
            poses = (plant.poses(), plant.object_poses(), plant.payload_pose())
            self._pictures.append(Picture(tick, decision, *poses, plant.load.mass, plant.hands.touched))
        for event in decision.events:
            self._events.append((tick, event))
            if event.kind is Kind.SETTING_CHANGED:
                self._settings.append((tick, simulation.settings))
        self._count = k + 1
        if self._count == self._full:
            self._hand_over()
            self._full = BLOCK

    def close(self) -> None:
        """Write what is left and the end of the file.

        Raises:
            BadInput: the file could not be written; what was written before is whole.
        """
        self._hand_over()
        self._queue.put(None)
        self._thread.join()
        if self._failure is not None:
            raise BadInput(str(self.path), "", ABSENT, f"could not be written to its end ({self._failure.strerror})")

    def _begin(self) -> None:
        n = self._n
        self._count = 0
        self._ticks = np.zeros(BLOCK, dtype=np.uint64)
        self._numbers = np.full((BLOCK, layout.width(STATE, n)), math.nan)
        self._codes: list[tuple[int, ...]] = []
        self._singles: list[tuple[float, ...]] = []
        self._truth = np.zeros((BLOCK, layout.width(TRUTH, n)))
        self._pictures: list[Picture] = []
        self._events: list[tuple[int, Event]] = []
        self._settings: list[tuple[int, Settings]] = []

    def _hand_over(self) -> None:
        k = self._count
        block = Block(
            self._ticks[:k],
            self._numbers[:k],
            self._codes,
            self._singles,
            self._truth[:k],
            self._pictures,
            self._events,
            self._settings,
        )
        if self._failure is None:
            self._queue.put(block)
        self._begin()

    def _take_state(self, simulation: Simulation, decision: Decision, row: np.ndarray) -> None:
        e = simulation.estimate
        k = self._vectors
        fill_estimate(e, row)
        for monitored in decision.monitored:
            at = AT.get(monitored.name)
            if at is not None:
                row[k + SINGLES + at] = monitored.value
                row[k + SINGLES + len(AT) + at] = monitored.limit
        self._singles.append((e.v_tcp, e.v_elbow, decision.gain, simulation.configured.mass))
        valid = e.joints_valid + 2 * e.wrench_valid + 4 * e.acceleration_valid
        states = (MODES[decision.mode], SAFETIES[decision.safety], PHASES[decision.phase], PROGRAMS[decision.program])
        self._codes.append((*states, min(decision.step, 255), valid))

    def _take_truth(self, plant: Plant, row: np.ndarray) -> None:
        fill_truth(plant, row)
        for _, _, force, _ in plant.hands.touched:
            row[-4] += force[0]
            row[-3] += force[1]
            row[-2] += force[2]
        row[-1] = plant.load.mass

    # From here on: the recorder's own thread.

    def _write(self) -> None:
        while (block := self._queue.get()) is not None:
            if self._failure is not None:
                continue
            try:
                self._pack(block)
            except OSError as error:
                self._failure = error
        if self._failure is None:
            try:
                self._file.close()
            except OSError as error:
                self._failure = error

    def _pack(self, block: Block) -> None:
        for tick, settings in block.settings:
            values = {row.name: value_of(settings, row.name) for row in describe()}
            self._say("/settings", tick, {"tick": tick, "values": values})
        for tick, event in block.events:
            self._say("/events", tick, msgspec.to_builtins(line_of(Event(event.kind, tick, event.values))))
            headline, guidance = render(event)
            text = f"{headline} {guidance}".strip()
            self._say("/log", tick, foxglove.line(tick, TABLE[event.kind].severity, text))
        for picture in block.pictures:
            self._draw(picture.tick, picture)
        if block.singles:
            block.numbers[:, self._vectors : self._vectors + SINGLES] = block.singles
        rows = [
            self._records(self._state_type, "/state", block.ticks, block.numbers, block.codes),
            self._records(self._truth_type, "/truth", block.ticks, block.truth, []),
        ]
        self._file.flush(rows)

    def _records(
        self, kind: np.dtype, topic: str, ticks: np.ndarray, numbers: np.ndarray, codes: list[tuple[int, ...]]
    ) -> np.ndarray[Any, Any]:
        """Whole message records, a row a tick."""
        rows = np.zeros(len(ticks), dtype=kind)
        rows["opcode"] = 5
        rows["length"] = kind.itemsize - 9
        rows["channel"] = self._channels[topic]
        rows["sequence"] = ticks
        rows["log_time"] = rows["publish_time"] = ticks * np.uint64(foxglove.NANOSECONDS)
        rows["cdr"] = CDR
        rows["tick"] = ticks
        rows["numbers"] = numbers
        if codes:
            rows["codes"] = codes
        return rows

    def _draw(self, tick: int, picture: Picture) -> None:
        objects = zip(self._objects, picture.objects.tolist(), strict=True)
        frames = [*zip(self._names, picture.links.tolist(), strict=True), *objects]
        payload = None if picture.payload is None else picture.payload.tolist()
        if payload is not None:
            frames.append(("payload", payload))
        self._say("/tf", tick, foxglove.transforms(tick, frames))
        arrows = [foxglove.arrow(point, force) for _, point, force, _ in picture.touches if any(force)]
        entities = [foxglove.entity(tick, "touches", "world", arrows=arrows)]
        if payload is not None:
            radius = (max(picture.payload_mass, 0.05) * 3.0 / (4.0 * math.pi * 1000.0)) ** (1.0 / 3.0)
            entities.append(foxglove.entity(tick, "payload", "payload", spheres=[foxglove.ball(radius)]))
        self._say("/scene", tick, foxglove.update(entities))
        decision = picture.decision
        content = {
            "tick": tick,
            "mode": decision.mode,
            "safety": decision.safety.name,
            "phase": decision.phase,
            "periods": [period._asdict() for period in decision.periods],
            "touches": [
                {"part": part, "point": point, "force": force, "torque": torque} for part, point, force, torque in picture.touches
            ],
        }
        self._say("/pendant", tick, content)

    def _say(self, topic: str, tick: int, content: Any) -> None:
        self._file.add(self._channels[topic], tick * foxglove.NANOSECONDS, msgspec.json.encode(content))

    def _declare(self, simulation: Simulation, title: str) -> dict[str, int]:
        """Channels, and what does not change: arm, scenario, versions; the shapes go into /robot."""
        file, arm, scenario, n = self._file, simulation.arm, simulation.scenario, self._n
        self._objects = [f"object {thing.name}" for thing in scenario.world]
        file.note(
            "run",
            {
                "title": title,
                **versions(),
                "robot": arm.name,
                "seed": str(scenario.seed),
                "settings": digest(simulation.settings),
                "limits": limits_checksum(simulation.settings),
            },
        )
        file.note("words", {name: " ".join(words) for name, words in WORDS.items()})
        file.attach("arm.json", "application/json", msgspec.json.encode(arm))
        file.attach("scenario.json", "application/json", msgspec.json.encode(scenario))
        channels: dict[str, int] = {}
        packed = {"/state": ("pendant/msg/State", STATE, CODES), "/truth": ("pendant/msg/Truth", TRUTH, ())}
        for topic, (name, fields, codes) in packed.items():
            channels[topic] = file.channel(topic, name, layout.schema(fields, n, codes), "cdr", "ros2msg")
        drawn = {"/tf": "FrameTransforms", "/scene": "SceneUpdate", "/robot": "SceneUpdate", "/log": "Log"}
        for topic, name in drawn.items():
            schema = msgspec.json.encode(foxglove.SCHEMAS[f"foxglove.{name}"]).decode()
            channels[topic] = file.channel(topic, f"foxglove.{name}", schema, "json", "jsonschema")
        for topic, name in (("/pendant", "pendant.Pendant"), ("/events", "pendant.Event"), ("/settings", "pendant.Settings")):
            schema = msgspec.json.encode({"title": name, "type": "object"}).decode()
            channels[topic] = file.channel(topic, name, schema, "json", "jsonschema")
        message = msgspec.json.encode(foxglove.update(self._shapes(arm.name, scenario)))
        file.add(channels["/robot"], 0, message)
        return channels

    def _shapes(self, arm: str, scenario: Scenario) -> list[foxglove.Json]:
        """What stands still in its own frame: links and world objects."""
        entities = []
        for part in self._names[:-1]:
            try:
                data = mesh_path(arm, part).read_bytes()
            except BadInput:  # an arm of the user's own has no pictures
                continue
            entities.append(foxglove.entity(0, f"link {part}", part, models=[foxglove.model(data)]))
        for name, thing in zip(self._objects, scenario.world, strict=True):
            size = [3.0, 3.0, 0.002] if isinstance(thing, Plane) else thing.size
            entities.append(foxglove.entity(0, name, name, cubes=[foxglove.box(size)]))
        return entities
