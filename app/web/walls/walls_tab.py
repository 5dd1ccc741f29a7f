"""The walls tab: areas are made, moved, changed, switched off and deleted; walls of the set-up are switched and set, too."""

from collections.abc import Callable
from typing import Any

import viser
from msgspec.structs import replace

from app.web.access.guard import Guard
from app.web.running import Running
from app.web.walls.made_walls import (
    FARTHEST,
    FIXED,
    LONGEST,
    PARTS,
    REACTIONS,
    REDUCES,
    SHAPES,
    SHORTEST,
    SIDES,
    SIZES,
    at_tool,
    fixed,
    frame_of,
    listed,
    made,
    moved,
    reacting,
    reaction,
    sized,
    sizes,
    tool_now,
    word,
)
from app.web.walls.three_points import ThreePoints
from app.web.walls.wall_handles import WallHandles
from app.web.widgets import svg
from app.web.widgets.html import Html, enable, reveal
from app.web.widgets.svg import Colour
from app.web.widgets.typed import Typed
from pendant.events.event import Event, Kind
from pendant.tick.modes import Mode, Phase
from pendant.tick.pose import Pose, Quaternion, Vector, quaternion
from pendant.walls.barrier import Place
from pendant.walls.definitions import AnyBorder, Area
from sim.exchange.snapshot import Snapshot

NONE: str = "no wall yet"
REMEMBERED = 100
"""Edits that can be undone."""

Borders = tuple[AnyBorder, ...]


