"""Ready-made scenarios: bundled sessions that say what to watch.

A click sets a scenario up, or plays its time line. Scenarios are grouped by topic, and found by words of their titles and texts.
"""

import functools
from collections.abc import Callable

import viser

from app.files.checked import load
from app.runs.runner import simulate
from app.session.prepare import prepare
from app.session.session_file import Session, bundled, folder
from app.session.timeline import Timeline
from app.web.running import Running
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from sim.arm.arm_file import Arm

EVERY = "All topics"
TOPICS = {
    "Free-drive begins": (
        *("free-drive", "push-to-activate", "presses-in-a-row", "posture-by-hand", "postures-in-a-row", "confirmed-by-push"),
        *("confirmed-within-the-check", "second-gesture", "let-go-too-early", "right-payload", "enabling-device", "bump-ignored"),
        *("teach-first", "after-a-stop", "elbow-led"),
    ),
    "Free-drive is refused": (
        *("wrong-payload", "push-not-payload", "another-tool", "balanced", "stored-comparison", "checked-current"),
        *("payload-moves-the-arm", "payload-gains-speed", "payload-moves-into-a-wall", "payload-changes-unseen"),
    ),
    "Free-drive ends": (
        "left-alone",
        "kept-by-press",
        "kept-by-touch",
        "short-press",
        "too-fast",
        "sensor-fails",
        "payload-falls",
        "payload-falls-unseen",
        "guided-unseen",
        "way-back",
    ),
    "Limits, walls, locked axes": (
        *("soft-limits", "dynamic-limits", "joint-limits", "vertical-speed", "wall-walked-down", "wall-made", "wall-pushes-back"),
        *("wall-ends-free-drive", "wall-stops-a-program", "axis-locks", "only-the-elbow"),
    ),
    "Payload, tool, sensor": (
        *("payload-wizard", "payload-by-itself", "half-a-kilogram", "zeroed", "hanging", "friction-warm-up"),
        *("gripped-unknown", "part-slips"),
    ),
    "Programs and contact": (
        *("hold", "program", "touch-the-table", "stops-at-contact", "waits-for-a-trigger", "tells-the-user", "touches-itself"),
        *("contact-buffers", "contact-median", "contact-older-pairs", "contact-operating", "contact-commanded"),
        *("control-current-limit", "network"),
    ),
}
"""Topics of the scenarios: names of the scenarios' files."""


@functools.cache
def scenarios() -> dict[str, Session]:
    """The bundled sessions that say what to watch, by file name."""
    found = {name: load(folder("sessions") / f"{name}.yaml", Session) for name in bundled("sessions")}
    return {name: session for name, session in found.items() if session.watch}


class Scenarios:
    """The scenarios' part of the laboratory; an arm may have no scenarios."""

    def __init__(self, gui: viser.GuiApi, loop: Running, arm: Arm) -> None:
        self._loop = loop
        self.lend: Callable[[], None] = lambda: None  # told before a scenario runs
        self._names = {session.title: name for name, session in scenarios().items() if session.robot == arm.name}
        self.text = Html(gui)
        if not self._names:
            return
        with gui.add_folder("Scenario"):
            self.search = gui.add_text("Search", "", hint="Words of a title or a text")
            self.topic = gui.add_dropdown("Topic", (EVERY, *TOPICS))
            self.cards = Html(gui)
            self.choice = gui.add_dropdown("Chosen", tuple(self._names))
            self.text = Html(gui)
            self.begin = gui.add_button_group("Begin", ("Set up", "Play"))
        self._tell()

        for control in (self.choice, self.search, self.topic):

            @control.on_update
            async def _(_: viser.GuiEvent) -> None:
                self._tell()

        @self.begin.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._begin(play=self.begin.value == "Play")

    def found(self) -> dict[str, list[str]]:
        """Titles by topic, of the scenarios that fit the search and the chosen topic."""
        words = self.search.value.casefold().split()
        chosen: dict[str, list[str]] = {}
        for title, name in self._names.items():
            topic = next((topic for topic, names in TOPICS.items() if name in names), "More")
            text = f"{title} {scenarios()[name].watch} {topic}".casefold()
            if self.topic.value in (EVERY, topic) and all(word in text for word in words):
                chosen.setdefault(topic, []).append(title)
        return {topic: chosen[topic] for topic in (*TOPICS, "More") if topic in chosen}

    def _tell(self) -> None:
        title = self.choice.value
        self.cards.show(svg.cards(self.found(), title))
        self.text.show(svg.note(title, f"Watch: {scenarios()[self._names[title]].watch}", Colour.GREY))

    def _begin(self, play: bool) -> None:
        name = self._names[self.choice.value]
        session = scenarios()[name]
        prepared = prepare(session, name)
        actions = session.timeline if play else []
        joints = prepared.arm.chain.joints
        self.lend()
        self._loop.paused = False
        self._loop.begin(lambda: simulate(prepared), lambda: Timeline(actions, joints, prepared.program))
