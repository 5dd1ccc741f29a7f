"""Live plots of what the controller measures, estimates and limits, beside the truth: 20 times a second, in a fixed memory."""

from collections import deque
from enum import StrEnum

import numpy as np
import viser

from app.report.pull_colours import PULL_COLOURS
from app.web.running import Running
from app.web.widgets.chart import Array, Curve, Layer, chart, stack
from app.web.widgets.html import Html
from pendant.events.event import Event
from pendant.guided.pull import SHARE_WORDS
from pendant.tick.modes import TICK_RATE
from sim.arm.arm_file import Arm
from sim.exchange.snapshot import Snapshot

RATE = 20  # samples a second of simulated time
SAMPLES = 200  # drawn: ten seconds
KEPT = 1200  # kept, to go back to a moment: one minute
AFTER = 3 * TICK_RATE  # ticks drawn after the moment that is looked at
NOT_FREE = "not in free-drive"
MARKED = "contact_"  # events whose kind begins like this are marked


class View(StrEnum):
    """What can be plotted."""

    FORCE = "Force, acceleration"
    PULL = "Who pulls, force"
    LIMITS = "Against limits"
    FRICTION = "Friction"
    TORQUE = "Transmission torque"
    TRACKING = "Tracking error"
    RATE = "Rate"


class PlotHistory:
    """The last samples of everything, oldest first, in arrays of a fixed size."""

    def __init__(self, n: int) -> None:
        blank = np.full(KEPT, np.nan)
        self.force, self.acceleration = np.full((3, KEPT), np.nan), np.full((3, KEPT), np.nan)
        self.pull = np.full((len(SHARE_WORDS), KEPT), np.nan)  # probabilities, gaps while the arm is not free
        self.share, self.rate = blank.copy(), blank.copy()
        self.friction = np.full((3, n, KEPT), np.nan)  # true, estimated, its deviation [N·m]
        self.torque = np.full((4, n, KEPT), np.nan)  # true, three ways [N·m]
        self.tracking = np.full((n, KEPT), np.nan)  # [mrad]
        self.q = np.full((n, KEPT), np.nan)  # [rad]
        self.told, self._last = NOT_FREE, ""  # what pulls, and what pulled last, in words
        self.tick = 0

    def add(self, snapshot: Snapshot, rate: float) -> None:
        """Take a sample."""
        seen = snapshot.estimate
        shares = [abs(value.value) / value.limit for value in snapshot.decision.monitored if value.limit > 0.0]
        n = len(self.tracking)
        _push(self.force, seen.F_user[:3])
        _push(self.acceleration, seen.a_F)
        pull = snapshot.pull
        _push(self.pull, np.full(len(self.pull), np.nan) if pull is None else np.array(pull.shares))
        if pull is not None:
            self.told = self._last = pull.words
        else:
            self.told = f"last: {self._last}" if self._last else NOT_FREE
        _push(self.share, 100.0 * max(shares) if shares else np.nan)
        _push(self.rate, rate)
        friction = (snapshot.truth_friction, seen.friction, seen.friction_deviation)
        _push(self.friction, np.array([_sized(values, n) for values in friction]))
        ways = seen.tau_ways if seen.tau_ways.shape == (3, n) else np.full((3, n), np.nan)
        _push(self.torque, np.vstack([_sized(snapshot.truth_tau_J, n), ways]))
        _push(self.tracking, np.full(n, np.nan) if snapshot.reference is None else 1000.0 * (seen.q - snapshot.reference))
        _push(self.q, _sized(seen.q, n))
        self.tick = snapshot.tick

    def posture(self, tick: int) -> list[float] | None:
        """The measured joint angles nearest to a tick [rad]; None where they are not kept."""
        ago = round((self.tick - tick) * RATE / TICK_RATE)
        if not 0 <= ago < KEPT or not np.isfinite(held := self.q[:, KEPT - 1 - ago]).all():
            return None
        return held.tolist()