class WallsTab:
    """The tab. Its controls run on viser's event loop; `show` runs in the painter, which is there, too."""

    def __init__(self, server: viser.ViserServer, guard: Guard, loop: Running) -> None:
        self._loop = loop
        self._before: list[Borders] = []  # each edit
        self._asked: Borders | None = None  # not taken yet
        self._shown: Borders | None = None
        self._scenario: object = None
        self._place: Place | None = None  # of the chosen one
        gui = server.gui
        self.message = Html(gui)
        self.list = Html(gui)
        self.add = gui.add_button_group("Add", tuple(SHAPES))
        names: tuple[str, ...] = (NONE,)
        self.choice: viser.GuiDropdownHandle[str] = gui.add_dropdown("Selected", names)
        self.name = gui.add_text("Name", "")
        self._typed = Typed(self.name, self._rename)
        self.on = gui.add_checkbox("On", True)
        self.side = gui.add_dropdown("Limit", tuple(SIDES))
        self.part = gui.add_dropdown("Watched", tuple(PARTS), hint="The point of the arm that the limit is for")
        self.fixed: viser.GuiDropdownHandle[str] = gui.add_dropdown(
            "Fixed to", tuple(FIXED), hint="It moves with this, from where it lies now"
        )
        self.reaction = gui.add_dropdown("When reached", (*REACTIONS, REDUCES))
        self.size = [gui.add_number("Radius [mm]", SHORTEST, min=SHORTEST, max=LONGEST, step=1.0) for _ in range(3)]
        self.spot = [
            gui.add_number(f"{axis} [mm]", 0.0, min=-FARTHEST, max=FARTHEST, step=1.0, hint="Of its centre, in the base")
            for axis in "XYZ"
        ]
        self.shown = gui.add_checkbox(
            "Edit in 3D", False, hint="Arrows and arcs in the picture, with which it is moved and turned"
        )
        self.here = gui.add_button("Bring it to the tool", color="gray")
        self.delete = gui.add_button("Delete", color="gray")
        self.undo = gui.add_button("Undo", color="gray")
        self.points = ThreePoints(server, self._tool, self._through)
        self.handles = WallHandles(server, guard, self._moved)
        self._refresh()  # nothing is chosen yet
        own = (self.name, self.on, self.side, self.part, self.fixed, self.reaction, *self.size, *self.spot)
        for control in (*own, self.here, self.delete, self.undo):
            enable(control, False)
        self._connect()
        self._connect_values()

    @property
    def borders(self) -> Borders:
        """Walls and areas, as they are or as was asked for just now."""
        return self._loop.walls if self._asked is None else self._asked

    @property
    def chosen(self) -> AnyBorder | None:
        """The chosen one."""
        return next((border for border in self.borders if border.name == self.choice.value), None)

    def show(self, snapshot: Snapshot, fresh: list[Event]) -> bool:
        """Show list, values and handles; True if anything changed."""
        self._follow(fresh)
        decision, borders = snapshot.decision, self.borders
        locked = decision.mode in (Mode.FREE_DRIVE, Mode.RUN) or decision.phase is not Phase.OFF
        changed = borders is not self._shown
        if changed:
            self._shown = borders
            self._offer(tuple(border.name for border in borders))
            self._refresh()
        chosen = self.chosen
        area = chosen if isinstance(chosen, Area) else None
        places = {border.name: place for border, place in snapshot.places}
        self._place = None if area is None else places.get(area.name)
        changed |= self.list.show(listed(borders, self._loop.settings.walls.on))
        for control in (self.name, self.on, self.reaction, self.part, self.delete):
            changed |= enable(control, chosen is not None and not locked)
        for control in (self.side, self.fixed, self.here, *self.size, *self.spot):
            changed |= enable(control, area is not None and not locked)
        changed |= enable(self.undo, bool(self._before) and not locked)
        changed |= self.points.show(locked)
        held = self._asked is not None  # the handles stay where they were let go until the robot has answered
        return changed or (not held and self.handles.show(area if self.shown.value and not locked else None, self._place))

    def let_go(self, client: int) -> None:
        """`client` has stalled, left, or given control back: what it moves goes back."""
        self.handles.let_go(client)

    def _follow(self, fresh: list[Event]) -> None:
        """What became of the last edit."""
        for event in fresh:
            if event.kind is Kind.WALLS_REFUSED:
                self._asked = None
                if self._before and self._before[-1] == self._loop.walls:
                    self._before.pop()
                self.message.show(svg.note("Not changed", f"{event.values['reason']}.", Colour.AMBER))
            elif event.kind is Kind.WALLS_CHANGED:
                self.message.show("")
        if self._asked is not None and self._loop.walls == self._asked:
            self._asked = None
        if self._loop.scenario is not self._scenario:
            self._scenario, self._before, self._asked = self._loop.scenario, [], None

    def _offer(self, names: tuple[str, ...]) -> None:
        """Have these to choose from; what is new is chosen, else what was."""
        old, chosen = self.choice.options, self.choice.value
        names = names or (NONE,)
        if old == names:
            return
        new = [name for name in names if name not in old]
        self.choice.options = names
        wanted = new[-1] if new else chosen if chosen in names else names[-1]
        if self.choice.value != wanted:
            self.choice.value = wanted

    def _refresh(self) -> None:
        """The controls say what the chosen one is."""
        border = self.chosen
        area = border if isinstance(border, Area) else None
        values = () if area is None else sizes(area.shape)
        names = () if area is None else SIZES.get(type(area.shape), ())
        for place, control in enumerate(self.size):
            reveal(control, place < len(values))
            if place < len(values):
                if control.label != (text := f"{names[place]} [mm]"):
                    control.label = text
                _bring(control, round(values[place], 1))
        for control in (self.side, self.fixed, self.here, self.shown, *self.spot):
            reveal(control, area is not None)
        for control in (self.name, self.on, self.part, self.reaction, self.delete):
            reveal(control, border is not None)
        self._typed.bring("" if border is None else border.name)
        if border is None:
            return
        _bring(self.on, border.on)
        _bring(self.part, word(PARTS, border.part))
        _bring(self.reaction, reaction(border))
        if area is not None:
            _bring(self.side, word(SIDES, area.keep_out))
            offered = tuple(dict.fromkeys((*FIXED, *self._objects(), word(FIXED, area.reference))))
            if self.fixed.options != offered:
                self.fixed.options = offered
            _bring(self.fixed, word(FIXED, area.reference))
            for control, value in zip(self.spot, self._spot(area), strict=True):
                _bring(control, round(1000.0 * value, 1))

    def _spot(self, area: Area) -> Vector:
        """Where its shape's origin is in B, as far as that is known [m]."""
        place = next((place for border, place in self._loop.latest().places if border == area), None)
        return area.position if place is None else place.pose.p

    def _ask(self, borders: Borders) -> None:
        self._asked = borders
        self._loop.desk.fence(borders)

    def _edit(self, borders: Borders) -> None:
        """Another list, by hand."""
        if borders != self.borders:
            self._before = [*self._before, self.borders][-REMEMBERED:]
            self._ask(borders)

    def _change(self, border: AnyBorder) -> None:
        """The chosen one becomes this."""
        self._edit(tuple(border if each.name == border.name else each for each in self.borders))

    def _moved(self, p: Vector, turn: Quaternion) -> None:
        area = self.chosen
        if isinstance(area, Area):
            self._change(moved(area, self._place, p, turn))

    def _tool(self) -> Pose:
        return tool_now(self._loop.latest())

    def _through(self, p: Vector, turn: Quaternion) -> None:
        """A new plane, through points that the tool was brought to."""
        plane = made("Plane", frozenset(border.name for border in self.borders), self._tool())
        self._edit((*self.borders, moved(plane, None, p, turn)))
        self.shown.value = True

    def _rename(self, name: str) -> None:
        border, names = self.chosen, [each.name for each in self.borders]
        if border is None or (name in names and name != border.name):
            self.message.show(svg.note("Not renamed", "Each wall needs a name of its own.", Colour.AMBER))
            self._refresh()
            return
        self._edit(tuple(replace(each, name=name) if each is border else each for each in self.borders))

    def _connect(self) -> None:
        @self.add.on_click
        async def _(_: viser.GuiEvent) -> None:
            taken = frozenset(border.name for border in self.borders)
            self._edit((*self.borders, made(self.add.value, taken, self._tool())))
            self.shown.value = True

        @self.choice.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._refresh()

        @self.here.on_click
        async def _(_: viser.GuiEvent) -> None:
            if isinstance(area := self.chosen, Area):
                self._change(at_tool(area, self._place, self._tool()))

        @self.delete.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._edit(tuple(border for border in self.borders if border.name != self.choice.value))

        @self.undo.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self._before:
                self._ask(self._before.pop())

    def _connect_values(self) -> None:
        def by_hand(control: Any, act: Callable[[AnyBorder], AnyBorder]) -> None:
            @control.on_update
            async def _(event: viser.GuiEvent) -> None:
                border = self.chosen
                if event.client_id is not None and border is not None:  # a person, and not the page bringing itself up to date
                    self._change(act(border))

        by_hand(self.on, lambda border: replace(border, on=self.on.value))
        by_hand(self.part, lambda border: replace(border, part=PARTS[self.part.value]))
        by_hand(self.reaction, lambda border: reacting(border, self.reaction.value))
        by_hand(self.side, self._sided)
        by_hand(self.fixed, self._fix)
        for control in self.size:
            by_hand(control, self._sized)
        for control in self.spot:
            by_hand(control, self._placed)

    def _objects(self) -> tuple[str, ...]:
        """Names of the objects of the world."""
        return tuple(thing.name for thing in self._loop.scenario.world)

    def _fix(self, border: AnyBorder) -> AnyBorder:
        to = FIXED.get(self.fixed.value, self.fixed.value)
        if not isinstance(border, Area) or to == border.reference:
            return border
        if to == border.part:
            text = f"It watches the {self.fixed.value.lower()}: it cannot move with that as well."
            self.message.show(svg.note("Not changed", text, Colour.AMBER))
            self._refresh()
            return border
        return fixed(border, self._place, to, frame_of(to, self._loop.latest(), self._objects()))

    def _sided(self, border: AnyBorder) -> AnyBorder:
        return replace(border, keep_out=SIDES[self.side.value]) if isinstance(border, Area) else border

    def _sized(self, border: AnyBorder) -> AnyBorder:
        return replace(border, shape=sized(border.shape, tuple(float(control.value) for control in self.size)))

    def _placed(self, border: AnyBorder) -> AnyBorder:
        if not isinstance(border, Area):
            return border
        x, y, z = (float(control.value) / 1000.0 for control in self.spot)
        turn = border.orientation if self._place is None else quaternion(self._place.pose.R)
        return moved(border, self._place, (x, y, z), turn)


def _bring(control: Any, value: object) -> None:
    if control.value != value:
        control.value = value
