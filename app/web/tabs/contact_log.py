"""The contact log: changes in contact and hits, newest first, one of them shown in the picture, all of them as a file."""

import csv
import io
from collections import deque
from collections.abc import Callable, Iterable
from itertools import islice
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from app.web.running import Running
from app.web.scene.ghost import Ghost
from app.web.scene.hit_mark import where
from app.web.tabs.plots import MARKED
from app.web.widgets import svg
from app.web.widgets.html import Html, bring
from pendant.all_settings import Settings
from pendant.events.event import Event, Kind, posture_of
from pendant.tick.modes import TICK, TICK_RATE
from sim.arm.arm_file import Arm
from sim.arm.frames import matrix_from_quaternion
from sim.exchange.snapshot import Snapshot

Array = NDArray[np.float64]

LENGTH = 200
"""Contacts kept."""

SHOWN = 30
"""Contacts in the table."""

NEWEST = "newest"
FADE = 6 * TICK_RATE
"""The newest contact is marked for so many ticks, fainter and fainter; one that was chosen stays."""

FAINTER = 6
"""Steps in which it fades."""

BALL = 0.02
"""Radius of the mark where it was [m]."""

HITS = {Kind.COLLISION: "collision", Kind.PATH_LEFT: "held"}
"""Protective stops of an arm that met something, and what the log calls them."""

OFF = "Off: changes in contact are neither looked for nor listed. Collisions are."
NOT_STOPPED = "The stop at a collision is off (Settings, collision)."
RED, BLUE = (201, 42, 42), (28, 126, 214)
COLUMNS = (
    "number",
    "t",
    "kind",
    "part",
    "source",
    "rule",
    "force",
    "speed",
    "fx",
    "fy",
    "fz",
    "ax",
    "ay",
    "az",
    "delay_ms",
    "x",
    "y",
    "z",
    "posture",
    "action",
)
"""Columns of the contact log as a file; those on the page are `TABLE`."""
METRES_PER_NEWTON, METRES_PER_ACCELERATION = 0.006, 0.03  # the latter for 1 m/s²
SHORTEST, LONGEST = 0.05, 0.25
"""Length of an arrow [m]."""


class Contacts:
    """The tab with the contact log, and the mark of one contact in the picture."""

    def __init__(self, server: viser.ViserServer, loop: Running, arm: Arm) -> None:
        self._loop, self._arm = loop, arm
        self._settings: Settings | None = None
        self._log: deque[tuple[int, Event]] = deque(maxlen=LENGTH)
        self._count = 0
        self.look_at: Callable[[int | None], None] = lambda tick: None  # told the tick that the plots are to show, None for now
        gui = server.gui
        self.detects = gui.add_checkbox("Detection", loop.settings.contact.on, hint="Of changes in contact")
        self.note = Html(gui)
        self.choice: viser.GuiDropdownHandle[str] = gui.add_dropdown("Mark", choices(0))
        self.table = Html(gui, _shown(()))

        @self.choice.on_update
        async def _(_: viser.GuiEvent) -> None:
            self.look_at(next((event.tick for number, event in self._log if name(number) == self.choice.value), None))

        @self.detects.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:  # a person, and not the page bringing itself up to date
                loop.desk.set({"contact.on": self.detects.value})

        self.export = gui.add_button("Export CSV", color="gray", disabled=True)
        self.force = _arrow(server, "/contact/force", RED)
        self.acceleration = _arrow(server, "/contact/acceleration", BLUE)
        self.label = server.scene.add_label("/contact/label", "", visible=False, anchor="bottom-center")
        self.ghost = Ghost(server, arm, "/ghost/contact", RED)
        self.ball = server.scene.add_icosphere(
            "/contact/ball", radius=BALL, color=RED, opacity=1.0, visible=False, cast_shadow=False
        )
        self._marked: tuple[int, str] | None = None
        self._faded = 0  # steps of fading done

        @self.export.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                event.client.send_file_download("contacts.csv", self.file(), save_immediately=True)

    def show(self, snapshot: Snapshot, fresh: list[Event]) -> bool:
        """Add contacts, and mark the chosen one; True if anything changed."""
        found = [event for event in fresh if event.kind.value.startswith(MARKED) or (event.kind in HITS and event.values["part"])]
        for event in found:
            self._count += 1
            self._log.append((self._count, event))
        if found:
            self.table.show(_shown(islice(reversed(self._log), SHOWN)))
            self.choice.options = choices(self._count)
            self.export.disabled = False
        return any([self._mark(snapshot), self._say(), bool(found)])

    def _say(self) -> bool:
        """Say what is looked for; True if that has changed."""
        settings = self._loop.settings
        if settings is self._settings:
            return False
        self._settings = settings
        lines = [*([] if settings.contact.on else [OFF]), *([] if settings.collision.on else [NOT_STOPPED])]
        return any([bring(self.detects, settings.contact.on), self.note.show("".join(map(svg.fine_print, lines)))])

    def file(self) -> bytes:
        """The log as CSV: SI units, force and pose in B, the delay in milliseconds, the speed in mm/s, the joint angles at its
        beginning. What is not known of an event is left out.
        """
        text = io.StringIO()
        writer = csv.writer(text)
        writer.writerow(COLUMNS)
        for number, event in self._log:
            values = event.values | {"number": number, "t": round(event.tick * TICK, 3), "kind": event.kind.value}
            if "steps" in values:
                values["delay_ms"] = round(1000.0 * float(values["steps"]) * TICK)
            writer.writerow([values.get(name, "") for name in COLUMNS])
        return text.getvalue().encode()

    def _mark(self, snapshot: Snapshot) -> bool:
        if not self._log:
            return False
        wanted = self.choice.value
        number, event = next((entry for entry in self._log if name(entry[0]) == wanted), self._log[-1])
        age = snapshot.tick - event.tick
        hit = event.kind in HITS  # which has a mark of its own while the arm is stopped
        past = wanted == NEWEST and (hit or not 0 <= age < FADE)  # also of another beginning
        if past:
            return any([self._clear(), self.ghost.show(None, snapshot)])
        faded = age * FAINTER // FADE if wanted == NEWEST else 0
        if self._marked == (number, wanted):
            if faded == self._faded:
                return False
            self._faded = faded
            self.ball.opacity = 1.0 - faded / FAINTER
            return True
        self._marked, self._faded = (number, wanted), faded
        values, base = event.values, snapshot.truth_links[0]
        turn = matrix_from_quaternion(base[3:])
        place = where(self._arm, values) if hit else np.array([float(values[name]) for name in "xyz"])
        point = tail = base[:3] + turn @ place
        size = f"{float(values['force']):.0f} N"
        if not hit:
            force, acceleration = (turn @ np.array([float(values[name + axis]) for axis in "xyz"]) for name in "fa")
            tail = point - _drawn(force, METRES_PER_NEWTON)  # outside of what was touched
            self.force.points = np.array([[tail, point]], dtype=np.float32)
            self.acceleration.points = np.array(
                [[point, point + _drawn(acceleration, METRES_PER_ACCELERATION)]], dtype=np.float32
            )
            size += f", {float(values['acceleration']):.1f} m/s²"
        self.ball.position, self.ball.opacity = point, 1.0 - faded / FAINTER
        self.force.visible = self.acceleration.visible = not hit
        self.label.visible = self.ball.visible = True
        self.label.position = tail
        self.label.text = f"{number}: {_kind(event)}, {size}"
        self.ghost.show(posture_of(values) if wanted != NEWEST else None, snapshot)  # of one that somebody has asked for
        return True

    def _clear(self) -> bool:
        """Take the mark away; True if there was one."""
        if self._marked is None:
            return False
        self._marked = None
        self.force.visible = self.acceleration.visible = self.label.visible = self.ball.visible = False
        return True