class Plots:
    """The plots' tab."""

    def __init__(self, gui: viser.GuiApi, loop: Running, arm: Arm) -> None:
        self._loop, self._joints = loop, arm.chain.joints
        self.history = PlotHistory(arm.n)
        self._marks: deque[int] = deque(maxlen=60)  # ticks
        self._moment: int | None = None  # tick that is looked at
        self.view = gui.add_dropdown("Plot", tuple(view.value for view in View))
        self.joint = gui.add_dropdown("Joint", tuple(self._joints), visible=False)
        self.upper, self.lower = Html(gui), Html(gui)

        @self.view.on_update
        async def _(_: viser.GuiEvent) -> None:
            self.joint.visible = self.view.value in (View.FRICTION, View.TORQUE)
            self._draw()

    def note(self, fresh: list[Event]) -> None:
        """Mark the contacts among new events."""
        self._marks.extend(event.tick for event in fresh if event.kind.value.startswith(MARKED))

    @property
    def moment(self) -> int | None:
        """The tick that is looked at; None: the simulation is followed."""
        return self._moment

    def look_at(self, tick: int | None) -> None:
        """Show the time round a tick and stay there; None: follow the simulation."""
        self._moment = tick
        self._draw()

    def show(self, snapshot: Snapshot) -> bool:
        """Take a sample and draw, if it is time; True if anything changed."""
        passed = snapshot.tick - self.history.tick
        if 0 <= passed < TICK_RATE // RATE - 4:  # snapshots come every 8 ticks
            return False
        if passed < 0:  # the simulation began again
            self.history = PlotHistory(len(self._joints))
            self._marks.clear()
            self._moment = None
        self.history.add(snapshot, self._loop.actual_rate)
        return self._draw()

    def _draw(self) -> bool:
        pictures = self._pictures()
        return any([self.upper.show(pictures[0]), self.lower.show(pictures[1])])

    def _pictures(self) -> tuple[str, str]:
        history = self.history
        last = history.tick if self._moment is None else min(history.tick, self._moment + AFTER)
        ago = min(round((history.tick - last) * RATE / TICK_RATE), KEPT - SAMPLES)
        window = slice(KEPT - SAMPLES - ago, KEPT - ago)
        ticks = self._marks if self._moment is None else [*self._marks, self._moment]
        marks = [KEPT - 1 - round((history.tick - tick) * RATE / TICK_RATE) - window.start for tick in ticks]
        marks = [mark for mark in marks if 0 <= mark < SAMPLES]
        joint = self._joints.index(self.joint.value)
        match View(self.view.value):
            case View.FORCE:
                force = chart("User force", "N", _xyz(history.force[:, window]), marks)
                return force, chart("Acceleration", "m/s²", _xyz(history.acceleration[:, window]), marks)
            case View.PULL:
                layers = [
                    Layer(name, colour, row)
                    for name, colour, row in zip(SHARE_WORDS, PULL_COLOURS, history.pull[:, window], strict=True)
                ]
                told = history.told if self._moment is None else ""
                force = chart("User force", "N", _xyz(history.force[:, window]), marks)
                return stack("Who pulls", told, layers, marks), force
            case View.LIMITS:
                return chart(
                    "Nearest to its limit", "%", [Curve("share of the limit", history.share[window])], marks, limit=100.0
                ), ""
            case View.FRICTION:
                true, estimated, deviation = history.friction[:, joint, window]
                lines = [Curve("true", true), Curve("estimated", estimated, dashed=True)]
                return chart("Friction", "N·m", lines), chart("Its uncertainty", "N·m", [Curve("standard deviation", deviation)])
            case View.TORQUE:
                names = ("true", "dynamics", "deflection", "motor")
                lines = [
                    Curve(name, row, name != "true") for name, row in zip(names, history.torque[:, joint, window], strict=True)
                ]
                errors = [Curve(line.name, line.values - lines[0].values) for line in lines[1:]]
                return chart("Transmission torque", "N·m", lines), chart("Error of each way", "N·m", errors)
            case View.TRACKING:
                rows = [Curve(name, row) for name, row in zip(self._joints, history.tracking[:, window], strict=True)]
                return chart("Tracking error", "mrad", rows, marks), ""
            case View.RATE:
                return chart("Rate, simulated over real", "×", [Curve("rate", history.rate[window])]), ""


def _xyz(rows: Array) -> list[Curve]:
    return [Curve(name, row) for name, row in zip("xyz", rows, strict=True)]


def _sized(values: Array, n: int) -> Array:
    """`values`, or gaps where there are none."""
    return values if len(values) == n else np.full(n, np.nan)


def _push(store: Array, value: Array | float) -> None:
    """Shift a store by one sample and add the newest at its end."""
    store[..., :-1] = store[..., 1:]
    store[..., -1] = value
