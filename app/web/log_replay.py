"""The web app showing a log of a real arm: the arm as it was measured, the model's arm beside it, and the torques of both."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from viser import uplot

from app.log.events_file import EventLine
from app.log_reading.playback import Playback
from app.real_logs.against import Against
from app.real_logs.against_page import sentences
from app.real_logs.log_controller import LogNotice
from app.web.access.listening import Access
from app.web.access.site import Site
from app.web.panel.state_words import SEVERITY_COLOURS
from app.web.recordings.event_marks import moment
from app.web.recordings.time_line import TimeLine
from app.web.scene.arm_picture import Scene
from app.web.scene.moving_ghost import MovingGhost
from app.web.widgets import style, svg
from app.web.widgets.drawn_parts import DrawnParts
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.events.event_row import Severity
from pendant.tick.modes import TICK_RATE
from sim.arm.frames import joint_frames, matrix_from_quaternion, quaternion_from_matrix, transform
from sim.exchange.snapshot import Snapshot
from sim.identification.model_drift import HORIZON
from sim.run.troubles import Troubles

Array = NDArray[np.float64]

WINDOW = 10.0
"""Of the log that the plots show, round the time [s]."""
POINTS = 500
"""Of a plot's line, at most."""
FRAMES_A_PLOT = 6
"""The plots follow the time with every so many pictures."""
MOST_TOLD = 1000
"""Rows of what would have been told, the first ones; contacts.csv has all."""
MEASURED, PREDICTED, EXTERNAL, NOW = "#1971c2", "#e8590c", "#868e96", "#c92a2a"
ORANGE = (232, 89, 12)
GREY = (134, 142, 150)
SECONDS = {"x": uplot.Scale(time=False)}


@dataclass(slots=True)
class LogPlayback(Playback):
    """Where in a log we are."""

    last: float  # time of its last row [s]

    @property
    def end(self) -> float:
        """The last time."""
        return self.last