def _arrow(server: viser.ViserServer, name: str, colour: tuple[int, int, int]) -> viser.ArrowsHandle:
    nothing = np.zeros((1, 2, 3), dtype=np.float32)
    return server.scene.add_arrows(name, nothing, colour, shaft_radius=0.005, head_radius=0.014, head_length=0.035, visible=False)


def _drawn(vector: Array, scale: float) -> Array:
    """A vector as long as its arrow [m]."""
    size = max(float(np.linalg.norm(vector)), 1e-9)
    return vector / size * min(max(size * scale, SHORTEST), LONGEST)


def choices(count: int) -> tuple[str, ...]:
    """What can be marked, when `count` contacts were seen."""
    return (NEWEST, *map(name, range(count, max(count - SHOWN, 0), -1)))


def name(number: int) -> str:
    """What a contact is called in the choice, and its row, which leads there."""
    return f"contact {number}"


def _kind(event: Event) -> str:
    return HITS.get(event.kind) or event.kind.value.removeprefix(MARKED)


def _place(event: Event) -> str:
    return " ".join(f"{1000.0 * float(event.values[axis]):.0f}".replace("-", "−") for axis in "xyz")


def _force(event: Event) -> str:
    """The force; of a change in contact with its main direction."""
    values, force = event.values, f"{float(event.values['force']):.0f}"
    if event.kind in HITS:
        return force
    along = max("xyz", key=lambda axis: abs(float(values[f"f{axis}"])))
    return f"{force} {'+' if float(values[f'f{along}']) >= 0.0 else '−'}{along}"


def _delay(event: Event) -> str:
    return "–" if event.kind in HITS else f"{1000.0 * float(event.values['steps']) * TICK:.0f}"


class ContactColumn(NamedTuple):
    """A column of the table."""

    head: str
    hint: str | None  # told when the pointer rests on the head
    cell: Callable[[int, Event], str]  # of a contact's number and event


TABLE = (
    ContactColumn("", None, lambda number, _: f"{number}"),
    ContactColumn("s", "Time", lambda _, event: f"{event.tick / TICK_RATE:.2f}"),
    ContactColumn(
        "what",
        "A change in contact; a collision, or something that held the arm, which stopped it",
        lambda _, event: _kind(event),
    ),
    ContactColumn("part", "Of the arm", lambda _, event: str(event.values["part"])),
    ContactColumn("tool at, mm", "Tool centre point in the base frame", lambda _, event: _place(event)),
    ContactColumn("mm/s", "Speed at the contact", lambda _, event: f"{float(event.values['speed']):.0f}"),
    ContactColumn("N", "Force, and its main direction where that is known", lambda _, event: _force(event)),
    ContactColumn("ms", "From the first sign to the decision, where that is known", lambda _, event: _delay(event)),
)
"""Columns of the contact log on the page; those of its file are `COLUMNS`."""


def _shown(log: Iterable[tuple[int, Event]]) -> str:
    rows = (tuple(column.cell(number, event) for column in TABLE) for number, event in log)
    return svg.contacts(rows, {column.head: column.hint for column in TABLE})
