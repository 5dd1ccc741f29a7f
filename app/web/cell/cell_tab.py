"""The tab of the user's cell: save, load, undo, back from a scenario, and the names of inputs and outputs."""

from collections.abc import Callable

import viser

from app.kept_setup import LONGEST_NAME
from app.web.cell.work_cell import WorkCell
from app.web.widgets import svg
from app.web.widgets.html import Html, enable, reveal
from app.web.widgets.svg import Colour
from app.web.widgets.typed import Typed
from pendant.program.steps import LINES

OWN = "Arm, tools, payload, walls, world, settings, program and script are one cell."
KEPT = " It is kept for the next start."
BESIDE = "A scenario runs beside your cell. Nothing of it is kept, unless you keep it."
NAMED = tuple(f"{kind} {number}" for kind in ("input", "output") for number in range(LINES))


class CellTab:
    """The tab. Its controls run on viser's event loop; `show` runs in the painter.

    Args:
        gui: of the page, within the tab.
        home: the button of the main bar that leads back from a scenario.
    """

    def __init__(self, gui: viser.GuiApi, home: viser.GuiButtonHandle) -> None:
        self._cell: WorkCell | None = None
        self._again = False  # which way the question is about
        self.state = Html(gui)
        self.message = Html(gui)
        self.adopt = gui.add_button("Keep the scenario as my cell", color="gray", visible=False)
        self.save = gui.add_button("Save cell", color="gray", hint="All of it, in one file")
        self.load = gui.add_upload_button("Load a cell", mime_type=".yaml", color="gray")
        self.undo = gui.add_button("Undo", color="gray", disabled=True, hint="The last change of the cell")
        self.redo = gui.add_button("Redo", color="gray", disabled=True)
        self.yes = gui.add_button("Yes, do it", color="gray", visible=False)
        self.no = gui.add_button("No", color="gray", visible=False)
        self.home = home

    def names(self, gui: viser.GuiApi) -> None:
        """Add the folder with the names of inputs and outputs; within the tab."""
        with gui.add_folder("Names of inputs and outputs", expand_by_default=False):
            self.line = gui.add_dropdown("Line", NAMED)
            self.name = gui.add_text("Name", "")
            self._typed = Typed(self.name, self._rename)

    def serve(self, cell: WorkCell) -> None:
        """Work on this cell from now on."""
        self._cell = cell

        def on(button: viser.GuiButtonHandle, act: Callable[[], None]) -> None:
            @button.on_click
            async def _(_: viser.GuiEvent) -> None:
                act()

        on(self.home, cell.give_back)
        on(self.adopt, cell.adopt)
        on(self.undo, lambda: self._undo(again=False))
        on(self.redo, lambda: self._undo(again=True))
        on(self.yes, self._sure)
        on(self.no, lambda: self._ask(""))

        @self.save.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                event.client.send_file_download("cell.yaml", cell.file(), save_immediately=True)

        @self.load.on_upload
        async def _(_: viser.GuiEvent) -> None:
            self.read(self.load.value.name, self.load.value.content)

        @self.line.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._typed.bring(cell.lines.get(self.line.value, ""))

    def read(self, name: str, content: bytes) -> None:
        """Begin with the cell of a file, or say in a line why not."""
        assert self._cell is not None
        refusal = self._cell.try_file(name, content)
        told = (
            ("File refused", refusal, Colour.AMBER)
            if refusal
            else ("Cell loaded", f"{name}: the arm is at its start.", Colour.GREEN)
        )
        self.message.show(svg.note(*told))

    def show(self) -> bool:
        """Bring it up to date; True if anything changed."""
        cell = self._cell
        assert cell is not None
        beside = cell.lent is not None
        text, colour = (BESIDE, Colour.AMBER) if beside else (OWN + (KEPT if cell.keeps else ""), Colour.GREY)
        note = svg.note("Scenario" if beside else "My cell", text, colour)
        kept = svg.note("Not kept for the next start", cell.problem, Colour.AMBER) if cell.problem else ""
        return any(
            [
                self.state.show(note + kept),
                reveal(self.adopt, beside),
                reveal(self.home, beside),
                enable(self.undo, cell.undoes),
                enable(self.redo, cell.redoes),
            ]
        )

    def _undo(self, *, again: bool) -> None:
        assert self._cell is not None
        self._again = again
        if asks := self._cell.asks(again):
            self._ask(asks)
        else:
            self._sure()

    def _sure(self) -> None:
        assert self._cell is not None
        self._ask("")
        self._cell.undo(self._again)

    def _ask(self, question: str) -> None:
        self.message.show(svg.note(f"{question}. Go on?", "", Colour.AMBER) if question else "")
        reveal(self.yes, bool(question))
        reveal(self.no, bool(question))

    def _rename(self, name: str) -> None:
        assert self._cell is not None
        self._cell.lines = self._cell.lines | {self.line.value: name[:LONGEST_NAME]}
