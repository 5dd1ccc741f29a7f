"""The page: the pendant on the right, two docks on the left, and what is shown of a snapshot in each of them."""

from collections.abc import Callable

import viser

from app.files.taught_program import Lesson
from app.kept_setup import Keeper
from app.log.live import LiveRecording
from app.robot_interface.interfaces import RobotInterfaces
from app.urscript.running.script_runner import ScriptRunner
from app.web.access.guard import Guard
from app.web.cell.cell_tab import CellTab
from app.web.cell.work_cell import WorkCell
from app.web.lab.lab_tab import Lab
from app.web.lab.setup import LabSetup
from app.web.panel.journal import Journal
from app.web.panel.main_bar import Taught
from app.web.panel.mode_panel import Panel
from app.web.recordings.recording import RecordingSwitch
from app.web.running import Running
from app.web.scene.ghost import Ghost
from app.web.scene.moving_ghost import MovingGhost
from app.web.scene.virtual_hand import VirtualHand
from app.web.tabs.axes_tab import AxesTab
from app.web.tabs.contact_log import Contacts
from app.web.tabs.jog_tab import JogTab
from app.web.tabs.network_tab import NetworkTab
from app.web.tabs.plots import Plots
from app.web.tabs.script_tab import EXAMPLE, ScriptTab
from app.web.tabs.settings_tab import SettingsTab
from app.web.tabs.teach_tab import Teach
from app.web.tabs.tools_tab import ToolsTab
from app.web.walls.walls_tab import WallsTab
from app.web.widgets import style, svg
from app.web.widgets.drawn_parts import DrawnParts
from app.web.widgets.html import Html
from app.web.widgets.labels import Labels
from pendant.events.event import Event
from pendant.program.jog_move import MoveThere
from pendant.tick.modes import TICK_RATE
from sim.arm.arm_file import Arm
from sim.exchange.snapshot import Snapshot

MOMENT = (73, 80, 87)
"""Colour of the arm as it was at a moment of the log."""

LEFT = 348
"""Width of the left docks [pixels]."""


class OnPage:
    """What of the cell is on the page alone."""

    def __init__(self, teach: Teach, script: ScriptTab | None) -> None:
        self._teach, self._script = teach, script
        self._other = ""  # the script of a page that has no tab for it

    def taught(self) -> Lesson:
        """See `Desktop`."""
        return self._teach.lesson

    def script(self) -> str:
        """See `Desktop`; the example that the tab begins with is none."""
        text = self._other if self._script is None else self._script.text.value
        return "" if text == EXAMPLE else text

    def show(self, taught: Lesson, script: str) -> None:
        """See `Desktop`."""
        self._teach.take(taught)
        if self._script is None:
            self._other = script
        elif self.script() != script:
            self._script.text.value = script or EXAMPLE


