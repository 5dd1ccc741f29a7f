"""Packs the blocks of a recording into messages and puts them into the file."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np

from app.files.checked import ABSENT, BadInput
from app.files.library import mesh_path
from app.files.versions import versions
from app.log import foxglove, layout
from app.log.events_file import line_of
from app.log.layout import CDR, CODES, STATE, TRUTH, WORDS
from app.mcap_file.container import Container
from pendant.all_settings import Settings, describe, digest, safety_checksum, value_of
from pendant.decision import Decision
from pendant.event_table import TABLE, render
from pendant.events.event import Event
from sim.arm.arm_file import Arm
from sim.arm.scenario import FreeCylinder, Plane, Scenario
from sim.exchange.told_force import UncertainForce
from sim.gripping.finger_drive import GripperState
from sim.simulation import Simulation

PICTURES, TOLD = "pictures", "told"
"""Topics that share their chunks: what is drawn, and what happens now and then. /state and /truth have chunks of their own."""


class Picture(NamedTuple):
    """What is drawn of a tick. Poses are (7,): position [m], then quaternion wxyz, in W."""

    tick: int
    decision: Decision
    links: np.ndarray[Any, Any]  # (n + 2, 7)
    objects: np.ndarray[Any, Any]  # (m, 7)
    payload: np.ndarray[Any, Any] | None
    payload_mass: float  # [kg]
    touches: tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[float, ...]], ...]
    user: UncertainForce | None  # what free-drive takes for the user's force
    gripper: GripperState | None  # None: the tool has none


class TickRows(NamedTuple):
    """Of /state or /truth."""

    ticks: np.ndarray[Any, Any]  # (k,)
    numbers: np.ndarray[Any, Any]  # (k, ...)


class Block(NamedTuple):
    """Ticks on their way to the file."""

    state: TickRows
    codes: list[tuple[int, ...]]  # of each tick of /state
    truth: TickRows
    pictures: list[Picture]
    events: list[tuple[int, Event]]
    settings: list[tuple[int, Settings]]


def _rows(matrix: np.ndarray[Any, Any] | None) -> list[list[float]] | None:
    return None if matrix is None else matrix.tolist()


class Writer:
    """The file of one recording.

    Args:
        path: of the file; one that is there is replaced.
        simulation: what is recorded.
        title: of the session.
        notes: that go with title and versions: planned, how long it is to last [s]; recording and part, of one in parts.
        thinned: topics that have not every message, with the ticks from one to the next.

    Raises:
        BadInput: the file cannot be written.
    """

    def __init__(
        self, path: Path, simulation: Simulation, title: str, *, notes: Mapping[str, str], thinned: Mapping[str, int]
    ) -> None:
        self._names = ["foot", *simulation.arm.chain.joints, "flange"]
        self._n = n = simulation.arm.n
        self._file = Container(path, f"pendant {versions()['pendant']}")
        try:
            self._channels = self._declare(simulation, title, notes, thinned)
        except OSError as error:
            self._file.abandon()
            raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None
        self._state_type = layout.record(layout.width(STATE, n), len(CODES))
        self._truth_type = layout.record(layout.width(TRUTH, n), 0)

    @property
    def end(self) -> int:
        """Room that the file's end will take [bytes], about."""
        return self._file.end

    def close(self) -> None:
        """Write the end of the file. Raises OSError: the disk is full or gone."""
        self._file.close()

    def abandon(self) -> None:
        """Nothing more can be written: end the file where it is whole."""
        self._file.abandon()

    def pack(self, block: Block) -> None:
        """Write a block, as one chunk. Raises OSError: the disk is full or gone."""
        if self._shapes_told is not None and len(block.state.ticks):
            self._file.add(self._channels["/robot"], (int(block.state.ticks[0]) - 1) * foxglove.NANOSECONDS, self._shapes_told)
            self._shapes_told = None
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
        rows = [
            self._records(self._state_type, "/state", block.state, block.codes),
            self._records(self._truth_type, "/truth", block.truth, []),
        ]
        self._file.flush(rows)

    def _records(self, kind: np.dtype, topic: str, told: TickRows, codes: list[tuple[int, ...]]) -> np.ndarray[Any, Any]:
        """Whole message records, a row a tick."""
        ticks = told.ticks
        rows = np.zeros(len(ticks), dtype=kind)
        rows["opcode"] = 5
        rows["length"] = kind.itemsize - 9
        rows["channel"] = self._channels[topic]
        rows["sequence"] = ticks
        rows["log_time"] = rows["publish_time"] = ticks * np.uint64(foxglove.NANOSECONDS)
        rows["cdr"] = CDR
        rows["tick"] = ticks
        rows["numbers"] = told.numbers
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
        decision, user = picture.decision, picture.user
        content = {
            "tick": tick,
            "mode": decision.mode,
            "safety": decision.safety.name,
            "phase": decision.phase,
            "periods": [msgspec.structs.asdict(period) for period in decision.periods],
            "touches": [
                {"part": part, "point": point, "force": force, "torque": torque} for part, point, force, torque in picture.touches
            ],
            "user": None if user is None else {"force": user.force, "covariance": _rows(user.covariance), "at": user.at},
            "gripper": None if picture.gripper is None else picture.gripper._asdict(),
        }
        self._say("/pendant", tick, content)

    def _say(self, topic: str, tick: int, content: Any) -> None:
        self._file.add(self._channels[topic], tick * foxglove.NANOSECONDS, msgspec.json.encode(content))

    def _declare(
        self, simulation: Simulation, title: str, notes: Mapping[str, str], thinned: Mapping[str, int]
    ) -> dict[str, int]:
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
                "limits": safety_checksum(simulation.settings),
                **notes,
            },
        )
        if thinned:
            file.note("rates", {topic: str(ticks) for topic, ticks in thinned.items()})
        file.note("words", {name: " ".join(words) for name, words in WORDS.items()})
        said = msgspec.to_builtins(arm)
        del said["meshes"]  # a folder of this machine
        file.attach("arm.json", "application/json", msgspec.json.encode(said))
        file.attach("scenario.json", "application/json", msgspec.json.encode(scenario))
        channels: dict[str, int] = {}
        packed = {"/state": ("pendant/msg/State", STATE, CODES), "/truth": ("pendant/msg/Truth", TRUTH, ())}
        for topic, (name, fields, codes) in packed.items():
            text = layout.schema(fields, n, codes)
            channels[topic] = file.channel(topic, name, text, encoding="cdr", of_schema="ros2msg", together=topic)
        drawn = {"/tf": "FrameTransforms", "/scene": "SceneUpdate", "/robot": "SceneUpdate", "/log": "Log"}
        for topic, name in drawn.items():
            schema = msgspec.json.encode(foxglove.SCHEMAS[f"foxglove.{name}"]).decode()
            together = PICTURES if topic in ("/tf", "/scene") else TOLD
            channels[topic] = file.channel(
                topic, f"foxglove.{name}", schema, encoding="json", of_schema="jsonschema", together=together
            )
        for topic, name in (("/pendant", "pendant.Pendant"), ("/events", "pendant.Event"), ("/settings", "pendant.Settings")):
            schema = msgspec.json.encode({"title": name, "type": "object"}).decode()
            together = PICTURES if topic == "/pendant" else TOLD
            channels[topic] = file.channel(topic, name, schema, encoding="json", of_schema="jsonschema", together=together)
        self._shapes_told: bytes | None = msgspec.json.encode(foxglove.update(self._shapes(arm, scenario)))
        return channels

    def _shapes(self, arm: Arm, scenario: Scenario) -> list[foxglove.Json]:
        """What stands still in its own frame: links and world objects."""
        entities = []
        for part in self._names[:-1]:
            try:
                data = mesh_path(arm, part).read_bytes()
            except BadInput:  # an arm of the user's own has no pictures
                continue
            entities.append(foxglove.entity(0, f"link {part}", part, models=[foxglove.model(data)]))
        for name, thing in zip(self._objects, scenario.world, strict=True):
            if isinstance(thing, FreeCylinder):
                entities.append(foxglove.entity(0, name, name, cylinders=[foxglove.cylinder(thing.size)]))
                continue
            size = [3.0, 3.0, 0.002] if isinstance(thing, Plane) else thing.size
            entities.append(foxglove.entity(0, name, name, cubes=[foxglove.box(size)]))
        return entities
