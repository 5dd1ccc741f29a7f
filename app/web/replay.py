"""The web app showing a recording: time line, speed, contact log and plots; nothing is simulated."""

import time
from collections.abc import Mapping
from typing import Any

import numpy as np
import viser
from viser import uplot

from app.log.events_file import EventLine
from app.log_reading.playback import Player, snapshot_at
from app.web.access.listening import Access
from app.web.access.site import Site
from app.web.panel.state_words import FIGURES, SAFETY_WORDS, SEVERITY_COLOURS, WORDS, pull_row, user_row
from app.web.recordings.event_marks import moment
from app.web.recordings.time_line import TimeLine
from app.web.scene.arm_picture import Scene
from app.web.widgets import style, svg
from app.web.widgets.drawn_parts import DrawnParts
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.events.event_row import Severity
from sim.exchange.snapshot import Snapshot
from sim.run.troubles import Troubles

POINTS = 600
"""Of a plot's line."""

MOST_EVENTS = 1000
"""That are listed."""

FRAMES_A_PLOT = 15
"""The mark of the time in the plots is moved with every so many pictures."""

SECONDS = {"x": uplot.Scale(time=False)}


class Replay(Site):
    """A web app that shows one log.

    Args:
        player: of the log.
        meshes: a GLB file for each part that has a shape.
        access: where to listen, and for whom.
        port: 0 for any free one.
    """

    def __init__(self, player: Player, meshes: Mapping[str, bytes], access: Access, port: int) -> None:
        super().__init__(access, port, Troubles(lambda kind, values: None))
        self.player = player
        self._before = time.monotonic()
        self._frame, self._marked = 0, -1.0
        log = player.log
        self.scene = Scene(self.server, log.arm, log.scenario, meshes=meshes, first=snapshot_at(log, 0, 0))
        self.parts = DrawnParts(self.server.gui, self.troubles)
        self._controls()
        self._plots()
        self.guard.open(self.server, frozenset(), lambda client: None)
        self.start_drawing()

    def draw(self) -> bool:
        """Let the recording go on by what has passed since the last picture; there is always a next one."""
        now = time.monotonic()
        self.player.advance(now - self._before)
        self._before = now
        self.parts.draw("the recording", self.show)
        self._frame += 1
        if self._frame % FRAMES_A_PLOT == 0 and self._marked != self.player.time:
            self._marked = self.player.time
            self._mark()
        return True

    def show(self) -> None:
        """Bring picture, time line and numbers to the player's time."""
        player = self.player
        snapshot = snapshot_at(player.log, player.picture, player.row)
        self.scene.show(snapshot)
        decision = snapshot.decision
        word, colour = WORDS[decision.mode]
        self.light.show(svg.light(decision.mode.replace("_", "-"), word, SAFETY_WORDS[decision.safety], colour))
        self.facts.show(svg.facts(_numbers(player, snapshot), FIGURES))
        self.time_line.show()

    def _controls(self) -> None:
        gui, player = self.server.gui, self.player
        log = player.log
        Html(gui, style.sheet("none", "none", ["none"]))  # no stop and no free-drive here
        gui.set_panel_label(f"replay · {log.run.get('title', log.path.name)}")
        self.light = Html(gui)
        self.time_line = TimeLine(gui, player, log.events, self.guard.for_anyone)
        self.facts = Html(gui)
        if log.missing:
            Html(gui, svg.note("Not whole", f"Of this recording {log.missing}.", Colour.AMBER))
        if log.thinned:
            Html(gui, svg.fine_print(f"Thinned: {log.thinned}."))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(304)

    def _plots(self) -> None:
        gui, log = self.server.gui, self.player.log
        panel = gui.add_panel()
        contacts = [event for event in log.events if event.kind.startswith("contact_")]
        for name, events in (("Events", log.events), ("Contacts", contacts)):
            with panel.add_tab(name):
                if len(events) > MOST_EVENTS:
                    Html(gui, svg.fine_print(f"The last {MOST_EVENTS} of {len(events)}"))
                Html(gui, svg.event_log(_line(event) for event in reversed(events[-MOST_EVENTS:])))
        step = max(1, len(log) // POINTS)
        self._stretch = step
        state, truth, t = log.state.sampled(step), log.truth.sampled(step), log.t[::step]
        force = np.linalg.norm(state["F_user"][:, :3], axis=1)
        acceleration = np.linalg.norm(state["a_F"], axis=1)
        self._series: list[tuple[viser.GuiUplotHandle, tuple[np.ndarray[Any, Any], ...]]] = []
        with panel.add_tab("Plots"):
            for title, lines in (
                ("Speed [m/s]", {"tcp": state["v_tcp"], "elbow": state["v_elbow"]}),
                ("Force at the flange [N]", {"force": force}),
                ("Acceleration [m/s²]", {"at the flange": acceleration}),
                (
                    "Friction of the shoulder [N·m]",
                    {"true": truth["friction"][:, 1], "estimated": state["friction"][:, 1]},
                ),
            ):
                data = (t, *(np.ascontiguousarray(values, dtype=np.float64) for values in lines.values()))
                series = [uplot.Series(label="t")]
                colours = ("#1971c2", "#e8590c")
                series += [uplot.Series(label=name, stroke=c, width=1) for name, c in zip(lines, colours, strict=False)]
                series.append(uplot.Series(label="now", stroke="#c92a2a", width=2))
                handle = gui.add_uplot((*data, np.zeros(len(data[0]))), tuple(series), title=title, aspect=2.2, scales=SECONDS)
                self._series.append((handle, data))
        panel.dock_left()
        panel.set_width(330)
        self._mark()

    def _mark(self) -> None:
        """Move the mark of the time: a spike in each plot, as high as its lines."""
        at = min(self.player.row // self._stretch, len(self._series[0][1][0]) - 1)
        for handle, data in self._series:
            spike = np.zeros(len(data[0]))
            spike[at] = max(float(np.nanmax(line)) for line in data[1:])
            handle.data = (*data, spike)


def _numbers(player: Player, snapshot: Snapshot) -> list[tuple[str, str]]:
    seen = snapshot.estimate
    periods = [(period.name.capitalize(), f"{period.ticks / 500:.2f} s left") for period in snapshot.decision.periods]
    return [
        ("Time", f"{player.time:.2f} of {player.end:.2f} s"),
        ("Phase", snapshot.decision.phase.value),
        ("Tool speed", f"{1000 * seen.v_tcp:.0f} mm/s"),
        ("Force at the flange", f"{float(np.linalg.norm(seen.F_user[:3])):.1f} N"),
        *pull_row(snapshot.pull),
        *user_row(snapshot.user),
        ("Payload true, configured", f"{snapshot.truth_payload_mass:.2f}, {snapshot.configured_mass:.2f} kg"),
        *periods,
    ]


def _line(event: EventLine) -> svg.LogLine:
    """A row, which leads to its moment."""
    return svg.LogLine(f"{event.t:.2f} s", event.headline, SEVERITY_COLOURS[Severity[event.severity]], moment(event), 1)
