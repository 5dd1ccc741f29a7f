"""What is fuzzed: every way in for files and messages. A target ends, or raises BadInput; all else is a defect."""

import functools
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import yaml
from hypothesis import strategies as st

from app.files.bodies import check_tools
from app.files.checked import BadInput, load, parse
from app.files.library import ASSETS, load_arm, load_tool, robots, tools
from app.files.taught_program import Lesson, program
from app.log.events_file import read as read_events
from app.log.recorder import Recorder
from app.log_reading.playback import Player, snapshot_at
from app.log_reading.reader import read
from app.mcap_file.mending import repair
from app.report.gathering import Gathered
from app.report.summary import summarise
from app.runs.runner import BROKEN, MOMENT, simulate, try_out, try_tool
from app.session.actions import AnyAction
from app.session.prepare import Prepared, prepare
from app.session.session_file import Session, Setup, bundled, folder, opened
from app.session.timeline import Timeline
from app.web.access.messages import Admitted, decode, encode
from app.web.tabs.tool_editor import Table
from pendant.all_settings import Settings, apply, describe
from pendant.program.steps import misfit
from pendant.settings.schema import SettingError
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario, ToolModel
from tools.fuzz.recordings import rewritten
from tools.fuzz.values import edited, values

ARM = load_arm("ur5e")


class Target(NamedTuple):
    """One way in."""

    name: str
    suffix: str
    run: Callable[[Path], None]  # with a file that was written; raises BadInput for what it refuses
    structured: st.SearchStrategy[bytes]  # what fits the types
    seeds: list[bytes]  # whole files, whose bytes are damaged


def acted(prepared: Prepared, actions: Sequence[AnyAction]) -> None:
    """Two hundred ticks in which a time line acts; it may ask for more than the physics bears, which is said in a line."""
    simulation = simulate(prepared)
    timeline = Timeline(list(actions), prepared.arm.chain.joints, prepared.program)
    for tick in range(1, MOMENT + 1):
        try:
            decision = simulation.tick(timeline.wishes(tick, simulation.snapshot))
        except BROKEN:
            return
        timeline.see(tick, decision)


def _session(path: Path) -> None:
    session = opened(path, Session)
    prepared = prepare(session, path.name)
    try_out(prepared)
    acted(prepared, session.timeline)


def _setup(path: Path) -> None:
    try_out(prepare(opened(path, Setup), path.name))


def _arm(path: Path) -> None:
    load_arm(path)
    try_out(prepare(Setup(robot=str(path)), path.name))


def _tool(path: Path) -> None:
    tool = load_tool(path)
    check_tools([tool], ARM, path.name)
    try_out(Prepared(ARM, Scenario(tool=tool), Settings(), None, path.name))


def _table(path: Path) -> None:
    found = parse(path.read_bytes().decode("utf-8", "replace"), Table, path.name).tools
    check_tools(found, ARM, path.name, most=1.0)
    for tool in found[:2]:
        try_tool(ARM, tool, path.name)


def _lesson(path: Path) -> None:
    lesson = parse(path.read_bytes().decode("utf-8", "replace"), Lesson, path.name)
    if lesson.plan:
        misfit(program(lesson, lesson.plan, lesson.repeat), ARM.n)


def _settings(path: Path) -> None:
    changes = parse(path.read_bytes().decode("utf-8", "replace"), dict[str, float | bool | str], path.name)
    try:
        apply(Settings(), dict(changes))
    except SettingError:
        return


def _message(path: Path) -> None:
    message = decode(path.read_bytes())
    if message is not None:
        encode(message)


def _recording(path: Path) -> None:
    log = read(path)
    summarise(Gathered(log))
    if log.pictures and len(log.ticks):
        player = Player(log)
        for time in (0.0, player.end / 2.0, player.end):
            player.jump(time)
            snapshot_at(log, player.picture, player.row)
    if not log.whole:
        assert log.missing, "a recording that was cut does not say so"
        repair(path)
        assert read(path).missing, "a recording that was mended does not say so"