class Docks:
    """All panels."""

    def __init__(
        self,
        server: viser.ViserServer,
        guard: Guard,
        loop: Running,
        *,
        hand: VirtualHand,
        arm: Arm,
        recording: LiveRecording,
        interfaces: RobotInterfaces | None,
        scripts: ScriptRunner | None,
        keeper: Keeper | None,
    ) -> None:
        self._loop = loop
        self._read = 0
        gui = server.gui
        self.parts = DrawnParts(gui, loop.troubles)
        sheet = gui.add_html("")
        self.panel = Panel(server, guard, loop, arm)
        self._upper = gui.add_panel()
        with self._upper.add_tab("Teach") as self._teach_dock:
            self.teach = Teach(server, loop, arm)
        with self._upper.add_tab("Jog") as self._jog_dock:
            self.jog = JogTab(server, loop, arm)
        with self._upper.add_tab("Axes") as self._axes_dock:
            self.axes = AxesTab(gui, loop, arm)
        with self._upper.add_tab("Walls") as self._walls_dock:
            self.walls = WallsTab(server, guard, loop)
        with self._upper.add_tab("Tools") as self._tools_dock:
            self.tools = ToolsTab(server, guard, loop, arm)
        with self._upper.add_tab("Cell") as self._cell_dock:
            self.cell = CellTab(gui, self.panel.bar.home)
            setup = LabSetup(gui, loop, arm)
            self.cell.names(gui)
        with self._upper.add_tab("Lab") as self._lab_dock:
            self.lab = Lab(gui, loop, hand, arm, setup=setup, interfaces=interfaces)
        with self._upper.add_tab("Settings") as self.settings_dock:
            self.settings = SettingsTab(gui, self.settings_dock, loop, arm.n)
        self._lower = gui.add_panel()
        with self._lower.add_tab("Events") as self._events_dock:
            self.journal = Journal(gui, arm.chain.joints)
        with self._lower.add_tab("Contacts") as self._contacts_dock:
            self.contacts = Contacts(server, loop, arm)
        with self._lower.add_tab("Plots") as self.plots_dock:
            self.plots = Plots(gui, loop, arm)
        self.moment = Ghost(server, arm, "/ghost/moment", MOMENT)
        with self._lower.add_tab("Record") as self._record_dock:
            self.recording = RecordingSwitch(server, recording, arm)
        self.journal.look_at, self.contacts.look_at = self._look_back, self._look_at
        self.script: ScriptTab | None = None
        if scripts is not None:
            with self._lower.add_tab("Script") as self._script_dock:
                self.script = ScriptTab(gui, scripts)
        self.network: NetworkTab | None = None
        if interfaces is not None:
            with self._lower.add_tab("Network") as self._network_dock:
                self.network = NetworkTab(gui, interfaces)
        self.legend = Html(gui)
        self._ghosts: tuple[tuple[Ghost | MovingGhost, str], ...] = (
            (self.teach.ghost, "Waypoint"),
            (self.jog.ghost, "Joint angles of the sliders"),
            (self.panel.back.ghost, "Where free-drive began"),
            (self.contacts.ghost, "At the contact"),
            (self.moment, "At the chosen moment"),
            (self.recording.replay.ghost, "Replay"),
        )
        stood = (self.panel.back.ghost, self.teach.ghost, self.jog.ghost, self.contacts.ghost, self.moment)
        own = (self.panel.hit.label, self.contacts.label, self.panel.back.label, self.panel.marks.label)
        self.texts: Callable[[], list[viser.LabelHandle]] = list  # of the picture; what draws it gives them
        self.labels = Labels(lambda: [*own, *(ghost.label for ghost in stood), *self.texts()])
        bar = self.panel.bar
        bar.taught, bar.ended, bar.scripts = self._taught, self.teach.ended, scripts
        self.jog.also(bar.start, self._start)
        self.work = WorkCell(loop, arm, OnPage(self.teach, self.script), keeper)
        self.cell.serve(self.work)
        self.lab.scenarios.lend, self.lab.start_over = self.work.lend, self.work.start_over
        self.lab.wires.names = lambda: self.work.lines
        self._upper.dock_left()
        self._upper.set_width(LEFT)
        self._lower.dock_below(self._upper)
        quiet = (  # buttons that look quiet (app/web/widgets/style.py); this is no list of permissions
            self.panel.leave,
            self.panel.reset,
            self.lab.restart,
            self.lab.drop,
            self.lab.setup.begin,
            bar.home,
            self.cell.adopt,
            self.cell.save,
            self.cell.load,
            self.cell.undo,
            self.cell.redo,
            self.cell.yes,
            self.cell.no,
            self.settings.defaults,
            self.settings.undo,
            self.settings.save,
            self.settings.load,
            self.jog.here,
            self.jog.now,
            self.tools.zero,
            self.tools.use,
            self.tools.enter,
            self.tools.apply,
            self.tools.clear,
            self.tools.measure,
            self.tools.touching.take,
            self.tools.touching.again,
            self.tools.touching.use,
            self.tools.editor.yes,
            self.tools.editor.no,
            self.tools.editor.save,
            self.tools.editor.load,
            self.walls.here,
            self.walls.delete,
            self.walls.undo,
            self.walls.points.take,
            self.walls.points.again,
            self.tools.editor.undo,
            self.contacts.export,
            self.recording.export,
            self.recording.replay.leave,
            self.recording.replay.download,
            self.teach.step,
            self.teach.save,
            self.teach.load,
            *(() if self.script is None else (self.script.save, self.script.load)),
        )
        sheet.content = style.sheet(
            self.panel.stop._impl.uuid,
            self.panel.free_drive._impl.uuid,
            [button._impl.uuid for button in quiet],
            large=(self.panel.leave._impl.uuid, self.panel.reset._impl.uuid),
        )

    def _tell_ghosts(self) -> bool:
        """Say over the picture what the ghosts in it mean."""
        return self.legend.show(svg.ghosts((ghost.colour, text) for ghost, text in self._ghosts if ghost.posture is not None))

    def _taught(self) -> Taught:
        """What the main bar runs."""
        lesson = self.teach.lesson
        return Taught(tuple(step.text for step in lesson.plan), self.teach.begin, self.teach.start is not None)

    def _start(self) -> MoveThere | None:
        """The way to where the program begins, at manual speed."""
        start = self.teach.start
        return None if start is None else MoveThere(q=tuple(start.q), name=start.name)

    def _look_at(self, tick: int | None) -> None:
        """Show a moment in the plots, and in the replay if it is of that; None: follow the simulation."""
        self.plots.look_at(tick)
        self.recording.replay.look_at(tick)

    def _look_back(self, tick: int | None) -> None:
        """The same, and the arm as it was then, in the picture."""
        self._look_at(tick)
        posture = None if tick is None else self.plots.history.posture(tick)
        self.moment.show(posture, self._loop.latest(), "" if tick is None else f"At {tick / TICK_RATE:.2f} s")

    def show(self, snapshot: Snapshot) -> bool:
        """Show a snapshot and the events since the last call, each part for itself; True if anything changed."""
        fresh: list[Event] = self._loop.events(self._read)
        self._read += len(fresh)
        panel, journal, draw = self.panel, self.journal, self.parts.draw
        changed = [
            draw("the marks in the plots", lambda: self.plots.note(fresh), self.plots_dock),
            draw("the pendant", lambda: panel.show(snapshot, fresh)),
            draw("the tab Events", lambda: journal.show(fresh), self._events_dock),
            draw("the tab Events", lambda: panel.excused is not None and journal.forget(panel.excused), self._events_dock),
            draw("the tab Lab", lambda: self.lab.show(snapshot), self._lab_dock),
            draw("the tab Teach", lambda: self.teach.show(snapshot), self._teach_dock),
            draw("the tab Jog", lambda: self.jog.show(snapshot, fresh), self._jog_dock),
            draw("the tab Axes", lambda: self.axes.show(snapshot), self._axes_dock),
            draw("the tab Walls", lambda: self.walls.show(snapshot, fresh), self._walls_dock),
            draw("the tab Tools", lambda: self.tools.show(snapshot), self._tools_dock),
            draw("the tab Settings", lambda: self.settings.show(snapshot, fresh), self.settings_dock),
            draw("the tab Contacts", lambda: self.contacts.show(snapshot, fresh), self._contacts_dock),
            draw("the tab Record", lambda: self.recording.show(snapshot), self._record_dock),
        ]
        if self.script is not None:
            changed.append(draw("the tab Script", self.script.show, self._script_dock))
        if self.network is not None:
            changed.append(draw("the tab Network", self.network.show, self._network_dock))
        changed.append(draw("the legend", self._tell_ghosts))
        changed.append(draw("texts in the picture", self.labels.show))
        changed.append(draw("the tab Cell", self.cell.show, self._cell_dock))
        if self.plots.moment is None and self.moment.posture is not None:  # the simulation has begun again
            self.moment.show(None, snapshot)
        draw("what is kept for the next start", self.keep, self._cell_dock)
        return any(changed)

    def skip(self) -> None:
        """What has happened so far is of another arm, and not shown here."""
        self._read = len(self._loop.events(0))

    def keep(self, *, now: float | None = None) -> None:
        """Take in what changed, and have it kept for the next start; `now` is the clock, which says whether it is time to."""
        self.work.see(now=now)
