"""The program in the teach tab: its steps, one of them chosen, and what is done to them."""

from collections.abc import Callable
from typing import Any, cast

import viser
from msgspec.structs import replace

from app.files.taught_program import LONGEST, MOST, MOVES, OTHERS, Do, Lesson, TaughtStep, axis, level
from app.web.widgets import style, svg
from app.web.widgets.html import Html, enable
from pendant.program.steps import LINES, MOST_RUNS, InputLevel

NO_STEP, NO_WAYPOINT, STAY = "no step yet", "none", "where it is"
REMEMBERED = 100
"""Edits that can be undone."""

KINDS: dict[str, Do] = {text: cast("Do", do) for do, text in (MOVES | OTHERS).items() if do != "touch"}
WAYS = {
    f"{frame.capitalize()} {axis(along)}": (frame, along)
    for frame in ("base", "tool")
    for along in ("-z", "z", "-x", "x", "-y", "y")
}
AFTER = {"Stay at the surface": "stay", "Retreat": "retreat", "Go on at once": "go on"}
ALWAYS = "always"
CONDITIONS: dict[str, InputLevel | None] = {ALWAYS: None} | {
    f"input {number} is {level(high)}": InputLevel(input=number, high=high) for number in range(LINES) for high in (True, False)
}
FIELDS = {
    **dict.fromkeys(MOVES, ("to",)),
    "until contact": ("way", "distance", "speed", "then", "back"),
    "wait": ("seconds",),
    "input": ("number", "high"),
    "output on": ("number",),
    "output off": ("number",),
    "tell": ("says",),
}
"""What a kind of step has to be told."""


class Edits:
    """What was taught, and what it was before each edit."""

    def __init__(self) -> None:
        self.now = Lesson()
        self._before: list[Lesson] = []
        self._undone: list[Lesson] = []

    def to(self, lesson: Lesson) -> None:
        """Go over to another lesson."""
        if lesson != self.now:
            self._before = [*self._before, self.now][-REMEMBERED:]
            self._undone = []
            self.now = lesson

    def undo(self) -> None:
        """Back to what was before the last edit, if there is one."""
        if self._before:
            self._undone.append(self.now)
            self.now = self._before.pop()

    def redo(self) -> None:
        """Take the last undo back."""
        if self._undone:
            self._before.append(self.now)
            self.now = self._undone.pop()