def _events(path: Path) -> None:
    read_events(path)


@functools.cache
def recording() -> bytes:
    """A second of a session in which much happens, recorded."""
    session = opened(folder("sessions") / "payload-dropped.yaml", Session) if "payload-dropped" in bundled("sessions") else None
    session = session or opened(folder("sessions") / f"{bundled('sessions')[0]}.yaml", Session)
    prepared = prepare(session, "s")
    simulation, timeline = simulate(prepared), Timeline(session.timeline, prepared.arm.chain.joints, prepared.program)
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "log.mcap"
        with Recorder(path, simulation, "t", planned=1.0) as recorder:
            for tick in range(1, 501):
                decision = simulation.tick(timeline.wishes(tick, simulation.snapshot))
                timeline.see(tick, decision)
                recorder.see(simulation, decision)
        return path.read_bytes()


def _json(strategy: st.SearchStrategy[Any]) -> st.SearchStrategy[bytes]:
    return strategy.map(msgspec.json.encode)


def _changed(files: list[Path], kind: Any) -> st.SearchStrategy[bytes]:
    """Whole files with some places filled anew; and now and then one that is made up from the type alone."""
    raws = [load(path, dict[str, Any]) for path in files]
    return _json(st.one_of(st.sampled_from(raws).flatmap(lambda raw: edited(raw, kind)), values(kind)))


def targets() -> list[Target]:
    """All of them."""
    sessions = [folder("sessions") / f"{name}.yaml" for name in bundled("sessions")]
    arms = [ASSETS / "robots" / f"{name}.yaml" for name in robots()]
    shipped = [ASSETS / "tools" / f"{name}.yaml" for name in tools()]
    table = [{"tools": [load(path, dict[str, Any]) for path in shipped]}]
    taught = {"waypoints": [{"name": "P1", "q": [0.0] * 6, "position": [0.3, 0.0, 0.4], "quaternion": [1.0, 0.0, 0.0, 0.0]}]}
    taught["steps"] = [{"do": "line", "to": "P1"}, {"do": "wait"}]
    names = st.sampled_from([row.name for row in describe()])
    changes = st.dictionaries(names, values(float | bool | str), min_size=1, max_size=5)
    message = values(Admitted).map(msgspec.msgpack.encode)
    log = recording()
    lines = b'{"tick":1,"t":0.002,"kind":"reset","severity":"INFO","headline":"a","guidance":"b","values":{"x":1.0}}\n' * 5
    setup = [{"robot": "ur3e", "tool": "parallel-gripper", "mounting": "wall", "payload_true": {"mass": 1.0}, "seed": 3}]
    setup[0]["tool"] = tools()[0]

    def said(raw: Any) -> bytes:
        return yaml.safe_dump(raw, sort_keys=False).encode()

    return [
        Target("session", ".yaml", _session, _changed(sessions, Session), [path.read_bytes() for path in sessions]),
        Target("configuration", ".yaml", _setup, _json(edited(setup[0], Setup)), [said(setup[0])]),
        Target("arm", ".yaml", _arm, _changed(arms, Arm), [path.read_bytes() for path in arms]),
        Target("tool", ".yaml", _tool, _changed(shipped, ToolModel), [path.read_bytes() for path in shipped]),
        Target("table of tools", ".yaml", _table, _json(edited(table[0], Table)), [said(table[0])]),
        Target("taught program", ".yaml", _lesson, _json(edited(taught, Lesson)), [said(taught)]),
        Target("settings", ".yaml", _settings, _json(changes), [said({"free_drive.period": 3.0, "sequence.on": True})]),
        Target("message", ".bin", _message, message, [msgspec.msgpack.encode({"type": "CommandTriggerMessage", "uuid": "x"})]),
        Target("recording", ".mcap", _recording, rewritten(log), [log]),
        Target("events", ".jsonl", _events, st.just(lines), [lines]),
    ]


REFUSED = BadInput
"""What a target may raise."""
