"""The jog tab: the arm moves while a button is held: a joint, along and about the axes of base or tool, or to a posture."""

import math
from collections.abc import Callable, Coroutine
from typing import Any, Literal, NamedTuple

import viser

from app.web.running import Running
from app.web.scene.ghost import Ghost
from app.web.widgets import style, svg
from app.web.widgets.html import Html, enable
from app.web.widgets.vector_field import vector
from pendant.event_table import render
from pendant.events.event import Event, Kind
from pendant.program.jog_move import TURNS, Jogged, JogMove, MoveStraight, MoveThere
from pendant.tick.modes import TICK_RATE, Mode, Phase
from sim.arm.arm_file import Arm
from sim.arm.frames import quaternion_from_matrix, rotation_from_rpy, rpy_from_matrix
from sim.exchange.snapshot import Snapshot
from sim.motion.jog import MANUAL

HOLD_RATE = 30.0
"""How often a held button is asked to say so [Hz], as the free-drive button's."""

FRAMES: dict[str, Literal["joint", "base", "tool"]] = {
    "Joints": "joint",
    "Axes of the base": "base",
    "Axes of the tool": "tool",
}
AXES = ("X", "Y", "Z", "Turn about X", "Turn about Y", "Turn about Z")

LET_GO = "Letting go"
STEPS = {LET_GO: 0.0, "1 mm, 1°": 1.0, "10 mm, 10°": 10.0, "50 mm, 50°": 50.0}
"""How far one press goes at most [mm or degrees]; 0: as long as it is held."""

STILL = 0.15
"""A button is held for so long before the arm moves: a finger that scrolls the page may begin on it [s]."""

HOME: Literal["home"] = "home"
THERE: Literal["there"] = "there"
STRAIGHT: Literal["straight"] = "straight"
START: Literal["start"] = "start"
"""The buttons that move to a posture, the arm's own or the one that the sliders say, straight to a pose that was typed, and to
where the program begins."""

FARTHEST, FULLEST = 3000.0, 360.0
"""Of a typed pose [mm], [°]; what the arm cannot reach is refused as it begins."""

SEEN = 20
"""So long the posture of the sliders is seen after they were moved [s]."""

BLUE = (25, 113, 194)
NEAR = math.radians(0.5)
"""The arm is there when no joint is further from the sliders [rad]."""

Which = tuple[int, int] | Literal["home", "there", "straight", "start"]
"""A button: axis and sign, or where it moves to."""

HOLD_ON = "Nothing moved: let go too early. The arm moves while a button is held."
LIFT_FIRST = "The button fell silent, so the arm stopped. Let go, then press again."
NOT_NOW = "Jogging is possible in TEACH and NORMAL, while free-drive is off."


class JogPress(NamedTuple):
    """A button that is held: by whom, which, since when, and when it last said so."""

    client: int
    button: Which
    since: int
    tick: int

    @property
    def still(self) -> bool:
        """It has been held for long enough to be meant."""
        return self.tick - self.since >= STILL * TICK_RATE