class StepEditor:
    """A list in which a step is chosen, the values of a step, and the buttons that insert, change, move and delete.

    Its controls run on viser's event loop; `show` runs in the painter.

    Args:
        gui: of the page.
        edits: what is edited.
        edited: told after each edit, and when another step is chosen: with the waypoint that it leads to, or None.
    """

    def __init__(self, gui: viser.GuiApi, edits: Edits, edited: Callable[[str | None], None]) -> None:
        self._edits, self._edited = edits, edited
        self.list = Html(gui)
        self.choice: viser.GuiDropdownHandle[str] = gui.add_dropdown("Chosen step", names_of(edits.now))
        self.place: viser.GuiDropdownHandle[str] = gui.add_dropdown("Move the chosen step", places_of(edits.now))
        for unseen in (self.choice, self.place):
            Html(gui, style.unseen(unseen._impl.uuid))  # the list chooses, and a row of it is dragged
        self.order = gui.add_button_group("Selected step", ("↑", "↓", "✕"))
        with gui.add_folder("Step to insert"):
            self.kind = gui.add_dropdown("Step", tuple(KINDS))
            self.fields: dict[str, Any] = {
                "to": gui.add_dropdown("To", waypoints_of(edits.now)),
                "way": gui.add_dropdown("Direction", tuple(WAYS)),
                "distance": gui.add_number("Distance [mm]", 500.0, min=1.0, max=1000.0, step=1.0, hint="At most"),
                "speed": gui.add_number("Speed [mm/s]", 30.0, min=1.0, max=250.0, step=1.0),
                "then": gui.add_dropdown("Then", tuple(AFTER)),
                "back": gui.add_number("Retreat [mm]", 50.0, min=0.0, max=1000.0, step=1.0),
                "seconds": gui.add_number("Seconds", 1.0, min=0.1, max=3600.0, step=0.1),
                "number": gui.add_dropdown("Number", tuple(str(number) for number in range(LINES))),
                "high": gui.add_dropdown("Level", (level(True), level(False))),
                "says": gui.add_text("Text", "Ready", hint="What the panel says, with a tone"),
            }
            self.when = gui.add_dropdown("Only if", tuple(CONDITIONS))
            self.insert = gui.add_button_group("Insert", ("Before", "After", "Replace"))
        self.history = gui.add_button_group("History", ("Undo", "Redo", "Clear"))
        self.loop = gui.add_checkbox("Loop", False, hint="The program runs again and again, until Stop")
        self.repeat = gui.add_number("Repeat", 1, min=1, max=MOST_RUNS, step=1, hint="That the program runs")
        self._see_fields()
        self._connect()

    @property
    def chosen(self) -> int | None:
        """The place of the chosen step in the plan."""
        options = self.choice.options
        return None if options == (NO_STEP,) else options.index(self.choice.value)

    def show(self, now: int | None, state: str) -> bool:
        """Show the steps; `now` is the one being done, in `state`. True if anything changed."""
        names, chosen = self.choice.options, self.choice.value
        rows = [(name, name == chosen, number == now) for number, name in enumerate(names) if name != NO_STEP]
        return self.list.show(svg.steps(rows, state))

    def refresh(self, chosen: int | None = None) -> None:
        """Bring the controls up to what was taught; `chosen` is the place of the step that is chosen from now on."""
        lesson = self._edits.now
        names = names_of(lesson)
        place = self.chosen if chosen is None else chosen
        if self.choice.options != names:
            self.choice.options = names
            self.place.options = places_of(lesson)
        if self.place.value != STAY:
            self.place.value = STAY
        wanted = names[min(max(place or 0, 0), len(names) - 1)]
        if self.choice.value != wanted:
            self.choice.value = wanted
        places = waypoints_of(lesson)
        if self.fields["to"].options != places:
            kept = self.fields["to"].value
            self.fields["to"].options = places
            self.fields["to"].value = kept if kept in places else places[-1]
        loops = lesson.repeat == 0
        if self.loop.value != loops:
            self.loop.value = loops
        enable(self.repeat, not loops)
        if not loops and self.repeat.value != lesson.repeat:
            self.repeat.value = lesson.repeat

    def entered(self) -> TaughtStep | None:
        """The step that the controls describe; None: it needs a waypoint, and there is none."""
        do, values = KINDS[self.kind.value], self.fields
        to = values["to"].value if do in MOVES else None
        if to == NO_WAYPOINT:
            return None
        step = TaughtStep(do=do, to=to, when=CONDITIONS[self.when.value])
        if do == "until contact":
            frame, along = WAYS[values["way"].value]
            return replace(
                step,
                frame=frame,
                along=along,
                distance=float(values["distance"].value) / 1000.0,
                speed=float(values["speed"].value) / 1000.0,
                then=AFTER[values["then"].value],
                back=float(values["back"].value) / 1000.0,
            )
        if do == "wait":
            return replace(step, seconds=float(values["seconds"].value))
        if do == "tell":
            return replace(step, says=values["says"].value.strip()[:LONGEST] or "Ready")
        return replace(step, number=int(values["number"].value), high=values["high"].value == level(True))

    def _see_fields(self) -> None:
        wanted = FIELDS.get(KINDS[self.kind.value], ())
        retreats = AFTER[self.fields["then"].value] == "retreat"
        for name, control in self.fields.items():
            visible = name in wanted and (name != "back" or retreats)
            if control.visible != visible:
                control.visible = visible

    def _fill(self) -> None:
        """Show the values of the chosen step, to change them."""
        at = self.chosen
        if at is None:
            return
        step = self._edits.now.plan[at]
        self.kind.value = next((text for text, do in KINDS.items() if do == step.do), self.kind.value)
        values: dict[str, Any] = {
            "way": next(text for text, way in WAYS.items() if way == (step.frame, step.along)),
            "distance": 1000.0 * step.distance,
            "speed": 1000.0 * step.speed,
            "then": next(text for text, then in AFTER.items() if then == step.then),
            "back": 1000.0 * step.back,
            "seconds": step.seconds,
            "number": str(step.number),
            "high": level(step.high),
            "says": step.says,
        }
        if step.to is not None:
            values["to"] = step.to
        for name in FIELDS.get(step.do, ()):  # what it does not have stays as it was typed, or as it begins
            if name in values:
                self.fields[name].value = values[name]
        self.when.value = next(text for text, when in CONDITIONS.items() if when == step.when)
        self._see_fields()
        self._edited(step.to)

    def _insert(self) -> None:
        step, plan, at = self.entered(), self._edits.now.plan, self.chosen
        if step is None:
            return
        replaces = self.insert.value == "Replace" and at is not None
        if not replaces and len(plan) >= MOST:
            return
        first = (0 if at is None else at) + (self.insert.value == "After" and at is not None)
        self._to(self._edits.now.with_steps([*plan[:first], step, *plan[first + replaces :]]), first)

    def _reorder(self) -> None:
        at, lesson = self.chosen, self._edits.now
        if at is None:
            return
        if self.order.value == "✕":
            self._to(lesson.with_steps([*lesson.plan[:at], *lesson.plan[at + 1 :]]), at)
        else:
            by = -1 if self.order.value == "↑" else 1
            self._to(lesson.with_step_moved(at, by), at + by)

    def _put(self) -> None:
        """Move the chosen step to the place that was asked for."""
        at, lesson, wanted = self.chosen, self._edits.now, self.place.value
        if at is None or wanted == STAY:
            return
        to = self.place.options.index(wanted) - 1
        self._to(lesson.with_step_moved(at, to - at), to)

    def _go_back(self) -> None:
        if self.history.value == "Clear":
            self._edits.to(self._edits.now.with_steps([]))
        elif self.history.value == "Undo":
            self._edits.undo()
        else:
            self._edits.redo()
        self.refresh()
        self._edited(None)

    def _to(self, lesson: Lesson, chosen: int) -> None:
        self._edits.to(lesson)
        self.refresh(chosen)
        self._edited(None)

    def _connect(self) -> None:
        for group, act in ((self.insert, self._insert), (self.order, self._reorder), (self.history, self._go_back)):

            @group.on_click
            async def _(_: viser.GuiEvent, act: Callable[[], None] = act) -> None:
                act()

        for control, act in (
            (self.choice, self._fill),
            (self.place, self._put),
            (self.kind, self._see_fields),
            (self.fields["then"], self._see_fields),
        ):

            @control.on_update
            async def _(event: viser.GuiEvent, act: Callable[[], None] = act) -> None:
                if event.client_id is not None:
                    act()

        for control in (self.repeat, self.loop):

            @control.on_update
            async def _(event: viser.GuiEvent) -> None:
                if event.client_id is not None:
                    self._edits.to(replace(self._edits.now, repeat=0 if self.loop.value else int(self.repeat.value)))
                    self.refresh()


def names_of(lesson: Lesson) -> tuple[str, ...]:
    """The steps as they are listed, numbered from 1; or that there is none."""
    return tuple(f"{number}. {step.text}" for number, step in enumerate(lesson.plan, 1)) or (NO_STEP,)


def places_of(lesson: Lesson) -> tuple[str, ...]:
    """Where the chosen step can be moved to: nowhere, or the place that it then has."""
    return (STAY, *(f"to place {number}" for number in range(1, len(lesson.plan) + 1)))


def waypoints_of(lesson: Lesson) -> tuple[str, ...]:
    """The names of the waypoints, or that there is none."""
    return tuple(waypoint.name for waypoint in lesson.waypoints) or (NO_WAYPOINT,)