class LogReplay(Site):
    """A web app that shows what became of one log.

    Args:
        found: the log, held against the controller.
        first: a picture of the arm as it begins, with its tool, its load and what stands about.
        meshes: a GLB file for each part that has a shape; none: the arm is drawn by its limbs.
        access: where to listen, and for whom.
        port: 0 for any free one.
    """

    def __init__(self, found: Against, first: Snapshot, *, meshes: Mapping[str, bytes], access: Access, port: int) -> None:
        super().__init__(access, port, Troubles(lambda kind, values: None))
        assert first.scenario is not None
        table, n = found.table, found.arm.n
        self._found, self._first = found, first
        self._t, self._q, self._model_q = table[:, 0], table[:, 1 : n + 1], table[:, 1 : n + 1] + found.drift
        self._torques = table[:, 1 + n :].reshape(len(table), -1)
        self.moment = LogPlayback(float(self._t[-1]))
        self._before, self._frame = time.monotonic(), 0
        self._load: Array | None = None  # pose of the load's centre in F, position and matrix (4, 4)
        if first.truth_payload is not None:
            self._load = np.linalg.inv(_matrix(first.truth_links[-1])) @ _matrix(first.truth_payload)
        self.scene = Scene(self.server, found.arm, first.scenario, meshes=meshes, first=self._measured(0))
        self.predicted = MovingGhost(self.server, found.arm, "/ghost/predicted", ORANGE)
        self.limbs = None if meshes else MovingGhost(self.server, found.arm, "/ghost/measured", GREY)
        self.parts = DrawnParts(self.server.gui, self.troubles)
        self._events = [_event(each) for each in found.told]
        self._controls()
        self._plots()
        self.guard.open(self.server, frozenset(), lambda client: None)
        self.start_drawing()

    @property
    def row(self) -> int:
        """Of the table: the last one that is not after the time."""
        return max(int(np.searchsorted(self._t, self.moment.time + 1e-9, side="right")) - 1, 0)

    def draw(self) -> bool:
        """Let the log go on by what has passed since the last picture; there is always a next one."""
        now = time.monotonic()
        self.moment.advance(now - self._before)
        self._before = now
        self.parts.draw("the log", self.show)
        if self._frame % FRAMES_A_PLOT == 0:
            self.parts.draw("the plots", self.plot)
        self._frame += 1
        return True

    def show(self) -> None:
        """Bring both arms, time line and numbers to the time."""
        row = self.row
        snapshot = self._measured(row)
        self.scene.show(snapshot)
        self.predicted.show(self._model_q[row].tolist(), snapshot)
        if self.limbs is not None:
            self.limbs.show(self._q[row].tolist(), snapshot)
        self.facts.show(svg.facts(self._numbers(row)))
        self.time_line.show()

    def plot(self) -> None:
        """Bring the plots to the time, and to the joint that is chosen."""
        rows = self._window()
        shown = (int(rows[0]), int(rows[-1]), self.row, self.joint.value)
        if shown == self._shown:
            return
        self._shown = shown
        t, i = self._t[rows], self._found.arm.chain.joints.index(self.joint.value)
        measured, predicted, external = (self._torque(k)[rows, i] for k in (0, 1, 3))
        apart = 1e3 * (self._model_q - self._q)[rows, i]
        for handle, lines in ((self.torque, (measured, predicted, external)), (self.apart, (apart,))):
            spike = np.zeros(len(t))
            spike[int(np.searchsorted(rows, self.row, side="right")) - 1] = max(float(line.max()) for line in lines)
            handle.data = (t, *(np.ascontiguousarray(line) for line in lines), spike)

    def _window(self) -> NDArray[np.intp]:
        half = 0.5 * WINDOW
        begin = min(max(self.moment.time - half, 0.0), max(self.moment.end - WINDOW, 0.0))
        low, high = np.searchsorted(self._t, (begin, begin + WINDOW))
        return np.arange(low, max(high, low + 2), max(1, -(-int(high - low) // POINTS))).clip(0, len(self._t) - 1)

    def _torque(self, k: int) -> Array:
        """Block k of the table behind the angles (rows, n) [N·m]."""
        n = self._found.arm.n
        return self._torques[:, k * n : (k + 1) * n]

    def _measured(self, row: int) -> Snapshot:
        """The picture with the arm as it was measured."""
        base = _matrix(self._first.truth_links[0])
        poses = [base @ frame for frame in joint_frames(self._found.arm, self._q[row])]
        links = np.array([self._first.truth_links[0], *map(_pose, poses)])
        load = None if self._load is None else _pose(poses[-1] @ self._load)
        return replace(self._first, truth_links=links, truth_payload=load)

    def _numbers(self, row: int) -> list[tuple[str, str]]:
        arm = self._found.arm
        tools = [joint_frames(arm, q[row])[-1][:3, 3] for q in (self._q, self._model_q)]
        measured, predicted = self._torque(0)[row], self._torque(1)[row]
        return [
            ("Time", f"{self._t[row]:.2f} of {self.moment.end:.2f} s"),
            ("Flanges apart", f"{1e3 * float(np.linalg.norm(tools[1] - tools[0])):.0f} mm"),
            *(
                (joint.replace("_", " ").capitalize(), f"{a:.1f}, predicted {b:.1f} N·m")
                for joint, a, b in zip(arm.chain.joints, measured, predicted, strict=True)
            ),
        ]

    def _controls(self) -> None:
        gui = self.server.gui
        Html(gui, style.sheet("none", "none", ["none"]))  # no stop and no free-drive here
        gui.set_panel_label(f"{self._found.name} against {self._found.arm.title}")
        self.time_line = TimeLine(gui, self.moment, self._events, self.guard.for_anyone)
        self.facts = Html(gui)
        words = f"where the model would be, had the measured torques alone moved it for the last {HORIZON:g} s."
        Html(gui, svg.note("The orange arm", words, Colour.AMBER))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(320)

    def _plots(self) -> None:
        gui, joints = self.server.gui, self._found.arm.chain.joints
        panel = gui.add_panel()
        self._shown: object = None
        nothing = (np.zeros(2),) * 3
        with panel.add_tab("Torques"):
            self.joint: Any = gui.add_dropdown("Joint", tuple(joints))
            self.guard.for_anyone(self.joint)
            lines = [("measured", MEASURED), ("predicted", PREDICTED), ("external, as estimated", EXTERNAL), ("now", NOW)]
            self.torque = gui.add_uplot(
                (np.arange(2.0), *nothing, np.zeros(2)), _series(lines), title="Motor torque [N·m]", aspect=1.5, scales=SECONDS
            )
            self.apart = gui.add_uplot(
                (np.arange(2.0), *nothing[:1], np.zeros(2)),
                _series([("model", PREDICTED), ("now", NOW)]),
                title=f"The model's angle after {HORIZON:g} s, less the measured one [mrad]",
                aspect=2.2,
                scales=SECONDS,
            )
        with panel.add_tab("Told"):
            if len(self._events) > MOST_TOLD:
                Html(gui, svg.fine_print(f"The first {MOST_TOLD} of {len(self._events)}"))
            told = [
                svg.LogLine(f"{each.t:.2f} s", each.headline, SEVERITY_COLOURS[Severity[each.severity]], moment(each), 1)
                for each in self._events[:MOST_TOLD]
            ]
            Html(gui, svg.event_log(told) if told else svg.fine_print("Nothing would have been told."))
        with panel.add_tab("About"):
            for sentence in sentences(self._found):
                Html(gui, svg.fine_print(f"{sentence[0].upper()}{sentence[1:]}."))
        panel.dock_left()
        panel.set_width(360)


def _series(lines: list[tuple[str, str]]) -> tuple[uplot.Series, ...]:
    return (uplot.Series(label="t"), *(uplot.Series(label=name, stroke=colour, width=1) for name, colour in lines))


def _event(told: LogNotice) -> EventLine:
    """What would have been told, as an event of a recording."""
    severity = Severity.STOP if told.what == "collision" else Severity.NOTICE
    return EventLine(
        tick=round(told.t * TICK_RATE),
        t=told.t,
        kind=told.what,
        severity=severity.name,
        headline=f"{told.what.capitalize()}: {told.part}, {told.force:.0f} N",
        guidance="",
        values={},
    )


def _matrix(pose: Array) -> Array:
    """A pose (7,) as a matrix (4, 4)."""
    return transform(matrix_from_quaternion(pose[3:]), pose[:3])


def _pose(matrix: Array) -> Array:
    """A matrix (4, 4) as a pose (7,)."""
    return np.concatenate([matrix[:3, 3], quaternion_from_matrix(matrix[:3, :3])])
