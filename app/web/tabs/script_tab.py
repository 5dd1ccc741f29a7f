"""The script tab: a program in URScript, the line that runs, its variables, and what it says."""

import viser

from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running.script_runner import ScriptRunner
from app.urscript.running.told import Telling
from app.urscript.running.whole_text import run_text
from app.web.access.takes import MAX_LINES
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour

MOST = MAX_LINES
"""Characters of a program."""

LONGEST = 200
"""Characters of a line, and of a variable, that are shown."""

SHOWN = 60
"""Lines of the program, variables and messages that are shown."""

EXAMPLE = """def there_and_back():
  q = get_target_joint_positions()
  begin = q[0]
  q[0] = begin + 0.3
  movej(q, a=1.4, v=0.5)
  textmsg("turned by ", get_target_joint_positions()[0] - begin)
  q[0] = begin
  movej(q, a=1.4, v=0.5)
end
"""

COLOURS = {Telling.TROUBLE: Colour.RED, Telling.POPUP: Colour.AMBER}


class ScriptTab:
    """The tab. Its controls run on viser's event loop; `show` runs in the painter."""

    def __init__(self, gui: viser.GuiApi, scripts: ScriptRunner) -> None:
        self._scripts = scripts
        self._problem = ""  # why the program was not begun
        self.text = gui.add_text("Program", EXAMPLE, multiline=True, hint="URScript: docs/guide/scripts.md")
        self.steer = gui.add_button_group("Script", ("Run", "Pause", "Go on", "Stop"))
        self.message = Html(gui)
        self.listing = Html(gui)
        self.variables = Html(gui)
        self.said = Html(gui)
        self.save = gui.add_button("Save as file", color="gray")
        self.load = gui.add_upload_button("Load a file", mime_type=".script", color="gray")

        @self.steer.on_click
        async def _(_: viser.GuiEvent) -> None:
            self.act(self.steer.value)

        @self.save.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                event.client.send_file_download("program.script", self.text.value.encode(), save_immediately=True)

        @self.load.on_upload
        async def _(_: viser.GuiEvent) -> None:
            self.read(self.load.value.content)

    def act(self, word: str) -> None:
        """Do what a button says."""
        scripts, self._problem = self._scripts, ""
        if word == "Run":
            self._problem = self._run(self.text.value)
        elif word == "Pause":
            scripts.pause()
        elif word == "Go on":
            scripts.resume()
        else:
            scripts.stop()

    def read(self, content: bytes) -> None:
        """Take a file's text into the editor."""
        try:
            text = content[: 4 * MOST + 1].decode()
        except UnicodeDecodeError:
            self._problem = "The file is no text in UTF-8."
            return
        self._problem = "" if len(text) <= MOST else f"The file has more than {MOST} characters."
        if not self._problem:
            self.text.value = text

    def _run(self, text: str) -> str:
        """Why a program was not begun, or ""."""
        if len(text) > MOST:
            return f"The program has {len(text)} characters, allowed: {MOST} at most."
        if self._scripts.cabinet.state.remote:
            return "The robot is in remote control: its clients send programs."
        try:
            run_text(self._scripts, text)
        except ScriptTrouble as trouble:
            return str(trouble)
        return ""

    def show(self) -> bool:
        """Bring it up to date; True if anything changed."""
        scripts = self._scripts
        state, trouble, line = scripts.state, scripts.trouble, scripts.line
        wrong = trouble.place.line if trouble is not None and state is None else 0
        lines = scripts.text.splitlines()
        marked = line if state is not None else wrong
        first = max(0, min(marked - SHOWN // 2, len(lines) - SHOWN))
        rows = [(k + 1, lines[k][:LONGEST]) for k in range(first, min(first + SHOWN, len(lines)))]
        problem = self._problem or ("" if trouble is None or state is not None else str(trouble))
        note = svg.note("Script", problem, Colour.RED) if problem else ""
        values = [(name, value[:LONGEST]) for name, value in list(scripts.variables().items())[:SHOWN]]
        last = scripts.told[: -SHOWN - 1 : -1]
        said = [(told.kind.value, told.text or told.name, COLOURS.get(told.kind, Colour.GREY)) for told in last]
        return any(
            [
                self.message.show(note),
                self.listing.show(svg.listing(rows, marked, "" if state is None else state.name.lower())),
                self.variables.show(svg.facts(values)),
                self.said.show(svg.table(said)),
            ]
        )