class JogTab:
    """The tab. Its controls run on viser's event loop; `show` runs in the painter."""

    def __init__(self, server: viser.ViserServer, loop: Running, arm: Arm) -> None:
        gui = server.gui
        self._home = tuple(arm.chain.home)
        self._loop, self._names = loop, [name.replace("_", " ").capitalize() for name in arm.chain.joints]
        self._press: JogPress | None = None
        self._begin: Callable[[], MoveThere | None] = lambda: None
        self._over: set[int] = set()  # clients whose press is over, their pointer not lifted
        self._presses = False  # one of them still presses
        self.frame = gui.add_dropdown("Move by", tuple(FRAMES), initial_value="Joints")
        self.chosen: Literal["joint", "base", "tool"] = "joint"
        self.steps = gui.add_dropdown("Stops after", tuple(STEPS), initial_value=LET_GO, hint="Or when the button is let go")
        self._told = ""  # of the last press
        self.said = Html(gui)
        self.buttons: dict[tuple[int, int], viser.GuiButtonHandle] = {}
        for axis in range(max(len(self._names), 2 * TURNS)):
            for sign in (-1, 1):
                button = gui.add_button(self._label(axis, sign), color="gray", hint="Hold it")
                self.buttons[axis, sign] = button
                self._holds(button, (axis, sign))
        self.home = gui.add_button("Home", color="gray", icon=viser.Icon.HOME, hint="Hold it: to the home posture")
        self.there = gui.add_button("Move to these angles", color="gray", hint="Hold it: to the angles of the sliders")
        self._holds(self.home, HOME)
        self._holds(self.there, THERE)
        Html(gui, style.pairs([button._impl.uuid for button in (*self.buttons.values(), self.home, self.there)]))
        self.pose = Html(gui)
        with gui.add_folder("Joint angles to move to", expand_by_default=False):
            self.sliders = [
                gui.add_slider(f"{name} [°]", min=least, max=most, step=0.1, initial_value=round(math.degrees(angle), 1))
                for name, angle, (least, most) in zip(self._names, self._home, _farthest(arm), strict=True)
            ]
            self.here = gui.add_button("As the arm is now", color="gray")
        with gui.add_folder("Pose of the tool to move to", expand_by_default=False):
            self.at = vector(gui, "Place [mm]", FARTHEST, 0.1, hint="x, y, z in the base")
            self.turned = vector(gui, "Rotation [°]", FULLEST, 0.01, hint="Roll, pitch, yaw")
            self.now = gui.add_button("As the tool is now", color="gray")
            self.straight = gui.add_button("Straight to it", color="gray", hint="Hold it: along a straight line")
            self._holds(self.straight, STRAIGHT)
            Html(gui, style.held(self.straight._impl.uuid))
        self._fill_pose()
        self.ghost = Ghost(server, arm, "/ghost/posture", BLUE)
        self._shown_until = 0  # tick until which the posture of the sliders is seen
        self._connect()

    def show(self, snapshot: Snapshot, fresh: list[Event]) -> bool:
        """Show where the arm is, and what became of the last press; True if anything changed."""
        decision = snapshot.decision
        for event in fresh:
            if event.kind in (Kind.JOG_ENDED, Kind.JOG_REFUSED):
                self._told = _arrived(event) or ". ".join(render(event))
        may = decision.mode in (Mode.TEACH, Mode.NORMAL) and decision.phase is Phase.OFF
        count = len(self._names) if self.chosen == "joint" else 2 * TURNS
        changed = [enable(button, may and axis < count) for (axis, _), button in self.buttons.items()]
        changed += [enable(button, may) for button in (self.home, self.there, self.straight)]
        changed.append(self.ghost.show(self._wanted(snapshot, may), snapshot, "Sliders"))
        told = LIFT_FIRST if self._presses else self._told or self._hint()
        said = self.said.show(svg.two_lines(told if may else NOT_NOW))
        return any([*changed, said, self.pose.show(svg.facts(self._facts(snapshot)))])

    def let_go(self, client: int) -> None:
        """Whatever `client` holds is released: it stalled, left, or gave control back. Its press is over."""
        if self._press is not None and self._press.client == client:
            self._over.add(client)
            self._stop()

    def forget(self, client: int) -> None:
        """`client` has gone."""
        self.let_go(client)
        self._over.discard(client)
        self._presses = self._presses and bool(self._over)

    def also(self, button: viser.GuiButtonHandle, begin: Callable[[], MoveThere | None]) -> None:
        """Let a button of another place move the arm, while it is held, to what `begin` says then; None: nowhere."""
        self._begin = begin
        self._holds(button, START)

    def _wanted(self, snapshot: Snapshot, may: bool) -> tuple[float, ...] | None:
        """The posture of the sliders [rad], as long as it is to be seen; None: the arm is there, or nobody asked."""
        held = self._press is not None and self._press.button == THERE
        if not may or not (held or snapshot.tick < self._shown_until):
            return None
        wanted = self._angles()
        return wanted if max(abs(a - b) for a, b in zip(wanted, snapshot.estimate.q, strict=True)) > NEAR else None

    def _fill_pose(self) -> None:
        """Let the typed pose be where the tool is."""
        snapshot = self._loop.latest()
        seen = snapshot.estimate
        x, y, z = (round(1000.0 * float(value), 1) for value in seen.tcp[:3])
        self.at.value = (x, y, z)
        roll, pitch, yaw = (round(math.degrees(angle), 2) for angle in rpy_from_matrix(seen.R_BF @ snapshot.R_FT))
        self.turned.value = (roll, pitch, yaw)

    def _angles(self) -> tuple[float, ...]:
        """What the sliders say (n,) [rad]."""
        return tuple(math.radians(float(slider.value)) for slider in self.sliders)

    def _asked(self, which: Which) -> Jogged | None:
        """The motion of a button; None: it has nowhere to move to."""
        if which == START:
            return self._begin()
        if which == HOME:
            return MoveThere(q=self._home, name="home")
        if which == THERE:
            return MoveThere(q=self._angles(), name="these joint angles")
        if which == STRAIGHT:
            x, y, z = (value / 1000.0 for value in self.at.value)
            w, i, j, k = quaternion_from_matrix(rotation_from_rpy([math.radians(angle) for angle in self.turned.value])).tolist()
            return MoveStraight(position=(x, y, z), quaternion=(w, i, j, k), speed=MANUAL)
        axis, sign = which
        length = STEPS[self.steps.value]
        turns = self.chosen == "joint" or axis >= TURNS
        length = math.radians(length) if turns else length / 1000.0
        return JogMove(frame=self.chosen, axis=axis, sign=1 if sign > 0 else -1, length=length)

    def _label(self, axis: int, sign: int) -> str:
        names = self._names if self.chosen == "joint" else AXES
        return f"{names[axis] if axis < len(names) else ''} {'−' if sign < 0 else '+'}"

    def _hint(self) -> str:
        if self.steps.value == LET_GO:
            return "Hold a button: the arm moves until you let go."
        return f"Hold a button: the arm stops after {self.steps.value.replace(',', ' or')}. Let go to stop it earlier."

    def _facts(self, snapshot: Snapshot) -> list[tuple[str, str]]:
        seen = snapshot.estimate
        if self.chosen == "joint":
            return [(name, f"{math.degrees(angle):.1f}°") for name, angle in zip(self._names, seen.q, strict=True)]
        x, y, z = (1000.0 * value for value in seen.tcp[:3])
        return [("Tool, in the base", f"{x:.1f}, {y:.1f}, {z:.1f} mm")]

    def _holds(self, button: viser.GuiButtonHandle, which: Which) -> None:
        """Let the arm move while the button is held."""
        button.on_hold(callback_hz=HOLD_RATE)(self._held(which))
        button.on_click(self._lifted)

    def _held(self, which: Which) -> Callable[[viser.GuiEvent], Coroutine[Any, Any, None]]:
        async def held(event: viser.GuiEvent) -> None:
            client = event.client_id
            if client is None:
                return
            if client in self._over:
                self._presses = True
                return
            tick, before = self._loop.latest().tick, self._press
            if before is not None and tick - before.tick > self._loop.settings.hold.silence * TICK_RATE:
                self.let_go(before.client)  # a press that fell silent needs a real pointer-up first
                if before.client == client:
                    return
            goes_on = before is not None and before[:2] == (client, which)
            self._told = self._told if goes_on else ""
            self._press = press = JogPress(client, which, before.since if before is not None and goes_on else tick, tick)
            if not press.still:
                return
            asked = self._asked(which)
            if asked is not None:
                self._loop.desk.jog(asked)

        return held

    async def _lifted(self, event: viser.GuiEvent) -> None:
        if event.client_id is None:
            return
        self._over.discard(event.client_id)
        self._presses = False
        if self._press is not None and self._press.client == event.client_id:
            if not self._press.still:
                self._told = HOLD_ON
            self._stop()

    def _connect(self) -> None:
        @self.here.on_click
        async def _(_: viser.GuiEvent) -> None:
            for slider, angle in zip(self.sliders, self._loop.latest().estimate.q, strict=True):
                slider.value = min(max(round(math.degrees(float(angle)), 1), slider.min), slider.max)

        @self.now.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._fill_pose()

        for slider in self.sliders:

            @slider.on_update
            async def _(event: viser.GuiEvent) -> None:
                if event.client_id is not None:
                    self._shown_until = self._loop.latest().tick + SEEN * TICK_RATE

        @self.steps.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._told = ""

        @self.frame.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._stop()
            self._told = ""
            self.chosen = FRAMES[self.frame.value]
            for (axis, sign), button in self.buttons.items():
                button.label = self._label(axis, sign)

    def _stop(self) -> None:
        self._press = None
        self._loop.desk.stop_jogging()


def _arrived(event: Event) -> str:
    """What is told of a jog that came to where it was to go: there, or how far it went; "" of another."""
    if event.kind is not Kind.JOG_ENDED or event.values["reason"] != "done":
        return ""
    _, leads, place = str(event.values["what"]).partition("to ")
    return f"At {place}." if leads else f"Done: {event.values['moved']}."


def _farthest(arm: Arm) -> list[tuple[float, float]]:
    """Smallest and largest angle of each joint [°]; inwards to a tenth, which the page shows."""
    ends = [(10.0 * math.degrees(low), 10.0 * math.degrees(high)) for low, high in arm.limits.ends]
    return [(math.ceil(low) / 10.0, math.floor(high) / 10.0) for low, high in ends]
