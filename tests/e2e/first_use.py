"""The first use of the page by a stranger, step by step: a browser test walks it, the pictures of the docs are taken on it."""

import csv
import io
from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Locator, Page

from pendant.events.event import Event, Kind
from pendant.tick.modes import Mode
from tests.e2e.cell import Array, Cell
from tests.e2e.finger import pointer, tap
from tests.e2e.hold import COOL_DOWN, enter_free_drive, hold_free_drive, hold_until

WEIGHT = 2.0
"""Mass that is put on without telling the controller [kg]."""

BY_ITSELF = {
    Kind.LEFT_PERIOD: "Free-drive ended: nobody moved the arm",
    Kind.LEFT_RESTART: "Free-drive ended: the arm stood still",
}
"""What the page says of a free-drive that ended because nobody guided the arm."""

SHORT, LONG = 1000, 5000
"""For so many ticks a hand may not have taken hold, and may hold without what it is there for."""


class FirstUse:
    """One page and its cell. `see` is told the name of each state once it is on the page."""

    def __init__(self, page: Page, cell: Cell, see: Callable[[str], None] = lambda state: None) -> None:
        self.page, self.cell, self.see = page, cell, see

    def walk(self) -> str:
        """Do everything, and check what each step has to show. Returns the contact log as CSV."""
        self.open()
        self.push_it_held()
        self.guide_and_register()
        self.run_program()
        self.be_refused()
        self.correct_and_enter()
        return self.touch_the_table()

    def open(self) -> None:
        """The page says what to do."""
        self.page.get_by_text("The arm can be guided by hand").wait_for()
        self.see("open")

    def push_it_held(self) -> None:
        """Dragged without free-drive, the arm holds its place."""
        cell = self.cell
        cell.pass_time(0.3)
        before = cell.position("wrist_3")
        self.drag((0.0, -200.0), lambda: self.strongest() > 45.0, "the hand is at its cap")
        cell.pass_time(0.3)
        assert cell.loop.latest().decision.mode is Mode.TEACH
        assert np.linalg.norm(cell.position("wrist_3") - before) < 0.003
        self.see("held")
        self.let_go()

    def guide_and_register(self) -> None:
        """Free-drive on, two moves, and a waypoint before, between and after them."""
        cell, page = self.cell, self.page
        self.register(1)
        for number, way in ((2, (20.0, -90.0)), (3, (70.0, 20.0))):
            before = cell.position("wrist_3")
            self.drag(way, lambda before=before: self.away(before) > 0.05, "it follows", self.be_free)
            if number == 2:
                self.see("guided")
            self.let_go()
            cell.pass_time(0.3)
            self.register(number)
        self.be_free()
        tap(page.get_by_role("button", name="Leave free-drive"))
        cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "left")
        self.see("registered")

    def be_free(self) -> None:
        """Have free-drive on. A page that stalls lets go of a moving arm, which may end it with a stop (FD-19): begin again."""
        cell = self.cell
        if cell.loop.latest().decision.mode is Mode.FREE_DRIVE:
            return
        if cell.loop.latest().decision.mode is Mode.STOP:
            tap(self.page.get_by_role("button", name="Reset", exact=True))
            cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "reset")
        cell.pass_time(COOL_DOWN)
        enter_free_drive(self.page, cell)

    def run_program(self) -> None:
        """The waypoints, one after the other."""
        cell, page = self.cell, self.page
        end = cell.position("wrist_3")
        tap(page.get_by_role("button", name="Run", exact=True).first)
        cell.wait(lambda: cell.loop.latest().decision.step == 2, "the second step", 30.0)
        page.get_by_text("running", exact=True).wait_for()
        self.see("running")
        cell.wait(lambda: cell.happened(Kind.PROGRAM_FINISHED), "the program ends", 30.0)
        assert np.linalg.norm(cell.position("wrist_3") - end) < 0.005  # the last waypoint is where it was left

    def be_refused(self) -> None:
        """Two kilograms that the controller does not know of: refused, with a reason in numbers."""
        cell, page = self.cell, self.page
        tap(page.get_by_role("tab", name="Lab"))
        self.fill(self.number(cell.served.lab.true), f"{WEIGHT:g}")
        page.get_by_text(f"+{WEIGHT:.1f} kg wrong").wait_for()
        hold_until(page, cell, lambda: cell.happened(Kind.REFUSED_PAYLOAD), "refused")
        page.get_by_text("Consistent with").or_(page.get_by_text("from the configured one")).first.wait_for()
        pointer(page).up()
        assert 1.0 < float(self.first(Kind.REFUSED_PAYLOAD).values["mass"]) < 3.0
        self.see("refused")

    def correct_and_enter(self) -> None:
        """The payload is entered; free-drive begins, counts down and ends."""
        cell, page = self.cell, self.page
        self.fill(self.number(cell.served.lab.configured), f"{WEIGHT:g}")
        page.get_by_text("as configured").wait_for()
        cell.loop.desk.set({"free_drive.period": 3.0, "free_drive.restart_period": 3.0})
        for _ in range(4):
            cell.pass_time(COOL_DOWN)
            known = len(cell.loop.events(0))
            hold_free_drive(page, cell)
            pointer(page).up()
            self.see("corrected")
            cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "left alone, it ends")
            # A page that stalls while the button is held lets go and takes hold again, and a short press leaves.
            ended = [event for event in cell.loop.events(0)[known:] if event.kind in BY_ITSELF]
            if ended:
                break
        else:
            pytest.fail(f"it never ended by itself: {cell.told()}")
        page.get_by_text(BY_ITSELF[ended[0].kind]).first.wait_for()

    def touch_the_table(self) -> str:
        """A ready-made program touches the table: the contact is in the log, and in the file."""
        cell, page = self.cell, self.page
        cell.served.lab.scenarios.choice.value = "Down onto the table until it touches"
        tap(page.get_by_role("button", name="Play"))
        tap(page.get_by_role("tab", name="Contacts"))
        cell.wait(lambda: cell.happened(Kind.CONTACT_GAINED), "the table", 60.0)
        low = cell.position("wrist_3")[2]
        event = self.first(Kind.CONTACT_GAINED)
        page.get_by_role("cell", name="gained").first.wait_for()
        page.get_by_role("cell", name=f"{2 * int(event.values['steps'])}", exact=True).first.wait_for()
        cell.wait(lambda: self.finished_after(event), "the program ends", 60.0)
        assert 0.04 < cell.position("wrist_3")[2] - low < 0.06
        self.see("contact")
        with page.expect_download() as download:
            tap(page.get_by_role("button", name="Export CSV"))
        text = download.value.path().read_text()
        row = next(csv.DictReader(io.StringIO(text)))
        assert row["kind"] == "contact_gained"
        assert float(row["force"]) == float(event.values["force"])
        return text

    def drag(
        self, by: tuple[float, float], true: Callable[[], bool], what: str, ready: Callable[[], None] = lambda: None
    ) -> None:
        """Drag the wrist by so many pixels until something is true. `ready` is called before each attempt.

        A page that is drawn late may still show the arm where it was, and one that stalls lets go (FD-23): take hold again then.
        """
        cell = self.cell
        for _ in range(5):
            ready()
            cell.drag(self.page, 0, cell.position("wrist_3"), by)
            start, held = cell.loop.latest().tick, False
            while True:
                if true():
                    return
                touched = bool(cell.loop.desk._touches)
                waited = cell.loop.latest().tick - start
                if (held and not touched) or waited > (LONG if held else SHORT):
                    break
                held |= touched
                self.page.wait_for_timeout(20)
            pointer(self.page).up()
        pytest.fail(f"dragged in vain: {what}; {cell.told()}")

    def away(self, before: Array) -> float:
        """How far the wrist is from a point of W [m]."""
        return float(np.linalg.norm(self.cell.position("wrist_3") - before))

    def strongest(self) -> float:
        """The largest force of a hand [N]."""
        return max((float(np.linalg.norm(touch[2])) for touch in self.cell.loop.latest().touches), default=0.0)

    def register(self, number: int) -> None:
        """Register waypoint `number`."""
        tap(self.page.get_by_role("button", name="Register waypoint"))
        self.cell.wait(lambda: len(self.cell.served.docks.teach.lesson.waypoints) == number, f"waypoint {number}")

    def let_go(self) -> None:
        """Release the arm."""
        pointer(self.page).up()
        self.cell.wait(lambda: not self.cell.loop.desk._touches, "let go")

    def number(self, slider: object) -> Locator:
        """The number beside a slider."""
        return self.page.locator(f'[id="{slider._impl.uuid}"] ~ div input')  # type: ignore[attr-defined]

    def fill(self, field: Locator, value: str) -> None:
        """Type a value."""
        field.fill(value)
        field.press("Enter")

    def first(self, kind: Kind) -> Event:
        """The first event of a kind."""
        return next(event for event in self.cell.loop.events(0) if event.kind is kind)

    def finished_after(self, event: Event) -> bool:
        """Whether a program has finished after an event."""
        kinds = [other.kind for other in self.cell.loop.events(0)]
        return Kind.PROGRAM_FINISHED in kinds[kinds.index(event.kind) :]
